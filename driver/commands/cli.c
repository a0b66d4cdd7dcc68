#include "commands/cli.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "commands/help.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** State of the command line parser. */
typedef struct {
    const command *command;
    int n; /**< number of remaining words */
    char **words;
    option_values files;
    void *options; /**< of the command */
    bool *given;   /**< [n_options] of the command */
    bool help;
} parser;

/** Print a one-line error message and a short usage. @return false */
__attribute__((format(printf, 2, 3))) static bool misuse(const parser *parser, const char *format, ...)
{
    evl_error error = {.code = EVL_EXIT_OK};
    char text[EVL_ERROR_MESSAGE_LENGTH];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    evl_error_set(&error, EVL_EXIT_USAGE, "", "%s", text);
    evl_error_print(stderr, &error);
    help_print_usage(stderr, parser->command);
    return false;
}

static bool unknown_option(const parser *parser, const char *word)
{
    const int n = strncmp(word, "--", 2) == 0 ? parser->command->n_options : 0;
    CLEANUP_FREE const char **names = xcalloc((size_t)n + 1, sizeof *names);
    for (int i = 0; i < n; i++) {
        names[i] = parser->command->options[i].name;
    }
    CLEANUP_FREE char *given = xasprintf("%.*s", (int)strcspn(word, "="), word),
                      *phrase = suggest_phrase(given, n, names);
    return misuse(parser, "unknown option '%s'%s", given, phrase);
}

static bool takes_value(const option_row *row)
{
    return row->kind == OPTION_TEXT || row->kind == OPTION_LIST;
}

static void append(option_values *list, const char *value)
{
    list->values = xrealloc(list->values, (size_t)list->n + 1, sizeof *list->values);
    list->values[list->n++] = value;
}

static void store(parser *parser, const option_row *row, const char *value)
{
    void *value_at = (char *)parser->options + row->offset;
    parser->given[row - parser->command->options] = true;
    switch (row->kind) {
    case OPTION_TEXT:
        *(const char **)value_at = value;
        break;
    case OPTION_FLAG:
    case OPTION_ALONE:
        *(bool *)value_at = true;
        break;
    case OPTION_LIST:
        append(value_at, value);
        break;
    case OPTION_HELP:
        parser->help = true;
        break;
    }
}

/** @param attached  a value in the same word, or NULL */
static bool take_value(parser *parser, const option_row *row, const char *attached)
{
    const char *value = attached;
    if (takes_value(row) && value == NULL && parser->n > 0) {
        value = *parser->words++;
        parser->n--;
    }
    if (takes_value(row) && (value == NULL || value[0] == '\0')) {
        return misuse(parser, "option '%s' needs a value: %s %s", row->name, row->name, row->argument);
    }
    if (!takes_value(row) && attached != NULL) {
        return misuse(parser, "option '%s' takes no value", row->name);
    }
    store(parser, row, value);
    return true;
}

/** "--name", "--name value" or "--name=value" */
static bool take_long(parser *parser, const char *word)
{
    const char *equals = strchr(word, '=');
    const size_t length = equals != NULL ? (size_t)(equals - word) : strlen(word);
    for (int i = 0; i < parser->command->n_options; i++) {
        const option_row *row = &parser->command->options[i];
        if (strlen(row->name) == length && strncmp(row->name, word, length) == 0) {
            return take_value(parser, row, equals != NULL ? equals + 1 : NULL);
        }
    }
    return unknown_option(parser, word);
}

/** "-q", "-o value", "-ovalue", "-qovalue" */
static bool take_letters(parser *parser, const char *word)
{
    for (const char *letter = word + 1; *letter != '\0'; letter++) {
        const option_row *row = NULL;
        for (int i = 0; i < parser->command->n_options && row == NULL; i++) {
            const option_row *one = &parser->command->options[i];
            row = one->letter == *letter ? one : NULL;
        }
        if (row == NULL) {
            return unknown_option(parser, word);
        }
        if (takes_value(row)) {
            return take_value(parser, row, letter[1] != '\0' ? letter + 1 : NULL);
        }
        store(parser, row, NULL);
    }
    return true;
}

static bool take_file(parser *parser, const char *word)
{
    const char *kind = parser->command->file;
    if (parser->files.n > 0 && kind != NULL && !parser->command->takes_several) {
        return misuse(parser, "one %.*s at a time; '%s' follows '%s'", (int)strcspn(kind, " "), kind, word,
                      parser->files.values[0]);
    }
    append(&parser->files, word);
    return true;
}

/** Parse all remaining words, or up to --help. */
static bool take_words(parser *parser)
{
    bool only_files = false, good = true;
    while (parser->n > 0 && good && !parser->help) {
        const char *word = *parser->words++;
        parser->n--;
        if (only_files || word[0] != '-' || (word[1] == '\0' && parser->command->file != NULL)) {
            good = take_file(parser, word);
        } else if (strcmp(word, "--") == 0) {
            only_files = true;
        } else {
            good = word[1] == '-' ? take_long(parser, word) : take_letters(parser, word);
        }
    }
    return good;
}

/** Check for options that cannot be combined. */
static bool check_words(const parser *parser)
{
    const command *command = parser->command;
    const option_row *alone = NULL;
    int n_given = 0;
    for (int i = 0; i < command->n_options; i++) {
        const option_row *row = &command->options[i];
        if (parser->given[i]) {
            n_given++;
            alone = alone == NULL && row->kind == OPTION_ALONE ? row : alone;
        }
    }
    if (alone != NULL) {
        return (parser->files.n == 0 && n_given == 1) ||
               misuse(parser, "option '%s' excludes all other arguments", alone->name);
    }
    if (parser->files.n == 0 && command->file == NULL) {
        return misuse(parser, "a command is missing");
    }
    if (parser->files.n == 0) {
        return misuse(parser, "'%s' needs a %s", command->name, command->file);
    }
    const char *complaint = command->check != NULL ? command->check(parser->options) : NULL;
    return complaint == NULL || misuse(parser, "%s", complaint);
}

/** Run the command. @return the highest code of its files */
static evl_exit do_it(const parser *parser, evl_error *error)
{
    const command *command = parser->command;
    evl_exit worst = parser->files.n > 0 ? EVL_EXIT_OK : command->run(NULL, parser->options, error);
    for (int i = 0; i < parser->files.n; i++) {
        const evl_exit code = command->run(parser->files.values[i], parser->options, error);
        worst = code > worst ? code : worst;
    }
    return worst;
}

/** Parse the words after a command, and run it. */
static evl_exit run_command(const command *command, int n, char **words, evl_error *error)
{
    parser parser = {.command = command,
                     .n = n,
                     .words = words,
                     .options = xcalloc(1, command->size),
                     .given = xcalloc((size_t)command->n_options, sizeof(bool))};
    evl_exit code = EVL_EXIT_USAGE;
    const bool good = take_words(&parser);
    if (good && parser.help) {
        help_print(command);
        code = EVL_EXIT_OK;
    } else if (good && check_words(&parser)) {
        code = do_it(&parser, error);
    }
    for (int i = 0; i < command->n_options; i++) {
        if (command->options[i].kind == OPTION_LIST) {
            free(((option_values *)((char *)parser.options + command->options[i].offset))->values);
        }
    }
    free(parser.files.values);
    free(parser.options);
    free(parser.given);
    return code;
}

evl_exit cli_run(const command *program, int argc, char **argv, evl_error *error)
{
    if (argc < 2 || argv[1][0] == '-') {
        return run_command(program, argc < 2 ? 0 : 1, argv + 1, error);
    }
    const parser parser = {.command = program};
    CLEANUP_FREE const char **names = xcalloc((size_t)n_commands, sizeof *names);
    const command *found = NULL;
    for (int i = 0; i < n_commands; i++) {
        names[i] = commands[i]->name;
        found = strcmp(argv[1], names[i]) == 0 ? commands[i] : found;
    }
    if (found == NULL) {
        CLEANUP_FREE char *phrase = suggest_phrase(argv[1], n_commands, names);
        (void)misuse(&parser, "unknown command '%s'%s", argv[1], phrase);
    }
    return found != NULL ? run_command(found, argc - 2, argv + 2, error) : EVL_EXIT_USAGE;
}
