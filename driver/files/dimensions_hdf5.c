#include "files/dimensions_hdf5.h"

#include "base/memory.h"
#include "base/words.h"

static const char harmonic[] = "harmonic";
static const char *const axes[] = {"x", "y", "z"}, *const parts[] = {"w", "x", "y", "z"};

/** In the order of the file. */
static const struct {
    const char *name, *long_names[2]; /**< by use */
    bool is_always;                   /**< in a history too, with or without an output */
    name_list names;                  /**< n = 0: those of the case */
} table[N_NAMED_DIMENSIONS] = {
    {"wheel", {"wheel", "name of the wheel"}, true, {0, NULL}},
    {"mesh", {"mesh", "name of the mesh"}, true, {0, NULL}},
    {"shaft", {"shaft", "name of the shaft"}, false, {0, NULL}},
    {"accelerometer", {"accelerometer", "name of the accelerometer"}, false, {0, NULL}},
    {"axis", {"axis of the housing frame", "axis of the housing frame"}, true, {2, axes}},
    {"space", {"component of a vector in space", "axis of a frame"}, false, {3, axes}},
    {"quaternion", {"component of a quaternion", "part of a quaternion"}, false, {4, parts}},
    {"pair", {"place of a tooth pair: flank and slot", "place of a tooth pair: flank and slot"}, false, {0, NULL}},
};

static bool is_used(int dimension, int n_outputs, const model_output *outputs)
{
    bool is_used = table[dimension].is_always;
    for (int i = 0; i < n_outputs; i++) {
        is_used = is_used || (outputs[i].count > 0 && words_contain(outputs[i].dims, table[dimension].name));
    }
    return is_used;
}

void dimensions_name(dimensions *dimensions, int n_coordinates, const history_coordinate *coordinates)
{
    for (int i = 0; i < n_coordinates && i < N_DIMENSIONS; i++) {
        dimensions->names[i] = coordinates[i].name;
    }
    for (int i = 0; i < N_NAMED_DIMENSIONS && n_coordinates == 0; i++) {
        dimensions->names[i] = table[i].name;
    }
    if (n_coordinates == 0) {
        dimensions->names[N_NAMED_DIMENSIONS] = harmonic;
    }
}

bool dimensions_define(dimensions *dimensions, netcdf_file *file, dimensions_use use, const model_names *names,
                       int n_outputs, const model_output *outputs)
{
    const name_list *const of_case[N_NAMED_DIMENSIONS] = {
        &names->wheels, &names->meshes, &names->shafts, &names->accelerometers, NULL, NULL, NULL, &names->pairs};
    bool good = true;
    for (int i = 0; i < N_NAMED_DIMENSIONS && good; i++) {
        dimensions->names[i] = table[i].name;
        if (use == DIMENSIONS_OF_STACK || is_used(i, n_outputs, outputs)) {
            good = netcdf_define_names(file, file->id, &dimensions->of[i], table[i].name, table[i].long_names[use],
                                       of_case[i] != NULL ? of_case[i] : &table[i].names);
        }
    }
    return good;
}

bool dimensions_define_harmonics(dimensions *dimensions, netcdf_file *file, int n)
{
    const netcdf_variable variable =
        netcdf_describe(NETCDF_INTEGER, harmonic, "1", "n", "harmonic: multiple of the frequency of the mesh");
    OWNED double *numbers = xcalloc((size_t)n, sizeof *numbers);
    for (int i = 0; i < n; i++) {
        numbers[i] = i + 1;
    }
    dimensions->names[N_NAMED_DIMENSIONS] = harmonic;
    return netcdf_define_values(file, file->id, &dimensions->of[N_NAMED_DIMENSIONS], &variable, n, H5T_NATIVE_DOUBLE,
                                numbers);
}

bool dimensions_define_numbers(dimensions *dimensions, netcdf_file *file, int n, const history_coordinate *coordinates)
{
    bool good = n <= N_DIMENSIONS;
    for (int i = 0; i < n && good; i++) {
        const history_coordinate *from = &coordinates[i];
        const netcdf_variable variable = netcdf_describe(from->is_integer ? NETCDF_INTEGER : NETCDF_REAL, from->name,
                                                         from->units, from->symbol, from->long_name);
        dimensions->names[i] = from->name;
        good = netcdf_define_values(file, file->id, &dimensions->of[i], &variable, from->n, H5T_NATIVE_DOUBLE,
                                    from->values);
    }
    return good;
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
        if (dimensions->names[i] != NULL && words_contain(output->dims, dimensions->names[i])) {
            variable->dimensions[variable->rank++] = &dimensions->of[i];
        }
    }
}

bool dimensions_finish(dimensions *dimensions, netcdf_file *file)
{
    bool good = true;
    for (int i = 0; i < N_DIMENSIONS && good; i++) {
        good = scale_list_users(file, &dimensions->of[i].scale);
    }
    return good;
}
