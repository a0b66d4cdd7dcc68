#include "base/status.h"
#include "commands/cli.h"
#include "files/history.h"
#include "integrate/integrate.h"
#include "model/model.h"

#include <errno.h>
#include <evolvent_version.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    bool version;
} program_options;

static evl_exit print_versions(const char *file, const void *options, evl_error *error)
{
    (void)file, (void)options;
    const char *processor = model_tables()->processor;
    printf("evolvent %s\n%s\n%s\nC compiler %s\nFortran compiler %s\n", EVOLVENT_VERSION, integrate_version(),
           history_version(), EVOLVENT_C_COMPILER, model_tables()->compiler);
    printf("kernel compiled for %s\n", *processor ? processor : "the compiler's usual processor");
    return error->code;
}

static const option_row rows[] = {
    OPTION_ROW_HELP,
    {OPTION_ALONE, 'V', "--version", NULL, offsetof(program_options, version),
     "versions of the program and of its libraries"},
};

static const command program = {
    .name = "",
    .synopsis = "COMMAND ... | --help | --version",
    .summary = "Dynamics of spur gearboxes with involute teeth in contact.",
    .text = "Example:\n"
            "  evolvent run examples/paper.yaml        integrates the case, writes paper.h5\n"
            "\n"
            "'evolvent COMMAND --help' tells more about a command.\n",
    .size = sizeof(program_options),
    OPTION_ROWS(rows),
    .run = print_versions,
};

int main(int argc, char **argv)
{
    evl_error error = {.code = EVL_EXIT_OK};
    errno = 0;
    evl_exit code = cli_run(&program, argc, argv, &error);
    if (fflush(stdout) != 0 || ferror(stdout) != 0) { /* a full disk, or a closed pipe */
        code = EVL_EXIT_IO;
        if (error.code == EVL_EXIT_OK) {
            evl_error_set(&error, code, "", "cannot write to standard output%s%s", errno != 0 ? ": " : "",
                          errno != 0 ? strerror(errno) : "");
        }
    }
    if (error.code != EVL_EXIT_OK) {
        evl_error_print(stderr, &error);
    }
    if (code == EVL_EXIT_IO) {
        _exit(code); /* a library that could not write has nothing to tidy up in peace */
    }
    return code;
}
