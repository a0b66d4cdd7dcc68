#include "commands/cli.h"

#include "base/memory.h"
#include "base/status.h"
#include "base/suggest.h"
#include "commands/cli_commands.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    cli_print_usage(stderr, command);
    if (command == &cli_program) {
        cli_print_commands(stderr);
    }
    cli_print_hint(stderr, command);
    options->command = CLI_NOTHING;
    options->exit_code = EVL_EXIT_USAGE;
}

/** The option of a command by its name, or by its letter if `name` is NULL. */
static const option_row *find_option(const command_row *command, const char *name, size_t length, char letter)
{
    for (int i = 0; i < CLI_N_OPTIONS; i++) {
        const option_row *row = &cli_option_rows[i];
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
    char *names[CLI_N_OPTIONS];
    const char *candidates[CLI_N_OPTIONS];
    int n = 0;
    for (int i = 0; i < CLI_N_OPTIONS; i++) {
        if ((cli_option_rows[i].mask & command->mask) != 0) {
            names[n] = xasprintf("--%s", cli_option_rows[i].name);
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
        cli_print_help(command);
        options->command = CLI_NOTHING;
        options->exit_code = EVL_EXIT_OK;
        return;
    }
    (void)check_words(options, command);
}

static void parse_program(cli_options *options, const char *word)
{
    const bool is_long = strncmp(word, "--", 2) == 0;
    const option_row *row = is_long             ? find_option(&cli_program, word + 2, strlen(word + 2), 0)
                            : strlen(word) == 2 ? find_option(&cli_program, NULL, 0, word[1])
                                                : NULL;
    if (row == NULL) {
        unknown_option(options, &cli_program, word);
        return;
    }
    store(options, row, NULL);
    if (options->help) {
        cli_print_help(&cli_program);
    }
    options->command = options->version ? CLI_VERSION : CLI_NOTHING;
}

void cli_parse(int argc, char **argv, cli_options *options)
{
    *options = (cli_options){.command = CLI_NOTHING};
    if (argc < 2) {
        misuse(options, &cli_program, "a command is missing");
        return;
    }
    if (argv[1][0] == '-') {
        parse_program(options, argv[1]);
        return;
    }
    const char *names[CLI_N_COMMANDS];
    word_list rest = {.n = argc - 2, .words = argv + 2};
    for (int i = 0; i < CLI_N_COMMANDS; i++) {
        names[i] = cli_commands[i].name;
        if (strcmp(argv[1], names[i]) == 0) {
            parse_command(options, &cli_commands[i], &rest);
            return;
        }
    }
    char *phrase = suggest_phrase(argv[1], CLI_N_COMMANDS, names);
    misuse(options, &cli_program, "unknown command '%s'%s", argv[1], phrase);
    free(phrase);
}

void cli_free(cli_options *options)
{
    free(options->set);
    options->set = NULL;
    options->n_set = 0;
}
