/* A response in memory: response.h for the library, which does not use HDF5. */
#include "files/history_memory.h"
#include "files/response_rows.h"

#include <stdlib.h>

/** A copy of numbers that is valid after the call. */
static const void *own_numbers(history *history, netcdf_type type, size_t n, const double *numbers)
{
    const double *copy = arena_grow(&history->body.arena, numbers, n, n, sizeof *copy);
    return history_numbers(history, type, (int)n, copy);
}

static bool store_attribute(void *self, const history_attribute *attribute)
{
    history_store_attribute(self, attribute);
    return true;
}

static bool store_axis(void *self, netcdf_dimension *dimension, const netcdf_variable *coordinate, int n,
                       const void *values)
{
    history *history = self;
    const bool is_text = coordinate->type == NETCDF_TEXT;
    *dimension = (netcdf_dimension){.name = coordinate->name, .length = (unsigned long long)n};
    const dimension_values all = {
        .is_there = true,
        .variable = *coordinate,
        .n = n,
        .names = is_text ? values : NULL,
        .numbers = is_text ? NULL : own_numbers(history, NETCDF_REAL, (size_t)n, values),
    };
    history_store_coordinate(history, dimension, &all, false);
    return true;
}

static bool store_variable(void *self, const netcdf_variable *variable, const double *values)
{
    history *history = self;
    size_t n = 1;
    for (int i = 0; i < variable->rank; i++) {
        n *= (size_t)variable->dimensions[i]->length;
    }
    history_store_variable(history, variable, false, own_numbers(history, variable->type, n, values));
    return true;
}

bool response_write(const response *response, bool commit, evl_error *error)
{
    (void)commit;
    (void)error;
    history *history = xcalloc(1, sizeof *history);
    response_axes *axes = arena_calloc(&history->body.arena, 1, sizeof *axes);
    axes->arena = &history->body.arena;
    const response_sink sink = {
        .self = history, .attribute = store_attribute, .axis = store_axis, .variable = store_variable};
    (void)response_transfer(response, axes, &sink); /* this sink never fails */
    *response->in_memory = history;
    return true;
}
