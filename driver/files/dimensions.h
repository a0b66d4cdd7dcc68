/** Dimensions of outputs, in the order of the words in model_output.dims, and the values of their coordinates. */
#pragma once

#include "files/history.h"
#include "files/netcdf_variable.h"
#include "model/model.h"

typedef enum { DIMENSIONS_OF_HISTORY, DIMENSIONS_OF_STACK } dimensions_use;

/** Those with names, followed by one with numbers: harmonics. */
enum { N_NAMED_DIMENSIONS = 8, N_DIMENSIONS = N_NAMED_DIMENSIONS + 1 };

/** The coordinate of a dimension. */
typedef struct {
    bool is_there;
    netcdf_variable variable;
    int n;
    const char *const *names; /**< [n] of NETCDF_TEXT */
    const double *numbers;    /**< [n] else */
} dimension_values;

typedef struct {
    netcdf_dimension of[N_DIMENSIONS]; /**< all possible dimensions, with their names */
    dimension_values values[N_DIMENSIONS];
} dimensions;

/** Plan the dimensions that the outputs may have, with their names; for a history only those that its outputs have. */
void dimensions_plan(dimensions *dimensions, dimensions_use use, const model_names *names, int n_outputs,
                     const model_output *outputs);
/** Append harmonics 1 to n. */
void dimensions_plan_harmonics(dimensions *dimensions, memory_arena *arena, int n);
/** Plan other dimensions, with numbers or names; at most N_DIMENSIONS. */
void dimensions_plan_numbers(dimensions *dimensions, int n, const history_coordinate *coordinates);

/** The variable of an output, with its dimensions. */
netcdf_variable dimensions_describe(dimensions *dimensions, const model_output *output);
/** Append the dimensions of an output to those of a variable. */
void dimensions_append(dimensions *dimensions, const model_output *output, netcdf_variable *variable);
