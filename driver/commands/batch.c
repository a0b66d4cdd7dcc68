#include "batch/batch.h"

#include "base/interrupt.h"
#include "base/log.h"
#include "commands/command.h"

static evl_exit run(const char *file, const void *given, evl_error *error)
{
    const batch_options *options = given;
    log_set_quiet(options->quiet);
    interrupt_install();
    return batch(file, options, error);
}

static const char *check(const void *given)
{
    const batch_options *options = given;
    if (options->check && (options->folder != NULL || options->jobs != NULL || options->cases != NULL ||
                           options->resume || options->checkpoint != NULL)) {
        return "option '--check' runs nothing: of the others only '--shard' and '--quiet' go with it";
    }
    return options->folder == NULL && !options->check ? "'batch' needs a folder: -o DIR" : NULL;
}

static const option_row rows[] = {
    {OPTION_TEXT, 'o', "--output", "DIR", offsetof(batch_options, folder),
     "folder of the results, made if it is not there"},
    {OPTION_TEXT, 0, "--shard", "I/N", offsetof(batch_options, shard),
     "only the cases i with i mod N = I - 1; 1/1 if not given"},
    {OPTION_TEXT, 'j', "--jobs", "J", offsetof(batch_options, jobs),
     "number of processes that run cases; 1 if not given"},
    {OPTION_FLAG, 0, "--resume", NULL, offsetof(batch_options, resume),
     "go on: run the cases that are not recorded yet"},
    {OPTION_FLAG, 0, "--check", NULL, offsetof(batch_options, check),
     "run nothing: only say, as JSON, which cases would be refused and why"},
    {OPTION_TEXT, 0, "--cases", "FILE", offsetof(batch_options, cases),
     "run these cases, one number a line, recorded or not; the later record counts"},
    {OPTION_TEXT, 0, "--checkpoint", "MINUTES", offsetof(batch_options, checkpoint),
     "of a case by radau that takes longer: how often it is kept, to go on from there; 10 if not given, 0: never"},
    OPTION_ROW_QUIET(batch_options),
    OPTION_ROW_HELP,
};

const command batch_command = {
    .name = "batch",
    .synopsis = "DESIGN.h5 -o DIR [--shard I/N] [--jobs J] [--resume] [--cases FILE] [--checkpoint MINUTES] [-q] | "
                "--check [--shard I/N]",
    .summary = "run the cases of a design, or a share of them",
    .text =
        "Runs the cases of a design, which 'evolvent-sweep plan' writes: a base case, and a table of the values that "
        "make\n"
        "the cases. Each finished case is a line of DIR/shard-I-of-N.jsonl: what became of it, and its numbers over "
        "the\n"
        "design's window of time. Histories, if the design asks for some, are in DIR/shard-I-of-N.h5. A case that "
        "fails "
        "is a\n"
        "line with its reason. Whatever ends the program, nothing recorded is lost: the same command with --resume "
        "runs\n"
        "what is missing; a long case goes on where it was. SIGTERM, SIGUSR1 and SIGINT end it with exit code 75.\n"
        "\n"
        "Examples:\n"
        "  evolvent batch design.h5 -o results --jobs 2\n"
        "  evolvent batch design.h5 -o results --shard 3/8 --resume      of 8 shares the third, as a job of an array\n"
        "  evolvent batch design.h5 --check                               which cases would be refused; nothing is "
        "run\n",
    .file = "design",
    .size = sizeof(batch_options),
    OPTION_ROWS(rows),
    .check = check,
    .run = run,
};
