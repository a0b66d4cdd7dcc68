/** The command line, word by word; its commands and options stand in cli_commands.c. A leaf. */
#ifndef EVOLVENT_CLI_H
#define EVOLVENT_CLI_H

#include <stdbool.h>

typedef enum { CLI_NOTHING, CLI_RUN, CLI_SHOW, CLI_MODES, CLI_BATCH, CLI_VERSION } cli_command;

typedef struct {
    cli_command command;   /**< what is to be done; CLI_NOTHING if that was to print a help text or a complaint */
    int exit_code;         /**< of CLI_NOTHING */
    const char *case_path; /**< of a case, or of a batch's design; NULL if none was given */
    const char *output;    /**< NULL if none was given */
    const char *at;        /**< NULL if none was given, like the next four */
    const char *mesh_position, *shard, *jobs, *cases;
    int n_set;
    const char **set; /**< [n_set] "PATH=VALUE", in their order */
    bool quiet, json, laws, keys, mean, resume, check;
    bool help, version;
} cli_options;

/** Understand a command line. Help goes to stdout; a complaint with a short help goes to stderr.
 *  The strings are those of argv; cli_free frees the rest. */
void cli_parse(int argc, char **argv, cli_options *options);
void cli_free(cli_options *options);

#endif
