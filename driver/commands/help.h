/** What is printed of commands: usage, lists, `--help`. */
#pragma once

#include "commands/command.h"

#include <stdio.h>

/** What stands without a command: the program itself. */
extern const command program_command;
extern const command *const commands[];
extern const int n_commands;

/** Reminds of the usage in a few lines. */
void help_print_usage(FILE *stream, const command *command);

/** All there is to say of a command, on stdout. */
void help_print(const command *command);
