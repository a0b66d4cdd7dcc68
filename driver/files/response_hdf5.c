/* A response on file. */
#include "files/response_rows.h"

#include "base/memory.h"
#include "files/dimensions_in_file_hdf5.h"
#include "files/netcdf_common_hdf5.h"
#include "files/output_file.h"

#include <stdlib.h>

static bool put_attribute(void *self, const history_attribute *a)
{
    netcdf_file *netcdf = self;
    return a->text != NULL ? netcdf_put_text(netcdf, netcdf->id, a->key, a->text)
                           : netcdf_put_integer(netcdf, netcdf->id, a->key, a->integer);
}

static bool put_axis(void *self, netcdf_dimension *dimension, const netcdf_variable *coordinate, int n,
                     const void *values)
{
    netcdf_file *netcdf = self;
    return netcdf_define_values(netcdf, netcdf->id, dimension, coordinate, n,
                                coordinate->type == NETCDF_TEXT ? netcdf_cached.text : H5T_NATIVE_DOUBLE, values);
}

static bool put_variable(void *self, const netcdf_variable *variable, const double *values)
{
    netcdf_file *netcdf = self;
    CLOSED const hid_t dataset = netcdf_define(netcdf, netcdf->id, variable, 0);
    return dataset >= 0 && netcdf_write(netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

static bool fill(const response *response, netcdf_file *netcdf, response_axes *axes)
{
    const response_sink sink = {.self = netcdf, .attribute = put_attribute, .axis = put_axis, .variable = put_variable};
    return response_transfer(response, axes, &sink) && scale_list_users(netcdf, axes->direction.scale) &&
           scale_list_users(netcdf, axes->parameter.scale) && scale_list_users(netcdf, axes->jump.scale) &&
           dimensions_finish(&axes->of_outputs, netcdf);
}

bool response_write(const response *response, bool commit, evl_error *error)
{
    output_file file;
    netcdf_file netcdf = {.id = 0};
    response_axes axes = {.arena = &netcdf.arena};
    if (!output_file_open(&file, response->path, error)) {
        return false;
    }
    bool good = netcdf_create(&netcdf, file.partial_path) && fill(response, &netcdf, &axes);
    good = netcdf_close(&netcdf) && good;
    if (good) {
        return output_file_close(&file, commit, error);
    }
    output_file_refuse(file.partial_path, netcdf.system_error, netcdf.system_error != 0 ? NULL : netcdf.reason, error);
    output_file_drop(&file, true);
    return false;
}
