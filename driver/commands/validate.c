#include "base/memory.h"
#include "case/case.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "commands/warn.h"
#include "simulate/case_start.h"

typedef struct {
    option_values set;
    bool quiet;
} validate_options;

/** Checks that `evolvent run` makes before it touches a file; a refusal is printed here, so that the next case is
 *  checked too. */
static evl_exit validate(const char *file, const void *given, evl_error *error)
{
    (void)error;
    const validate_options *options = given;
    evl_error refusal = {.code = EVL_EXIT_OK};
    case_plan plan = {0};
    const bool good =
        cached_case(&plan, file, &options->set, PLAN_ROOTS_OF_CASE, &refusal) && case_start_check(&plan, &refusal);
    if (!good) {
        (void)fflush(stdout); /* keep the lines in the order of the cases */
        evl_error_print(stderr, &refusal);
    } else {
        if (!options->quiet) {
            printf("%s: ok\n", plan.path);
        }
        (void)fflush(stdout);
        warn_of_file(&plan);
    }
    case_plan_free(&plan);
    return refusal.code;
}

static const option_row rows[] = {
    OPTION_ROW_SET(validate_options),
    {OPTION_FLAG, 'q', "--quiet", NULL, offsetof(validate_options, quiet), "print nothing for valid cases"},
    OPTION_ROW_HELP,
};

const command validate_command = {
    .name = "validate",
    .synopsis = "CASE.yaml... [--set PATH=VALUE]... [-q]",
    .summary = "check cases without running them; write no files",
    .text =
        "Reads each case, builds its gearbox and computes its initial state, as 'evolvent run' does before it\n"
        "writes files. For a valid case it prints 'CASE.yaml: ok'. For an invalid case it prints the error message\n"
        "of 'run' on stderr. The orbit of a periodic start is not computed. Warnings are printed on stderr,\n"
        "including those of numbers outside their plausible ranges. The exit code is the highest exit code of\n"
        "'run' for these cases. CASE.yaml may be -, standard input.\n"
        "\n"
        "Examples:\n"
        "  evolvent validate examples/paper.yaml examples/two-stage.yaml\n"
        "  evolvent validate examples/paper.yaml --set wheels.gear.teeth=40\n",
    .file = "case file",
    .takes_several = true,
    .size = sizeof(validate_options),
    OPTION_ROWS(rows),
    .run = validate,
};
