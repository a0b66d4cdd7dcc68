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
        return "option '--check' runs no case; combine it only with '--shard' and '--quiet'";
    }
    return options->folder == NULL && !options->check ? "'batch' needs a folder: -o DIR" : NULL;
}

static const option_row rows[] = {
    {OPTION_TEXT, 'o', "--output", "DIR", offsetof(batch_options, folder),
     "folder for the results; created if missing"},
    {OPTION_TEXT, 0, "--shard", "I/N", offsetof(batch_options, shard),
     "run only the cases i with i mod N = I - 1; 1/1 if not given"},
    {OPTION_TEXT, 'j', "--jobs", "J", offsetof(batch_options, jobs), "number of worker processes; 1 if not given"},
    {OPTION_FLAG, 0, "--resume", NULL, offsetof(batch_options, resume), "run only the cases that are not recorded yet"},
    {OPTION_FLAG, 0, "--check", NULL, offsetof(batch_options, check),
     "run no case; print as JSON the cases that would be refused, with the reasons"},
    {OPTION_TEXT, 0, "--cases", "FILE", offsetof(batch_options, cases),
     "file of case numbers, one per line; run these cases even if they are recorded; the last record of a case is "
     "valid"},
    {OPTION_TEXT, 0, "--checkpoint", "MINUTES", offsetof(batch_options, checkpoint),
     "interval of the checkpoints of a long case with integrator radau; 10 if not given; 0: no checkpoints"},
    OPTION_ROW_QUIET(batch_options),
    OPTION_ROW_HELP,
};

const command batch_command = {
    .name = "batch",
    .synopsis = "DESIGN.h5 -o DIR [--shard I/N] [--jobs J] [--resume] [--cases FILE] [--checkpoint MINUTES] [-q] | "
                "--check [--shard I/N]",
    .summary = "run the cases of a design, or a shard (subset) of them",
    .text =
        "Runs the cases of a design, which 'evolvent-sweep plan' creates: a base case, and a table with the values\n"
        "of each case. The status and the metrics of each finished case are one line of DIR/shard-I-of-N.jsonl.\n"
        "The line of a failed case contains the reason. Histories, if the design selects any, are in\n"
        "DIR/shard-I-of-N.h5. Recorded cases are kept after any interruption. The same command with --resume runs\n"
        "the missing cases, and a long case resumes from its checkpoint. SIGTERM, SIGUSR1 and SIGINT end the\n"
        "command with exit code 75.\n"
        "\n"
        "Examples:\n"
        "  evolvent batch design.h5 -o results --jobs 2\n"
        "  evolvent batch design.h5 -o results --shard 3/8 --resume      the third of 8 shards, as a job of an array\n"
        "  evolvent batch design.h5 --check                               which cases would be refused; runs no case\n",
    .file = "design",
    .size = sizeof(batch_options),
    OPTION_ROWS(rows),
    .check = check,
    .run = run,
};
