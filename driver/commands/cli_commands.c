#include "commands/cli_commands.h"

#include "base/memory.h"
#include "base/status.h"

#include <stdlib.h>

const command_row cli_program = {OF_PROGRAM,
                                 CLI_NOTHING,
                                 "",
                                 "COMMAND ... | --help | --version",
                                 "Dynamics of spur gearboxes with involute teeth in contact.",
                                 "Example:\n"
                                 "  evolvent run examples/paper.yaml        integrates the case, writes paper.h5\n"
                                 "\n"
                                 "'evolvent COMMAND --help' tells more about a command.\n",
                                 ""};

const command_row cli_commands[CLI_N_COMMANDS] = {
    {OF_RUN, CLI_RUN, "run", "CASE.yaml [-o HISTORY.h5] [--set PATH=VALUE]... [-q]",
     "integrate a case, write its history",
     "Integrates the case and writes its time history, an HDF5 file that netCDF-4 readers open. It grows as\n"
     "HISTORY.h5.partial and gets its name when the run is complete, replacing an older one. A run that fails or is\n"
     "interrupted leaves the .partial, readable, with the reason in its attributes.\n"
     "\n"
     "Examples:\n"
     "  evolvent run examples/paper.yaml\n"
     "  evolvent run examples/paper.yaml -o f03.h5 --set meshes.0.friction.coefficient=0.3\n",
     "case file"},
    {OF_SHOW, CLI_SHOW, "show", "CASE.yaml [--set PATH=VALUE]... [--json] | --laws | --keys",
     "print a case with its derived geometry",
     "Prints the case with every default filled in and the geometry that follows from it. Nothing is integrated. Of a "
     "case\n"
     "that 'evolvent run' would refuse it prints what it can, and ends with the line and the exit code of 'run'.\n"
     "\n"
     "Examples:\n"
     "  evolvent show examples/paper.yaml\n"
     "  evolvent show examples/paper.yaml --set wheels.gear.teeth=40 --json\n"
     "  evolvent show --laws\n",
     "case file"},
    {OF_MODES, CLI_MODES, "modes", "CASE.yaml [--at TIME | --mesh-position X | --mean] [--set PATH=VALUE]... [--json]",
     "print natural frequencies, damping and mode shapes",
     "Linearises the gearbox and prints its natural frequencies, damping ratios and mode shapes: at its steady state "
     "under\n"
     "load, whatever the case's initial state, with a tooth pair of the first mesh at the start of contact, or X "
     "pitches\n"
     "from it; with the mean over all positions of the meshes; or, with --at, where the motion of the case is at a "
     "time.\n"
     "\n"
     "Examples:\n"
     "  evolvent modes examples/paper.yaml\n"
     "  evolvent modes examples/spur-pair.yaml --mesh-position 0.25\n"
     "  evolvent modes examples/spur-pair.yaml --mean\n"
     "  evolvent modes examples/paper-friction.yaml --at 0.5 --json\n",
     "case file"},
    {OF_BATCH, CLI_BATCH, "batch",
     "DESIGN.h5 -o DIR [--shard I/N] [--jobs J] [--resume] [--cases FILE] [-q] | --check [--shard I/N]",
     "run the cases of a design, or a share of them",
     "Runs the cases of a design, which 'evolvent-sweep plan' writes: a base case, and a table of the values that "
     "make\n"
     "the cases. Each finished case is a line of DIR/shard-I-of-N.jsonl: what became of it, and its numbers over the\n"
     "design's window of time. Histories, if the design asks for some, are in DIR/shard-I-of-N.h5. A case that fails "
     "is a\n"
     "line with its reason. Whatever ends the program, nothing recorded is lost: the same command with --resume runs\n"
     "what is missing. SIGTERM, SIGUSR1 and SIGINT end it at once, with exit code 75.\n"
     "\n"
     "Examples:\n"
     "  evolvent batch design.h5 -o results --jobs 2\n"
     "  evolvent batch design.h5 -o results --shard 3/8 --resume      of 8 shares the third, as a job of an array\n"
     "  evolvent batch design.h5 --check                               which cases would be refused; nothing is run\n",
     "design"},
};

const option_row cli_option_rows[CLI_N_OPTIONS] = {
    {OF_RUN, 'o', "output", "HISTORY.h5", offsetof(cli_options, output),
     "file to write; the case's name with .h5 in the current folder if not given"},
    {OF_MODES, 0, "at", "TIME", offsetof(cli_options, at),
     "integrate the case from its initial state to this time [s] and linearise there"},
    {OF_MODES, 0, "mesh-position", "X", offsetof(cli_options, mesh_position),
     "linearise where a tooth pair of the first mesh is X pitches from the start of contact; 0 if not given"},
    {OF_MODES, 0, "mean", NULL, offsetof(cli_options, mean),
     "linearise at all positions of the meshes and take the mean"},
    {OF_BATCH, 'o', "output", "DIR", offsetof(cli_options, output), "folder of the results, made if it is not there"},
    {OF_BATCH, 0, "shard", "I/N", offsetof(cli_options, shard),
     "only the cases i with i mod N = I - 1; 1/1 if not given"},
    {OF_BATCH, 'j', "jobs", "J", offsetof(cli_options, jobs), "number of processes that run cases; 1 if not given"},
    {OF_BATCH, 0, "resume", NULL, offsetof(cli_options, resume), "go on: run the cases that are not recorded yet"},
    {OF_BATCH, 0, "check", NULL, offsetof(cli_options, check),
     "run nothing: only say, as JSON, which cases would be refused and why"},
    {OF_BATCH, 0, "cases", "FILE", offsetof(cli_options, cases),
     "run these cases, one number a line, recorded or not; the later record counts"},
    {OF_RUN | OF_SHOW | OF_MODES, 0, "set", "PATH=VALUE", offsetof(cli_options, set),
     "change the case, such as wheels.pinion.teeth=25; VALUE is YAML; may be repeated"},
    {OF_RUN | OF_BATCH, 'q', "quiet", NULL, offsetof(cli_options, quiet),
     "no progress and no summary; warnings and errors only"},
    {OF_SHOW | OF_MODES, 0, "json", NULL, offsetof(cli_options, json), "one JSON object, in SI units and radians"},
    {OF_SHOW, 0, "laws", NULL, offsetof(cli_options, laws), "the laws of contact, damping and friction instead"},
    {OF_SHOW, 0, "keys", NULL, offsetof(cli_options, keys), "every key of a case file, as Markdown, instead"},
    {OF_RUN | OF_SHOW | OF_MODES | OF_BATCH | OF_PROGRAM, 'h', "help", NULL, offsetof(cli_options, help), "this text"},
    {OF_PROGRAM, 'V', "version", NULL, offsetof(cli_options, version), "versions of the program and of its libraries"},
};

static const char *separator(const command_row *command)
{
    return command->name[0] != '\0' ? " " : "";
}

void cli_print_usage(FILE *stream, const command_row *command)
{
    fprintf(stream, "Usage: evolvent %s%s%s\n", command->name, separator(command), command->synopsis);
}

void cli_print_hint(FILE *stream, const command_row *command)
{
    fprintf(stream, "'evolvent %s%s--help' tells more.\n", command->name, separator(command));
}

void cli_print_commands(FILE *stream)
{
    fputs("Commands:\n", stream);
    for (int i = 0; i < CLI_N_COMMANDS; i++) {
        fprintf(stream, "  %-6s %s\n", cli_commands[i].name, cli_commands[i].summary);
    }
}

static void print_options(FILE *stream, const command_row *command)
{
    fputs("Options:\n", stream);
    for (int i = 0; i < CLI_N_OPTIONS; i++) {
        const option_row *row = &cli_option_rows[i];
        if ((row->mask & command->mask) == 0) {
            continue;
        }
        char *head = xasprintf("--%s%s%s", row->name, row->argument != NULL ? " " : "",
                               row->argument != NULL ? row->argument : "");
        const char letter[] = {'-', row->letter, ',', '\0'};
        fprintf(stream, "  %3s %-20s %s\n", row->letter != 0 ? letter : "", head, row->text);
        free(head);
    }
}

void cli_print_help(const command_row *command)
{
    cli_print_usage(stdout, command);
    if (command == &cli_program) {
        printf("\n%s\n\n", command->summary);
        cli_print_commands(stdout);
        printf("\n%s\n", command->text);
    } else {
        printf("\n%s\n", command->text);
    }
    print_options(stdout, command);
    fputs("\nExit codes:\n", stdout);
    evl_exit_print_table(stdout);
}
