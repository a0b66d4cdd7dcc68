#include "base/interrupt.h"
#include "base/log.h"
#include "base/status.h"
#include "batch/batch.h"
#include "commands/cli.h"
#include "commands/modes.h"
#include "commands/run.h"
#include "commands/show.h"
#include "files/history.h"
#include "integrate/integrate.h"
#include "simulate/prepare.h"

#include <errno.h>
#include <evolvent_version.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static evl_exit run_command(const cli_options *options, evl_error *error)
{
    const run_options settings = {.case_path = options->case_path,
                                  .output = options->output,
                                  .n_set = options->n_set,
                                  .set = options->set,
                                  .show_progress = !options->quiet};
    log_set_quiet(options->quiet);
    interrupt_install();
    return run_case(&settings, error);
}

static evl_exit show_command(const cli_options *options, evl_error *error)
{
    if (options->laws) {
        return (evl_exit)show_laws(stdout, model_laws());
    }
    if (options->keys) {
        return (evl_exit)show_keys(stdout, model_laws());
    }
    prepared_case prepared;
    (void)prepare_to_show(&prepared, options->case_path, options->n_set, options->set, error);
    int code = error->code;
    if (prepared.file != NULL) {
        const int shown = options->json ? show_json(stdout, &prepared, error) : show_text(stdout, &prepared);
        code = shown != EVL_EXIT_OK ? shown : code;
    }
    prepared_case_free(&prepared);
    return (evl_exit)code;
}

static evl_exit modes_command(const cli_options *options, evl_error *error)
{
    const modes_options settings = {.case_path = options->case_path,
                                    .at = options->at,
                                    .mesh_position = options->mesh_position,
                                    .mean = options->mean,
                                    .n_set = options->n_set,
                                    .set = options->set,
                                    .json = options->json};
    interrupt_install();
    return modes_case(&settings, stdout, error);
}

static evl_exit batch_command(const cli_options *options, evl_error *error)
{
    const batch_options settings = {.design = options->case_path,
                                    .folder = options->output,
                                    .shard = options->shard,
                                    .jobs = options->jobs,
                                    .cases = options->cases,
                                    .resume = options->resume,
                                    .check = options->check,
                                    .show_progress = !options->quiet};
    log_set_quiet(options->quiet);
    interrupt_install();
    return batch(&settings, error);
}

static void print_versions(void)
{
    const char *processor = model_processor();
    printf("evolvent %s\n%s\n%s\nC compiler %s\nFortran compiler %s\n", EVOLVENT_VERSION, integrate_version(),
           history_version(), EVOLVENT_C_COMPILER, model_compiler());
    printf("kernel compiled for %s\n", *processor ? processor : "the compiler's usual processor");
}

static evl_exit execute(const cli_options *options, evl_error *error)
{
    switch (options->command) {
    case CLI_RUN:
        return run_command(options, error);
    case CLI_SHOW:
        return show_command(options, error);
    case CLI_MODES:
        return modes_command(options, error);
    case CLI_BATCH:
        return batch_command(options, error);
    case CLI_VERSION:
        print_versions();
        return EVL_EXIT_OK;
    case CLI_NOTHING:
        break;
    }
    return (evl_exit)options->exit_code;
}

int main(int argc, char **argv)
{
    cli_options options;
    evl_error error = {.code = EVL_EXIT_OK};
    errno = 0;
    cli_parse(argc, argv, &options);
    evl_exit code = execute(&options, &error);
    cli_free(&options);
    if ((fflush(stdout) != 0 || ferror(stdout) != 0 || code == EVL_EXIT_IO) && error.code == EVL_EXIT_OK) {
        evl_error_set(&error, EVL_EXIT_IO, "", "cannot write to standard output%s%s", errno != 0 ? ": " : "",
                      errno != 0 ? strerror(errno) : "");
        code = EVL_EXIT_IO;
    }
    if (error.code != EVL_EXIT_OK) {
        evl_error_print(stderr, &error);
    }
    if (code == EVL_EXIT_IO) {
        _exit(code); /* a library that could not write has nothing to tidy up in peace */
    }
    return code;
}
