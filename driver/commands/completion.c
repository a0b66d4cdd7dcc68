#include "commands/completion.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"
#include "commands/command.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    const char *name;
    void (*print)(FILE *stream);
} shell;

static const shell shells[] = {
    {"bash", completion_print_bash}, {"zsh", completion_print_zsh}, {"fish", completion_print_fish}};
enum { N_SHELLS = sizeof shells / sizeof *shells };

static evl_exit completion(const char *name, const void *options, evl_error *error)
{
    (void)options;
    const char *names[N_SHELLS];
    for (int i = 0; i < N_SHELLS; i++) {
        names[i] = shells[i].name;
        if (strcmp(name, names[i]) == 0) {
            shells[i].print(stdout);
            return EVL_EXIT_OK;
        }
    }
    CLEANUP_FREE char *known = words_join(N_SHELLS, names, ", "), *hint = suggest_phrase(name, N_SHELLS, names);
    evl_error_set(error, EVL_EXIT_USAGE, "", "unknown shell '%s'%s; completions exist for %s", name, hint, known);
    return error->code;
}

static const option_row rows[] = {
    OPTION_ROW_HELP,
};

const command completion_command = {
    .name = "completion",
    .synopsis = "bash | zsh | fish",
    .summary = "print a script for command line completion",
    .text = "Prints a script for the completion of commands, options, case files, and the paths of numbers after\n"
            "--set. To activate it in the current bash:  source <(evolvent completion bash)\n"
            "\n"
            "Examples:\n"
            "  evolvent completion bash\n"
            "  evolvent completion fish\n",
    .file = COMPLETION_SHELL,
    .size = 1, /* no options */
    OPTION_ROWS(rows),
    .run = completion,
};
