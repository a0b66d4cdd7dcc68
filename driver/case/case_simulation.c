/* The block `simulation` of a case: start, outputs, window of the metrics, integrator. */
#include "case/case_file.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"
#include "case/case_check.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* more outputs are a typing error */
static const double MOST_OUTPUTS = 1e9;

/** Sort named numbers into the order of `names`. */
static bool take_named(const checker *checker, const case_node *numbers, const char *what, int n,
                       const char *const *names, double *values)
{
    for (int i = 0; i < numbers->n; i++) {
        const case_entry *entry = &numbers->entries[i];
        const int index = words_index(entry->key, n, names);
        if (index < 0) {
            CLEANUP_FREE char *hint = suggest_phrase(entry->key, n, names);
            return checker_refuse(checker, entry->key_location, "there is no %s '%.64s'%s", what, entry->key, hint);
        }
        values[index] = node_number(entry->value);
    }
    return true;
}

static bool take_speeds(const checker *checker, const case_node *speeds, const description *description, double *values)
{
    if (!take_named(checker, speeds, "wheel", description->n_wheels, description->wheels, values)) {
        return false;
    }
    for (int i = 0; i < description->n_wheels; i++) {
        if (node_get(speeds, description->wheels[i]) == NULL) {
            return checker_refuse(checker, speeds->location, "the speed of wheel '%s' is missing",
                                  description->wheels[i]);
        }
    }
    return true;
}

static bool take_gaps(const checker *checker, case_node *gaps, const description *description, double *values)
{
    if (!take_named(checker, gaps, "mesh", description->n_meshes, description->meshes, values)) {
        return false;
    }
    for (int i = 0; i < description->n_meshes; i++) {
        if (node_get(gaps, description->meshes[i]) == NULL) {
            node_append(gaps, description->meshes[i], gaps->location,
                        node_create_scalar(gaps->arena, "0", true, gaps->location));
        }
    }
    return true;
}

static bool take_initial(const checker *checker, case_node *block, description *description)
{
    static const char *const kinds[] = {[EVL_INITIAL_REST] = "rest",
                                        [EVL_INITIAL_STEADY] = "steady",
                                        [EVL_INITIAL_SPEEDS] = "speeds",
                                        [EVL_INITIAL_PERIODIC] = "periodic"};
    evl_initial *initial = &description->simulation.initial;
    const struct checker of_speeds = checker_at(checker, "speeds"), of_gaps = checker_at(checker, "gaps");
    initial->kind = words_index(node_get_text(block, "kind"), sizeof kinds / sizeof *kinds, kinds);
    if (initial->kind == EVL_INITIAL_SPEEDS) {
        double *values = arena_calloc(&description->arena, (size_t)description->n_wheels, sizeof *values);
        initial->speeds = values;
        if (!take_speeds(&of_speeds, node_get(block, "speeds"), description, values)) {
            return false;
        }
    }
    const case_node *position = node_get(block, "position");
    const bool has_path = initial->kind == EVL_INITIAL_STEADY || initial->kind == EVL_INITIAL_PERIODIC;
    initial->mesh_position = !has_path ? 0.0 : position == NULL ? NAN : node_number(position);
    if (!has_path) {
        double *values = arena_calloc(&description->arena, (size_t)description->n_meshes, sizeof *values);
        initial->gaps = values;
        if (!take_gaps(&of_gaps, node_get(block, "gaps"), description, values)) {
            return false;
        }
    }
    return true;
}

/** Read the window of the key figures. @param block  NULL: none is given */
static bool take_metrics(const checker *checker, const case_node *block, description *description)
{
    simulation_description *simulation = &description->simulation;
    const case_node *from = block == NULL ? NULL : node_get(block, "from"),
                    *to = block == NULL ? NULL : node_get(block, "to");
    const char *mesh = block == NULL ? NULL : node_get_text(block, "pitches_of");
    const char *wheel = block == NULL ? NULL : node_get_text(block, "turns_of");
    metrics_description *metrics = &simulation->metrics;
    *metrics = (metrics_description){
        .is_set = block != NULL,
        .from = from == NULL ? simulation->duration / 2 : node_number(from),
        .to = to == NULL ? simulation->duration : node_number(to),
        .mesh = mesh == NULL ? 0 : words_index(mesh, description->n_meshes, description->meshes),
        .wheel = wheel == NULL ? -1 : words_index(wheel, description->n_wheels, description->wheels)};
    if (mesh != NULL && wheel != NULL) {
        return checker_refuse(
            checker, node_get(block, "turns_of")->location,
            "periods are pitches of a mesh or revolutions of a wheel, not both; omit pitches_of or turns_of");
    }
    if (to != NULL && metrics->to > simulation->duration) {
        CLEANUP_FREE char *end = node_quantity(to, "s");
        return checker_refuse(checker, to->location,
                              "the window ends at %s, but the case at %.9g s; increase the duration, or omit to", end,
                              simulation->duration);
    }
    return block == NULL || metrics->from < metrics->to ||
           checker_refuse(checker, (from == NULL ? block : from)->location,
                          "the window is from %.9g to %.9g s, which is not a time span; the case ends at %.9g s",
                          metrics->from, metrics->to, simulation->duration);
}

/** Read outputs by position: their number, and the name of the mesh or wheel. @return whether a name is given */
static bool take_positions(const checker *checker, const case_node *number, const char *name, const char *what,
                           simulation_description *simulation)
{
    simulation->output_by.number = (int)node_number(number);
    return name != NULL ||
           checker_refuse(checker, number->location, "'per_%s' needs '%s' in the same block: the name of one",
                          strcmp(what, "mesh") == 0 ? "pitch" : "turn", what);
}

/** Read the interval of an equidistant output grid. */
static bool take_interval(const checker *checker, const case_node *interval, const case_node *duration,
                          simulation_description *simulation)
{
    simulation->output_interval = node_number(interval);
    CLEANUP_FREE char *step = node_quantity(interval, "s"), *span = node_quantity(duration, "s");
    if (simulation->output_interval > simulation->duration) {
        return checker_refuse(checker, interval->location, "is %s, longer than the duration of %s", step, span);
    }
    return simulation->duration / simulation->output_interval <= MOST_OUTPUTS ||
           checker_refuse(checker, interval->location, "is %s, which gives more than %g rows in %s; give a longer one",
                          step, MOST_OUTPUTS, span);
}

/** Read the block `output`: one of its ways to define output points. Its names exist, which the schema check ensures. */
static bool take_output_block(const checker *checker, const case_node *output, const case_node *duration,
                              description *description)
{
    simulation_description *simulation = &description->simulation;
    const struct checker inside = checker_at(checker, "interval");
    const case_node *interval = node_get(output, "interval"), *per_pitch = node_get(output, "per_pitch"),
                    *per_turn = node_get(output, "per_turn");
    const char *mesh = node_get_text(output, "mesh"), *wheel = node_get_text(output, "wheel");
    const int n = (interval != NULL) + (per_pitch != NULL) + (per_turn != NULL);
    if (n != 1) {
        return checker_refuse(checker, output->location, "has %s of interval, per_pitch and per_turn; give one of them",
                              n == 0 ? "none" : "more than one");
    }
    simulation->output_by.mesh = mesh == NULL ? -1 : words_index(mesh, description->n_meshes, description->meshes);
    simulation->output_by.wheel = wheel == NULL ? -1 : words_index(wheel, description->n_wheels, description->wheels);
    return interval != NULL    ? take_interval(&inside, interval, duration, simulation)
           : per_pitch != NULL ? take_positions(checker, per_pitch, mesh, "mesh", simulation)
                               : take_positions(checker, per_turn, wheel, "wheel", simulation);
}

/** Read `output_interval`, or `output` instead of it. */
static bool take_output(const checker *checker, const case_node *block, description *description)
{
    simulation_description *simulation = &description->simulation;
    const struct checker of_interval = checker_at(checker, "output_interval"),
                         of_output = checker_at(checker, "output");
    const case_node *interval = node_get(block, "output_interval"), *output = node_get(block, "output");
    const case_node *duration = node_get(block, "duration");
    simulation->output_interval = 0;
    simulation->output_by = (position_description){0, -1, -1};
    if (interval != NULL && output != NULL) {
        char other[EVL_ERROR_LOCATION_LENGTH];
        location_text(checker->path, interval->location, other);
        return checker_refuse(&of_output, output->location, "conflicts with output_interval (%s); give one of them",
                              other);
    }
    return output != NULL     ? take_output_block(&of_output, output, duration, description)
           : interval != NULL ? take_interval(&of_interval, interval, duration, simulation)
                              : checker_refuse(checker, block->location,
                                               "'output_interval' is missing (step of the output grid [s]); or else "
                                               "'output', such as {per_pitch: 20, mesh: NAME}");
}

static integrator_kind integrator_of(const case_node *block)
{
    const char *name = node_get_text(block, "integrator");
    return name == NULL ? INTEGRATOR_OPEN : strcmp(name, "radau") == 0 ? INTEGRATOR_RADAU : INTEGRATOR_IDA;
}

static double number_or_none(const case_node *node)
{
    return node == NULL ? 0 : node_number(node);
}

/** @param absent  value if the case does not specify it */
static double limit_of(const case_node *node, double absent)
{
    return node == NULL ? absent : node_is_number(node) ? node_number(node) : DBL_MAX;
}

bool case_resolve_simulation(const struct checker *checker, const case_node *block, description *description)
{
    const struct checker of_tolerance = checker_at(checker, "tolerance"), of_initial = checker_at(checker, "initial");
    const struct checker of_metrics = checker_at(checker, "metrics");
    simulation_description *simulation = &description->simulation;
    simulation->duration = node_get_number(block, "duration");
    simulation->accuracy = number_or_none(node_get(block, "accuracy"));
    simulation->tolerance = number_or_none(node_get(block, "tolerance"));
    simulation->integrator = integrator_of(block);
    simulation->outputs = node_get_text(block, "outputs");
    simulation->max_step = limit_of(node_get(block, "max_step"), 0);
    simulation->most_steps = limit_of(node_get(block, "max_steps"), MOST_STEPS_OF_A_RUN);
    if (!take_output(checker, block, description)) {
        return false;
    }
    if (simulation->integrator == INTEGRATOR_RADAU && !(simulation->accuracy > 0) &&
        simulation->tolerance < RADAU_SMALLEST_TOLERANCE) {
        return checker_refuse(&of_tolerance, node_get(block, "tolerance")->location,
                              "is %s, but integrator radau accepts %g or more; choose integrator ida for less",
                              node_get_text(block, "tolerance"), RADAU_SMALLEST_TOLERANCE);
    }
    return take_initial(&of_initial, node_get(block, "initial"), description) &&
           take_metrics(&of_metrics, node_get(block, "metrics"), description);
}
