/** The commands of the program and their options, each in one table, and what `--help` prints of them. */
#ifndef EVOLVENT_CLI_COMMANDS_H
#define EVOLVENT_CLI_COMMANDS_H

#include "commands/cli.h"

#include <stddef.h>
#include <stdio.h>

/** Commands that an option belongs to. */
enum { OF_RUN = 1, OF_SHOW = 2, OF_PROGRAM = 4, OF_MODES = 8, OF_BATCH = 16 };

/** A command. */
typedef struct {
    int mask;
    cli_command command;
    const char *name, *synopsis, *summary, *text;
    const char *file; /**< what it works on */
} command_row;

/** An option. */
typedef struct {
    int mask;             /**< of which commands */
    char letter;          /**< 0 if it has no short form */
    const char *name;     /**< without the dashes */
    const char *argument; /**< NULL: a flag */
    size_t place;         /**< of its value in cli_options; that of `set` collects */
    const char *text;
} option_row;

enum { CLI_N_COMMANDS = 4, CLI_N_OPTIONS = 17 };

extern const command_row cli_program; /**< without a command */
extern const command_row cli_commands[CLI_N_COMMANDS];
extern const option_row cli_option_rows[CLI_N_OPTIONS];

/** One line: how the command is called. */
void cli_print_usage(FILE *stream, const command_row *command);

/** One line: where more is told. */
void cli_print_hint(FILE *stream, const command_row *command);

/** The commands, a line each. */
void cli_print_commands(FILE *stream);

/** All there is to say of a command, on stdout. */
void cli_print_help(const command_row *command);

#endif
