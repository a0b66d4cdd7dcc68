#include "base/log.h"
#include "base/memory.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "commands/result.h"
#include "commands/warn.h"
#include "fmu/fmu_write.h"
#include "simulate/case_start.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const char *output, *outputs;
    option_values inputs, set;
    bool quiet;
} fmu_options;

/** Name of a model: that of its file. */
static char *name_of(memory_arena *arena, const char *path)
{
    const char *slash = strrchr(path, '/');
    char *name = arena_copy(arena, slash == NULL ? path : slash + 1), *point = strrchr(name, '.');
    if (point != NULL && point != name) {
        *point = '\0';
    }
    return name;
}

static void write_fmu(const fmu_plan *plan, const char *path, evl_error *error)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const motion_facts *about = motion_about(plan->motion);
    fmu_file *binary;
    const int n = fmu_binary(&arena, &binary, error);
    if (n == 0) {
        return;
    }
    CLEANUP_FREE char *description = fmu_description(plan);
    fmu_file *files = arena_calloc(&arena, (size_t)n + 2, sizeof *files);
    files[0] = (fmu_file){"modelDescription.xml", NULL, description};
    files[1] = (fmu_file){"resources/" FMU_CASE, NULL, case_text(about->plan->file)};
    memcpy(files + 2, binary, (size_t)n * sizeof *files);
    if (fmu_archive(path, n + 2, files, error)) {
        int n_chosen = 0;
        for (int i = 0; i < about->n_inputs; i++) {
            n_chosen += plan->is_chosen[i];
        }
        log_note("%d input%s, %d values of outputs, %d parameters: %s", n_chosen, n_chosen == 1 ? "" : "s",
                 about->plan->n_values, about->n_parameters, path);
    }
}

static void make_fmu(case_plan *of_case, const fmu_options *options, const char *path, evl_error *error)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    warn_of_case(of_case, NULL);
    motion *motion = motion_create(of_case, error);
    if (motion == NULL) {
        return;
    }
    const motion_facts *about = motion_about(motion);
    const fmu_plan plan = {motion, name_of(&arena, path),
                           arena_calloc(&arena, (size_t)about->n_inputs, sizeof *plan.is_chosen)};
    if (fmu_choose_inputs(&plan, options->inputs.n, options->inputs.values, error) &&
        case_start_check(about->plan, error)) {
        write_fmu(&plan, path, error);
    }
    motion_delete(&motion);
}

static evl_exit fmu(const char *file, const void *given, evl_error *error)
{
    const fmu_options *options = given;
    case_plan plan = {0};
    log_set_quiet(options->quiet);
    CLEANUP_FREE char *path = result_path("FMU", options->output, file, ".fmu", error);
    ARENA_SCOPE memory_arena arena = {NULL};
    const option_values set = set_with_outputs(&options->set, options->outputs, &arena);
    if (path != NULL &&
        case_plan_make(&plan, &(plan_request){.name = file, .n_set = set.n, .set = set.values}, error)) {
        make_fmu(&plan, options, path, error);
    }
    case_plan_free(&plan);
    return error->code;
}

static const option_row rows[] = {
    {OPTION_TEXT, 'o', "--output", "FILE.fmu", offsetof(fmu_options, output),
     "file to write; the case's name with .fmu in the current folder if not given"},
    {OPTION_LIST, 0, "--input", "INPUT", offsetof(fmu_options, inputs),
     "wheel:NAME:torque or wheel:NAME:speed: use the constant torque or the prescribed speed of this wheel as an "
     "input; may be repeated"},
    {OPTION_TEXT, 0, "--outputs", "NAMES", offsetof(fmu_options, outputs),
     "output variables and groups of variables of the FMU, separated by commas, as for simulation.outputs"},
    OPTION_ROW_SET(fmu_options),
    OPTION_ROW_QUIET(fmu_options),
    OPTION_ROW_HELP,
};

const command fmu_command = {
    .name = "fmu",
    .synopsis = "CASE.yaml [-o FILE.fmu] [--input INPUT]... [--outputs NAMES] [--set PATH=VALUE]... "
                "[-q]",
    .summary = "export a case as an FMU for other simulation programs",
    .text =
        "Exports the case as a Functional Mock-up Unit (FMI 3.0) for co-simulation, with the integrator radau, and\n"
        "for model exchange. The FMU runs on any x86-64 Linux without evolvent. An input replaces the load\n"
        "{kind: torque, value: ...} or {kind: speed, value: ...} of its wheel. A speed has a second input, its\n"
        "acceleration. The numbers of the case are parameters of the FMU. See docs/guides/fmi.md.\n"
        "\n"
        "Examples:\n"
        "  evolvent fmu examples/spur-pair.yaml\n"
        "  evolvent fmu examples/paper.yaml --set meshes.0.tracking=closed_form --input wheel:pinion:torque -o "
        "pair.fmu\n",
    .file = "case file",
    .size = sizeof(fmu_options),
    OPTION_ROWS(rows),
    .run = fmu,
};
