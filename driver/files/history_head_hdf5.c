/* docs/reference/result_format.md describes the output of this file and the other history*_hdf5.c. */
#include "files/history_head_hdf5.h"

#include "files/netcdf_common_hdf5.h"

#include <stdio.h>
#include <stdlib.h>

bool history_put_attributes(history *history, int n, const history_attribute *attributes)
{
    netcdf_file *netcdf = &history->netcdf;
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const history_attribute *attribute = &attributes[i];
        good = attribute->text != NULL ? netcdf_put_text(netcdf, netcdf->id, attribute->key, attribute->text)
               : history_is_number(attribute)
                   ? netcdf_put_number(netcdf, netcdf->id, attribute->key, attribute->number)
                   : netcdf_put_integer(netcdf, netcdf->id, attribute->key, attribute->integer);
    }
    return good;
}

/** Create the group of events with its dimension. */
static bool start_events(history *history)
{
    netcdf_file *netcdf = &history->netcdf;
    const dimension_values *sides = &history->body.sides;
    history->events_group = netcdf_create_group(netcdf, "events");
    return history->events_group >= 0 &&
           netcdf_define_values(netcdf, history->events_group, &history->body.side, &sides->variable, sides->n,
                                netcdf_cached.text, sides->names);
}

static bool write_static(history *history, const model_output *output, const double *values)
{
    netcdf_file *netcdf = &history->netcdf;
    const netcdf_variable variable = dimensions_describe(&history->body.dimensions, output);
    if (output->is_integer && !netcdf_are_integers(netcdf->reason, output->name, output->count, values)) {
        return false; /* HDF5 would write the nearest integer */
    }
    CLOSED const hid_t dataset = netcdf_define(netcdf, netcdf->id, &variable, 0);
    /* HDF5 converts whole doubles to integers. */
    return dataset >= 0 && netcdf_write(netcdf, dataset, H5T_NATIVE_DOUBLE, values);
}

bool history_write_statics(history *history, int n, const model_output *outputs, const double *values)
{
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const model_output *output = &outputs[i];
        good = !output->is_static || output->count == 0 || write_static(history, output, values + output->offset);
    }
    return good;
}

bool history_write_head(history *history, const char *path)
{
    netcdf_file *netcdf = &history->netcdf;
    history_body *body = &history->body;
    const history_layout *layout = &body->layout;
    history_attribute attributes[N_COMMON_ATTRIBUTES];
    history_common_attributes(layout, attributes);
    return netcdf_create(netcdf, path) && history_put_attributes(history, N_COMMON_ATTRIBUTES, attributes) &&
           dimensions_define(&body->dimensions, netcdf) && (!body->has_events || start_events(history)) &&
           (!body->has_statics || history_write_statics(history, layout->n_outputs, layout->outputs, body->statics));
}

bool history_finish(history *history)
{
    return dimensions_finish(&history->body.dimensions, &history->netcdf) &&
           (!history->body.has_events || scale_list_users(&history->netcdf, history->body.side.scale));
}
