/** Command line parser, for the commands listed in commands.inc. */
#pragma once

#include "commands/command.h"

/** Parse a command line and execute it. Help goes to stdout; an error message with a short help goes to stderr.
 *  @param program  used without a command: its options, and the action for one of them */
evl_exit cli_run(const command *program, int argc, char **argv, evl_error *error);
