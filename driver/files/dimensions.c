#include "files/dimensions.h"

#include "base/memory.h"
#include "base/words.h"

static const char *const axes[] = {"x", "y", "z"}, *const parts[] = {"w", "x", "y", "z"};

/** In the order of the file. */
static const struct {
    const char *name, *long_names[2]; /**< by use */
    bool is_always;                   /**< also in a history, with or without an output */
    name_list names;                  /**< n = 0: names from the case */
} table[N_NAMED_DIMENSIONS] = {
    {"wheel", {"wheel", "name of the wheel"}, true, {0, NULL}},
    {"mesh", {"mesh", "name of the mesh"}, true, {0, NULL}},
    {"shaft", {"shaft", "name of the shaft"}, false, {0, NULL}},
    {"accelerometer", {"accelerometer", "name of the accelerometer"}, false, {0, NULL}},
    {"axis", {"axis of the housing frame", "axis of the housing frame"}, true, {2, axes}},
    {"space", {"component of a vector in space", "axis of a frame"}, false, {3, axes}},
    {"quaternion", {"component of a quaternion", "part of a quaternion"}, false, {4, parts}},
    {"pair", {"slot of a tooth pair: flank and number", "slot of a tooth pair: flank and number"}, false, {0, NULL}},
};

static bool is_used(int dimension, int n_outputs, const model_output *outputs)
{
    bool is_used = table[dimension].is_always;
    for (int i = 0; i < n_outputs; i++) {
        is_used = is_used || (outputs[i].count > 0 && words_contain(outputs[i].dims, table[dimension].name));
    }
    return is_used;
}

static void put(dimensions *dimensions, int i, const dimension_values *values)
{
    dimensions->of[i] = (netcdf_dimension){.name = values->variable.name, .length = (unsigned long long)values->n};
    dimensions->values[i] = *values;
}

static dimension_values of_names(const char *name, const char *long_name, const name_list *names)
{
    return (dimension_values){.is_there = true,
                              .variable = netcdf_describe(NETCDF_TEXT, name, "1", name, long_name),
                              .n = names->n,
                              .names = names->names};
}

static dimension_values of_numbers(const netcdf_variable *variable, int n, const double *numbers)
{
    return (dimension_values){.is_there = true, .variable = *variable, .n = n, .numbers = numbers};
}

void dimensions_plan(dimensions *dimensions, dimensions_use use, const model_names *names, int n_outputs,
                     const model_output *outputs)
{
    const name_list *const of_case[N_NAMED_DIMENSIONS] = {
        &names->wheels, &names->meshes, &names->shafts, &names->accelerometers, NULL, NULL, NULL, &names->pairs};
    for (int i = 0; i < N_NAMED_DIMENSIONS; i++) {
        dimensions->of[i].name = table[i].name;
        if (use == DIMENSIONS_OF_STACK || is_used(i, n_outputs, outputs)) {
            const dimension_values values =
                of_names(table[i].name, table[i].long_names[use], of_case[i] != NULL ? of_case[i] : &table[i].names);
            put(dimensions, i, &values);
        }
    }
}

void dimensions_plan_harmonics(dimensions *dimensions, memory_arena *arena, int n)
{
    const netcdf_variable variable =
        netcdf_describe(NETCDF_INTEGER, "harmonic", "1", "n", "harmonic: multiple of the frequency of the mesh");
    double *numbers = arena_calloc(arena, (size_t)n, sizeof *numbers);
    for (int i = 0; i < n; i++) {
        numbers[i] = i + 1;
    }
    const dimension_values values = of_numbers(&variable, n, numbers);
    put(dimensions, N_NAMED_DIMENSIONS, &values);
}

void dimensions_plan_numbers(dimensions *dimensions, int n, const history_coordinate *coordinates)
{
    for (int i = 0; i < n && i < N_DIMENSIONS; i++) {
        const history_coordinate *from = &coordinates[i];
        const netcdf_variable variable = netcdf_describe(from->is_integer ? NETCDF_INTEGER : NETCDF_REAL, from->name,
                                                         from->units, from->symbol, from->long_name);
        const name_list names = {from->n, from->names};
        const dimension_values values = from->names != NULL ? of_names(from->name, from->long_name, &names)
                                                            : of_numbers(&variable, from->n, from->values);
        put(dimensions, i, &values);
    }
}

netcdf_variable dimensions_describe(dimensions *dimensions, const model_output *output)
{
    netcdf_variable variable = netcdf_describe(output->is_integer ? NETCDF_INTEGER : NETCDF_REAL, output->name,
                                               output->units, output->symbol, output->long_name);
    dimensions_append(dimensions, output, &variable);
    return variable;
}

void dimensions_append(dimensions *dimensions, const model_output *output, netcdf_variable *variable)
{
    for (int i = 0; i < N_DIMENSIONS; i++) {
        if (dimensions->of[i].name != NULL && words_contain(output->dims, dimensions->of[i].name)) {
            variable->dimensions[variable->rank++] = &dimensions->of[i];
        }
    }
}
