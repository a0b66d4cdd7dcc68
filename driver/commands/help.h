/** Printed help of commands: usage, lists, `--help`. */
#pragma once

#include "commands/command.h"

#include <stdio.h>

/** Without a command: the program itself. */
extern const command program_command;
extern const command *const commands[];
extern const int n_commands;

/** Print a short usage. */
void help_print_usage(FILE *stream, const command *command);

/** Print the complete help of a command, on stdout. */
void help_print(const command *command);
