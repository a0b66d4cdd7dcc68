/* docs/result_format.md describes what this file and the other history*_hdf5.c write. */
#include "files/history_head_hdf5.h"

#include <stdio.h>
#include <stdlib.h>

enum { FORMAT = 1 };

bool history_put_attributes(history *history, int n, const history_attribute *attributes)
{
    netcdf_file *netcdf = &history->netcdf;
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        const history_attribute *attribute = &attributes[i];
        good = attribute->text != NULL  ? netcdf_put_text(netcdf, netcdf->id, attribute->key, attribute->text)
               : attribute->number != 0 ? netcdf_put_number(netcdf, netcdf->id, attribute->key, attribute->number)
                                        : netcdf_put_integer(netcdf, netcdf->id, attribute->key, attribute->integer);
    }
    return good;
}

static bool write_dimensions(history *history)
{
    netcdf_file *netcdf = &history->netcdf;
    dimensions *dimensions = &history->dimensions;
    const history_layout *layout = &history->layout;
    const bool has_all = layout->n_all > 0;
    const bool good =
        history->has_events
            ? dimensions_define(dimensions, netcdf, DIMENSIONS_OF_HISTORY, layout->names,
                                has_all ? layout->n_all : layout->n_outputs, has_all ? layout->all : layout->outputs)
            : dimensions_define_numbers(dimensions, netcdf, layout->n_coordinates, layout->coordinates);
    return good && (layout->n_harmonics == 0 || dimensions_define_harmonics(dimensions, netcdf, layout->n_harmonics));
}

/** The group of events with its dimension. */
static bool start_events(history *history)
{
    static const char *const sides[] = {"before", "after"};
    netcdf_file *netcdf = &history->netcdf;
    history->events_group = netcdf_create_group(netcdf, "events");
    return history->events_group >= 0 && netcdf_define_names(netcdf, history->events_group, &history->side, "side",
                                                             "side of the event", &(name_list){2, sides});
}

static bool write_static(history *history, const model_output *output, const double *values)
{
    netcdf_file *netcdf = &history->netcdf;
    const netcdf_variable variable = dimensions_describe(&history->dimensions, output);
    if (output->is_integer && !netcdf_check_integers(netcdf, output->name, output->count, values)) {
        return false; /* HDF5 would write the nearest one */
    }
    CLOSED const hid_t dataset = netcdf_define(netcdf, netcdf->id, &variable, 0);
    /* HDF5 turns whole doubles into integers. */
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
    const history_layout *layout = &history->layout;
    return netcdf_create(netcdf, path) && netcdf_put_text(netcdf, netcdf->id, "Conventions", "CF-1.10") &&
           netcdf_put_integer(netcdf, netcdf->id, "evolvent_format", FORMAT) &&
           netcdf_put_text(netcdf, netcdf->id, "evolvent_kind", layout->kind) && write_dimensions(history) &&
           (!history->has_events || start_events(history)) &&
           (!history->has_statics ||
            history_write_statics(history, layout->n_outputs, layout->outputs, history->statics));
}

bool history_finish(history *history)
{
    return dimensions_finish(&history->dimensions, &history->netcdf) &&
           (!history->has_events || scale_list_users(&history->netcdf, &history->side.scale));
}
