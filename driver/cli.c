#include "cli.h"

#include "memory.h"
#include "status.h"
#include "suggest.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { OF_RUN = 1, OF_SHOW = 2, OF_PROGRAM = 4, OF_MODES = 8, OF_BATCH = 16 };

typedef struct {
    int mask;
    cli_command command;
    const char *name, *synopsis, *summary, *text;
    const char *file; /**< what it works on */
} command_row;

static const command_row program = {OF_PROGRAM,
                                    CLI_NOTHING,
                                    "",
                                    "COMMAND ... | --help | --version",
                                    "Dynamics of spur gearboxes with involute teeth in contact.",
                                    "Example:\n"
                                    "  evolvent run examples/paper.yaml        integrates the case, writes paper.h5\n"
                                    "\n"
                                    "'evolvent COMMAND --help' tells more about a command.\n",
                                    ""};

static const command_row commands[] = {
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
enum { N_COMMANDS = sizeof commands / sizeof *commands };

typedef struct {
    int mask;             /**< of which commands */
    char letter;          /**< 0 if it has no short form */
    const char *name;     /**< without the dashes */
    const char *argument; /**< NULL: a flag */
    size_t place;         /**< of its value in cli_options; that of `set` collects */
    const char *text;
} option_row;

static const option_row option_rows[] = {
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
enum { N_OPTIONS = sizeof option_rows / sizeof *option_rows };

static const char *separator(const command_row *command)
{
    return command->name[0] != '\0' ? " " : "";
}

static void print_usage(FILE *stream, const command_row *command)
{
    fprintf(stream, "Usage: evolvent %s%s%s\n", command->name, separator(command), command->synopsis);
}

static void print_commands(FILE *stream)
{
    fputs("Commands:\n", stream);
    for (int i = 0; i < N_COMMANDS; i++) {
        fprintf(stream, "  %-6s %s\n", commands[i].name, commands[i].summary);
    }
}

static void print_options(FILE *stream, const command_row *command)
{
    fputs("Options:\n", stream);
    for (int i = 0; i < N_OPTIONS; i++) {
        const option_row *row = &option_rows[i];
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

static void print_help(const command_row *command)
{
    print_usage(stdout, command);
    if (command == &program) {
        printf("\n%s\n\n", command->summary);
        print_commands(stdout);
        printf("\n%s\n", command->text);
    } else {
        printf("\n%s\n", command->text);
    }
    print_options(stdout, command);
    fputs("\nExit codes:\n", stdout);
    evl_exit_print_table(stdout);
}

/** Complain in one line, remind of the usage in a few. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
static void misuse(cli_options *options, const command_row *command, const char *format, ...)
{
    evl_error error = {.code = EVL_EXIT_OK};
    char text[EVL_ERROR_MESSAGE_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    evl_error_set(&error, EVL_EXIT_USAGE, "", "%s", text);
    evl_error_print(stderr, &error);
    print_usage(stderr, command);
    if (command == &program) {
        print_commands(stderr);
    }
    fprintf(stderr, "'evolvent %s%s--help' tells more.\n", command->name, separator(command));
    options->command = CLI_NOTHING;
    options->exit_code = EVL_EXIT_USAGE;
}

/** The option of a command by its name, or by its letter if `name` is NULL. */
static const option_row *find_option(const command_row *command, const char *name, size_t length, char letter)
{
    for (int i = 0; i < N_OPTIONS; i++) {
        const option_row *row = &option_rows[i];
        const bool is_same = name == NULL ? row->letter == letter && letter != 0
                                          : strlen(row->name) == length && strncmp(row->name, name, length) == 0;
        if (is_same && (row->mask & command->mask) != 0) {
            return row;
        }
    }
    return NULL;
}

static void unknown_option(cli_options *options, const command_row *command, const char *word)
{
    char *names[N_OPTIONS];
    const char *candidates[N_OPTIONS];
    int n = 0;
    for (int i = 0; i < N_OPTIONS; i++) {
        if ((option_rows[i].mask & command->mask) != 0) {
            names[n] = xasprintf("--%s", option_rows[i].name);
            candidates[n] = names[n];
            n++;
        }
    }
    char *given = xstrdup(word);
    given[strcspn(given, "=")] = '\0';
    char *phrase = strncmp(word, "--", 2) == 0 ? suggest_phrase(given, n, candidates) : xstrdup("");
    misuse(options, command, "unknown option '%s'%s", given, phrase);
    free(phrase);
    free(given);
    for (int i = 0; i < n; i++) {
        free(names[i]);
    }
}

static void store(cli_options *options, const option_row *row, const char *value)
{
    char *place = (char *)options + row->place;
    if (row->place == offsetof(cli_options, set)) {
        options->set = xrealloc(options->set, (size_t)options->n_set + 1, sizeof *options->set);
        options->set[options->n_set++] = value;
    } else if (row->argument != NULL) {
        memcpy(place, &value, sizeof value);
    } else {
        const bool yes = true;
        memcpy(place, &yes, sizeof yes);
    }
}

/** What is left of a command line, word by word. */
typedef struct {
    int n;
    char **words;
} word_list;

static bool take_value(cli_options *options, const command_row *command, const option_row *row, const char *attached,
                       word_list *rest)
{
    const char *value = attached;
    if (row->argument != NULL && value == NULL && rest->n > 0) {
        value = *rest->words++;
        rest->n--;
    }
    if (row->argument != NULL && (value == NULL || value[0] == '\0')) {
        misuse(options, command, "option '--%s' needs a value: --%s %s", row->name, row->name, row->argument);
        return false;
    }
    if (row->argument == NULL && attached != NULL) {
        misuse(options, command, "option '--%s' takes no value", row->name);
        return false;
    }
    store(options, row, value);
    return true;
}

/** "--name", "--name value" or "--name=value" */
static bool take_long(cli_options *options, const command_row *command, const char *word, word_list *rest)
{
    const char *name = word + 2, *equals = strchr(name, '=');
    const size_t length = equals != NULL ? (size_t)(equals - name) : strlen(name);
    const option_row *row = find_option(command, name, length, 0);
    if (row == NULL) {
        unknown_option(options, command, word);
        return false;
    }
    return take_value(options, command, row, equals != NULL ? equals + 1 : NULL, rest);
}

/** "-q", "-o value", "-ovalue", "-qovalue" */
static bool take_letters(cli_options *options, const command_row *command, const char *word, word_list *rest)
{
    for (const char *letter = word + 1; *letter != '\0'; letter++) {
        const option_row *row = find_option(command, NULL, 0, *letter);
        if (row == NULL) {
            unknown_option(options, command, word);
            return false;
        }
        if (row->argument != NULL) {
            return take_value(options, command, row, letter[1] != '\0' ? letter + 1 : NULL, rest);
        }
        store(options, row, NULL);
    }
    return true;
}

static bool take_words(cli_options *options, const command_row *command, word_list *rest)
{
    bool only_files = false;
    while (rest->n > 0) {
        const char *word = *rest->words++;
        rest->n--;
        if (!only_files && strcmp(word, "--") == 0) {
            only_files = true;
        } else if (!only_files && strncmp(word, "--", 2) == 0) {
            if (!take_long(options, command, word, rest)) {
                return false;
            }
        } else if (!only_files && word[0] == '-' && word[1] != '\0') {
            if (!take_letters(options, command, word, rest)) {
                return false;
            }
        } else if (options->case_path != NULL) {
            misuse(options, command, "one %.*s at a time: what is '%s' after '%s'?", (int)strcspn(command->file, " "),
                   command->file, word, options->case_path);
            return false;
        } else {
            options->case_path = word;
        }
        if (options->help) {
            return true;
        }
    }
    return true;
}

/** Words that do not go together. */
static bool check_words(cli_options *options, const command_row *command)
{
    const bool is_reference = options->laws || options->keys;
    if (options->case_path == NULL && !is_reference) {
        misuse(options, command, "'%s' needs a %s", command->name, command->file);
        return false;
    }
    if (options->check &&
        (options->output != NULL || options->jobs != NULL || options->cases != NULL || options->resume)) {
        misuse(options, command,
               "option '--check' runs nothing: of the others only '--shard' and '--quiet' go with it");
        return false;
    }
    if (command->mask == OF_BATCH && options->output == NULL && !options->check) {
        misuse(options, command, "'%s' needs a folder: -o DIR", command->name);
        return false;
    }
    if ((options->at != NULL) + (options->mesh_position != NULL) + options->mean > 1) {
        misuse(options, command, "one of '--at', '--mesh-position' and '--mean' at a time");
        return false;
    }
    if (is_reference &&
        (options->case_path != NULL || options->json || options->n_set > 0 || (options->laws && options->keys))) {
        misuse(options, command, "option '--%s' stands alone", options->laws ? "laws" : "keys");
        return false;
    }
    return true;
}

static void parse_command(cli_options *options, const command_row *command, word_list *rest)
{
    options->command = command->command;
    if (!take_words(options, command, rest)) {
        return;
    }
    if (options->help) {
        print_help(command);
        options->command = CLI_NOTHING;
        options->exit_code = EVL_EXIT_OK;
        return;
    }
    (void)check_words(options, command);
}

static void parse_program(cli_options *options, const char *word)
{
    const bool is_long = strncmp(word, "--", 2) == 0;
    const option_row *row = is_long             ? find_option(&program, word + 2, strlen(word + 2), 0)
                            : strlen(word) == 2 ? find_option(&program, NULL, 0, word[1])
                                                : NULL;
    if (row == NULL) {
        unknown_option(options, &program, word);
        return;
    }
    store(options, row, NULL);
    if (options->help) {
        print_help(&program);
    }
    options->command = options->version ? CLI_VERSION : CLI_NOTHING;
}

void cli_parse(int argc, char **argv, cli_options *options)
{
    *options = (cli_options){.command = CLI_NOTHING};
    if (argc < 2) {
        misuse(options, &program, "a command is missing");
        return;
    }
    if (argv[1][0] == '-') {
        parse_program(options, argv[1]);
        return;
    }
    const char *names[N_COMMANDS];
    word_list rest = {.n = argc - 2, .words = argv + 2};
    for (int i = 0; i < N_COMMANDS; i++) {
        names[i] = commands[i].name;
        if (strcmp(argv[1], names[i]) == 0) {
            parse_command(options, &commands[i], &rest);
            return;
        }
    }
    char *phrase = suggest_phrase(argv[1], N_COMMANDS, names);
    misuse(options, &program, "unknown command '%s'%s", argv[1], phrase);
    free(phrase);
}

void cli_free(cli_options *options)
{
    free(options->set);
    options->set = NULL;
    options->n_set = 0;
}
