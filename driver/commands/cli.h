/** The command line, word by word, for whatever commands commands.inc lists. */
#pragma once

#include "commands/command.h"

/** Understand a command line and do what it says. Help goes to stdout; a complaint with a short help goes to stderr.
 *  @param program  what stands without a command: its options, and what is done for one of them */
evl_exit cli_run(const command *program, int argc, char **argv, evl_error *error);
