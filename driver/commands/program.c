#include "commands/help.h"
#include "files/history.h"
#include "integrate/integrate.h"
#include "model/model.h"

#include <evolvent_version.h>
#include <stdio.h>

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
     "print the versions of the program and its libraries"},
};

const command program_command = {
    .name = "",
    .synopsis = "COMMAND ... | --help | --version",
    .summary = "Simulates the dynamics of spur gearboxes with involute gears.",
    .text = "Example:\n"
            "  evolvent run examples/paper.yaml        integrates the case, writes paper.h5\n"
            "\n"
            "'evolvent COMMAND --help' describes a command.\n",
    .size = sizeof(program_options),
    OPTION_ROWS(rows),
    .run = print_versions,
};
