/** What a response has, in the order of its file, variable by variable: the one description for files and for memory. Private to
 *  response_*.c. */
#pragma once

#include "files/dimensions.h"
#include "files/response.h"

/** Its dimensions; they live as long as what describes them. */
typedef struct {
    memory_pool *pool; /**< of what they need */
    netcdf_dimension direction, parameter, jump;
    dimensions of_outputs;
} response_axes;

/** Where it goes. What is handed over lasts as long as the call, dimensions as long as the axes. Each returns false if it cannot be
 *  taken, which ends the telling. */
typedef struct {
    void *self;
    bool (*attribute)(void *self, const history_attribute *attribute);
    /** A dimension with its coordinate: doubles, or names of NETCDF_TEXT. */
    bool (*axis)(void *self, netcdf_dimension *dimension, const netcdf_variable *coordinate, int n, const void *values);
    bool (*variable)(void *self, const netcdf_variable *variable, const double *values);
} response_sink;

/** @param axes  zeros, but for the pool. @return false if the sink has refused something */
bool response_tell(const response *response, response_axes *axes, const response_sink *sink);
