#include "base/memory.h"
#include "files/history_head_hdf5.h"
#include "files/parts.h"

static hsize_t rows_of(hid_t place, const char *name)
{
    CLOSED const hid_t dataset = H5Lexists(place, name, H5P_DEFAULT) > 0 ? H5Dopen2(place, name, H5P_DEFAULT) : -1;
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    hsize_t extent[NETCDF_MAX_RANK] = {0};
    const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
    return rank > 0 && rank <= NETCDF_MAX_RANK && H5Sget_simple_extent_dims(space, extent, NULL) == rank ? extent[0]
                                                                                                         : 0;
}

/** All rows of a series, in blocks as it has room. *is_readable: what failed was writing */
static bool append_rows(hid_t place, history *to, series *rows, bool *is_readable)
{
    POOLED memory_pool pool = {NULL};
    const int shift = rows == &to->body.events ? (int)to->body.n_events : 0;
    series_source source;
    *is_readable = series_source_open(&source, rows, place, &pool);
    bool good = *is_readable;
    while (good && source.next < source.rows && (to->grows || history_make_room(to, rows))) {
        good = to->grows ? series_copy(rows, &to->netcdf, &source, shift) : series_take(rows, &source, shift);
        *is_readable = good || to->netcdf.reason[0] != '\0';
        good = good && history_flush_if_due(to);
    }
    good = good && source.next == source.rows;
    to->body.n_events += rows == &to->body.events ? (long long)source.rows : 0;
    series_source_close(&source, rows);
    return good;
}

bool part_append(const char *path, history *to, evl_error *error)
{
    const hid_t file = netcdf_open(path), events = file < 0 ? file : H5Gopen2(file, "events", H5P_DEFAULT);
    bool is_readable = events >= 0;
    const bool good = is_readable && append_rows(file, to, &to->body.times, &is_readable) &&
                      append_rows(events, to, &to->body.events, &is_readable);
    (void)(events >= 0 && H5Gclose(events));
    (void)(file >= 0 && H5Fclose(file));
    if (!is_readable) {
        return evl_error_set(error, EVL_EXIT_IO, path, "cannot be read, or is damaged; begin anew without --continue");
    }
    return good || history_refuse(to, error);
}

bool part_size_of(const char *path, part_size *size)
{
    const hid_t file = netcdf_open(path);
    if (file < 0) {
        return false;
    }
    *size = (part_size){(long long)rows_of(file, "time"), 0};
    const hid_t group = H5Lexists(file, "events", H5P_DEFAULT) > 0 ? H5Gopen2(file, "events", H5P_DEFAULT) : -1;
    size->events = group < 0 ? 0 : (long long)rows_of(group, "time");
    (void)(group >= 0 && H5Gclose(group));
    (void)(file >= 0 && H5Fclose(file));
    return group >= 0;
}
