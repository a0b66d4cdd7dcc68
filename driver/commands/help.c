#include "commands/help.h"

#include "base/memory.h"
#include "base/words.h"

#define COMMAND(name) extern const command name##_command;
#include "commands/commands.inc"
#undef COMMAND

#define COMMAND(name) &name##_command,
const command *const commands[] = {
#include "commands/commands.inc"
};
#undef COMMAND

const int n_commands = sizeof commands / sizeof *commands;

static bool is_program(const command *command)
{
    return command->name[0] == '\0';
}

static void print_call(FILE *stream, const command *command)
{
    fprintf(stream, "Usage: evolvent %s%s%s\n", command->name, is_program(command) ? "" : " ", command->synopsis);
}

static void print_commands(FILE *stream)
{
    int width = 0;
    for (int i = 0; i < n_commands; i++) {
        width = words_width(width, commands[i]->name);
    }
    fputs("Commands:\n", stream);
    for (int i = 0; i < n_commands; i++) {
        fprintf(stream, "  %-*s %s\n", width, commands[i]->name, commands[i]->summary);
    }
}

void help_print_usage(FILE *stream, const command *command)
{
    print_call(stream, command);
    if (is_program(command)) {
        print_commands(stream);
    }
    fprintf(stream, "See 'evolvent %s%s--help'.\n", command->name, is_program(command) ? "" : " ");
}

static void print_option(const option_row *row)
{
    const bool has_value = row->argument != NULL;
    CLEANUP_FREE char *head = xasprintf("%s%s%s", row->name, has_value ? " " : "", has_value ? row->argument : "");
    const char letter[] = {'-', row->letter, ',', '\0'};
    printf("  %3s %-20s %s\n", row->letter != 0 ? letter : "", head, row->text);
}

void help_print(const command *command)
{
    print_call(stdout, command);
    if (is_program(command)) {
        printf("\n%s\n\n", command->summary);
        print_commands(stdout);
    }
    printf("\n%s\nOptions:\n", command->text);
    for (int i = 0; i < command->n_options; i++) {
        print_option(&command->options[i]);
    }
    fputs("\nExit codes:\n", stdout);
    evl_exit_print_table(stdout);
}
