#include "analyses/modes_find.h"
#include "base/interrupt.h"
#include "commands/cached_case.h"
#include "commands/command.h"
#include "commands/warn.h"

typedef struct {
    modes_request request;
    option_values set;
    bool json; /**< one JSON object, else tables */
} modes_options;

static void modes_of(const case_plan *plan, const modes_options *options, const modes_point *point, evl_error *error)
{
    modes_request request = options->request;
    modes_report report;
    request.is_shown = true;
    request.interrupt = &interrupt_signal;
    request.who = interrupt_name;
    if (modes_find(plan, &request, point, &report, error)) {
        warn_of_case(plan, &report.start);
        (options->json ? modes_print_json : modes_print_text)(stdout, &report);
    }
    modes_free(&report);
}

static evl_exit modes(const char *file, const void *given, evl_error *error)
{
    const modes_options *options = given;
    case_plan plan = {0};
    modes_point point;
    interrupt_install();
    if (modes_read(&options->request, &point, error) &&
        cached_case(&plan, file, &options->set, PLAN_ROOTS_OF_CASE, error)) {
        modes_of(&plan, options, &point, error);
    }
    case_plan_free(&plan);
    return error->code;
}

static const char *check(const void *given)
{
    const modes_options *options = given;
    return modes_check(&options->request);
}

static const option_row rows[] = {
    {OPTION_TEXT, 0, "--at", "TIME", offsetof(modes_options, request.at),
     "linearise the motion of the case at this time, in s or with a unit such as '20 ms'"},
    {OPTION_TEXT, 0, "--mesh-position", "X", offsetof(modes_options, request.mesh_position),
     "linearise at X pitches from the start of contact of the first mesh in the power flow; if not given, inside a "
     "contact zone"},
    {OPTION_FLAG, 0, "--mean", NULL, offsetof(modes_options, request.mean),
     "average the linearised gearbox over all positions of the meshes"},
    OPTION_ROW_SET(modes_options),
    OPTION_ROW_JSON(modes_options),
    OPTION_ROW_HELP,
};

const command modes_command = {
    .name = "modes",
    .synopsis = "CASE.yaml [--at TIME | --mesh-position X | --mean] [--set PATH=VALUE]... [--json]",
    .summary = "print natural frequencies, damping ratios and mode shapes",
    .text =
        "Linearises the gearbox and prints its natural frequencies, damping ratios and mode shapes. By default it\n"
        "is linearised in the steady state under load, whatever the initial state of the case, at the mesh\n"
        "position of --mesh-position. --mean averages over all positions of the meshes. --at linearises the motion\n"
        "of the case at a given time.\n"
        "\n"
        "Examples:\n"
        "  evolvent modes examples/paper.yaml\n"
        "  evolvent modes examples/spur-pair.yaml --mesh-position 0.25\n"
        "  evolvent modes examples/spur-pair.yaml --mean\n"
        "  evolvent modes examples/paper-friction.yaml --at 0.5 --json\n",
    .file = "case file",
    .size = sizeof(modes_options),
    OPTION_ROWS(rows),
    .check = check,
    .run = modes,
};
