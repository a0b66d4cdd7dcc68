/** Content of a response, variable by variable in the order of its file: the single description for files and for
 *  memory. Private to response_*.c. */
#pragma once

#include "files/dimensions.h"
#include "files/response.h"

/** Its dimensions; valid as long as what describes them. */
typedef struct {
    memory_arena *arena; /**< owns their data */
    netcdf_dimension direction, parameter, jump;
    dimensions of_outputs;
} response_axes;

/** Receiver of the content. Arguments are valid during the call, dimensions as long as the axes. Each function returns
 *  false on failure, which ends the transfer. */
typedef struct {
    void *self;
    bool (*attribute)(void *self, const history_attribute *attribute);
    /** A dimension with its coordinate: doubles, or names of NETCDF_TEXT. */
    bool (*axis)(void *self, netcdf_dimension *dimension, const netcdf_variable *coordinate, int n, const void *values);
    bool (*variable)(void *self, const netcdf_variable *variable, const double *values);
} response_sink;

/** @param axes  zeros, except the arena. @return false if the sink failed */
bool response_transfer(const response *response, response_axes *axes, const response_sink *sink);
