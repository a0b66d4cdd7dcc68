/** The dimensions that outputs have, in the order of the words of model_output.dims. Private to *_hdf5.c. */
#pragma once

#include "files/history.h"
#include "files/netcdf_hdf5.h"
#include "model/model.h"

typedef enum { DIMENSIONS_OF_HISTORY, DIMENSIONS_OF_STACK } dimensions_use;

/** Those with names, and behind them one with numbers: harmonics. */
enum { N_NAMED_DIMENSIONS = 8, N_DIMENSIONS = N_NAMED_DIMENSIONS + 1 };

typedef struct {
    const char *names[N_DIMENSIONS];
    netcdf_dimension of[N_DIMENSIONS];
} dimensions;

/** Name all that there can be, or other ones, with numbers: outputs can be described. */
void dimensions_name(dimensions *dimensions, int n_coordinates, const history_coordinate *coordinates);
/** Define those that the outputs may have, with their names; in a history only those that its outputs do have. */
bool dimensions_define(dimensions *dimensions, netcdf_file *file, dimensions_use use, const model_names *names,
                       int n_outputs, const model_output *outputs);
/** Define harmonics 1 to n behind them. */
bool dimensions_define_harmonics(dimensions *dimensions, netcdf_file *file, int n);
/** Define other ones, with numbers. */
bool dimensions_define_numbers(dimensions *dimensions, netcdf_file *file, int n, const history_coordinate *coordinates);
/** The variable of an output, with its dimensions. */
netcdf_variable dimensions_describe(dimensions *dimensions, const model_output *output);
/** Append the dimensions of an output to those of a variable. */
void dimensions_append(dimensions *dimensions, const model_output *output, netcdf_variable *variable);
/** As scale_list_users, all of them. */
bool dimensions_finish(dimensions *dimensions, netcdf_file *file);
