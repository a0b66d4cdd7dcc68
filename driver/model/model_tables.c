#include "model/model.h"

#include "model/model_kernel.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* Data common to all models are copied from the kernel once, by the first thread that needs them. */
static pthread_once_t once = PTHREAD_ONCE_INIT;
static struct model_tables tables;
static int n_outputs;
static evl_output *output_texts; /**< [n_outputs] */
static model_output *outputs;    /**< [n_outputs] without offsets */
static int *outputs_by_name;     /**< [n_outputs] in the order of their names */

int model_take_outputs(int of, evl_output **texts, model_output **outputs)
{
    static const char *const dims[] = {
        [EVL_DIMS_NONE] = "",
        [EVL_DIMS_WHEEL] = "wheel",
        [EVL_DIMS_MESH] = "mesh",
        [EVL_DIMS_WHEEL_AXIS] = "wheel axis",
        [EVL_DIMS_MESH_AXIS] = "mesh axis",
        [EVL_DIMS_SPACE] = "space",
        [EVL_DIMS_QUATERNION] = "quaternion",
        [EVL_DIMS_WHEEL_SPACE] = "wheel space",
        [EVL_DIMS_MESH_PAIR] = "mesh pair",
        [EVL_DIMS_SHAFT] = "shaft",
        [EVL_DIMS_POSITION] = "position",
        [EVL_DIMS_POSITION_PAIR] = "position pair",
        [EVL_DIMS_HARMONIC] = "harmonic",
        [EVL_DIMS_ACCELEROMETER] = "accelerometer",
        [EVL_DIMS_POSITION_WHEEL] = "position wheel",
    };
    const int n = evl_table(of, 0, NULL);
    evl_output *from = *texts = xcalloc((size_t)n, sizeof *from);
    model_output *to = *outputs = xcalloc((size_t)n, sizeof *to);
    (void)evl_table(of, n, from);
    for (int i = 0; i < n; i++) {
        to[i] = (model_output){.name = from[i].name,
                               .units = from[i].units,
                               .symbol = from[i].symbol,
                               .long_name = from[i].long_name,
                               .dims = dims[from[i].dims],
                               .rate_of = from[i].rate_of[0] == '\0' ? NULL : from[i].rate_of,
                               .is_static = from[i].is_static,
                               .is_integer = from[i].is_integer};
    }
    return n;
}

/** Description of the extreme of an output, or of its time. */
static model_output describe_extreme(const evl_output *from, bool is_time)
{
    const char *which = from->is_largest ? "max" : "min";
    return (model_output){.name = xasprintf("%s_%s%s", from->name, which, is_time ? "_time" : ""),
                          .units = is_time ? "s" : from->units,
                          .symbol = is_time ? "t" : xasprintf("%s %s", which, from->symbol),
                          .long_name = is_time ? xasprintf("first time of the %s", from->long_name) : from->long_name,
                          .dims = "mesh",
                          .is_static = true};
}

static void copy_extremes(void)
{
    evl_output *texts;
    CLEANUP_FREE model_output *rows = NULL;
    const int n = tables.n_extremes = model_take_outputs(EVL_TABLE_OF_EXTREMES, &texts, &rows);
    model_extreme *extremes = xcalloc((size_t)n, sizeof *extremes);
    for (int i = 0; i < n; i++) {
        extremes[i] = (model_extreme){.output = texts[i].name,
                                      .value = describe_extreme(&texts[i], false),
                                      .time = describe_extreme(&texts[i], true),
                                      .monitored = texts[i].monitored,
                                      .is_largest = texts[i].is_largest};
        tables.n_monitored = texts[i].monitored < tables.n_monitored ? tables.n_monitored : texts[i].monitored + 1;
    }
    tables.extremes = extremes;
}

static int compare_outputs(const void *a, const void *b)
{
    return strcmp(outputs[*(const int *)a].name, outputs[*(const int *)b].name);
}

static int compare_with_name(const void *name, const void *index)
{
    return strcmp(name, outputs[*(const int *)index].name);
}

static void copy_outputs(void)
{
    n_outputs = model_take_outputs(EVL_TABLE_OF_STATE, &output_texts, &outputs);
    outputs_by_name = xcalloc((size_t)n_outputs, sizeof *outputs_by_name);
    for (int i = 0; i < n_outputs; i++) {
        outputs_by_name[i] = i;
    }
    qsort(outputs_by_name, (size_t)n_outputs, sizeof *outputs_by_name, compare_outputs);
}

static void copy_rows(void)
{
    enum { USUAL_ROWS = 256 };
    evl_row *rows = xcalloc(USUAL_ROWS, sizeof *rows);
    const int n = evl_rows(USUAL_ROWS, rows);
    if (n > USUAL_ROWS) {
        rows = xrealloc(rows, (size_t)n, sizeof *rows);
        (void)evl_rows(n, rows);
    }
    tables.schema = (case_schema){.n = n, .rows = rows};
}

static void copy_event_kinds(void)
{
    evl_kind *kinds = model_kinds("event", &tables.n_event_kinds);
    const char **names = xcalloc((size_t)tables.n_event_kinds, sizeof *names);
    for (int kind = 0; kind < tables.n_event_kinds; kind++) {
        names[kind] = kinds[kind].name;
    }
    tables.event_kinds = names;
}

static void copy_tables(void)
{
    tables.compiler = evl_kernel_compiler();
    tables.processor = evl_kernel_processor();
    copy_rows();
    copy_event_kinds();
    copy_outputs();
    copy_extremes();
}

const struct model_tables *model_tables(void)
{
    (void)pthread_once(&once, copy_tables);
    return &tables;
}

const case_schema *model_schema(void)
{
    return &model_tables()->schema;
}

evl_kind *model_kinds(const char *block, int *n)
{
    *n = evl_kinds(block, 0, NULL);
    evl_kind *kinds = xcalloc((size_t)*n, sizeof *kinds);
    (void)evl_kinds(block, *n, kinds);
    return kinds;
}

double *model_parameter_at(const model *model, int index, evl_parameter *parameter)
{
    if (!evl_description_parameter(model->description, index, parameter, 0, NULL)) {
        return NULL;
    }
    double *numbers = xcalloc((size_t)parameter->n, sizeof *numbers);
    (void)evl_description_parameter(model->description, index, parameter, parameter->n, numbers);
    return numbers;
}

void model_describe_outputs(model *model)
{
    const evl_sizes *sizes = &model->sizes;
    const size_t n = (size_t)sizes->n_outputs;
    (void)pthread_once(&once, copy_tables);
    model_output *own = memcpy(arena_calloc(&model->arena, n, sizeof *own), outputs, n * sizeof *own);
    CLEANUP_FREE int *offsets = xcalloc(n, sizeof *offsets), *counts = xcalloc(n, sizeof *counts);
    evl_gearbox_output_layout(model->gearbox, offsets, counts);
    for (int i = 0; i < sizes->n_outputs; i++) {
        own[i].offset = offsets[i];
        own[i].count = counts[i];
    }
    model->about.outputs = own;
    model->about.n_outputs = sizes->n_outputs;
    model->about.n_values = sizes->n_values;
}

const model_output *model_output_named(const model *model, const char *name)
{
    const int *found =
        bsearch(name, outputs_by_name, (size_t)model->sizes.n_outputs, sizeof *outputs_by_name, compare_with_name);
    return found == NULL ? NULL : &model->about.outputs[*found];
}

int model_output_offset(const model *model, const char *name)
{
    const model_output *found = model_output_named(model, name);
    return found == NULL ? -1 : found->offset;
}

double model_output_value(const model *model, const double *values, const char *name, int index)
{
    const int offset = model_output_offset(model, name);
    return offset < 0 ? NAN : values[offset + index];
}

void model_constants(const model *model, double *values)
{
    evl_gearbox_constants(model->gearbox, values);
}

model_state *model_states(const model *model)
{
    model_state *states = xcalloc((size_t)model->sizes.n_states, sizeof *states);
    for (int i = 0; i < model->sizes.n_states; i++) {
        evl_gearbox_state_name(model->gearbox, i, states[i].name, states[i].units);
    }
    return states;
}
