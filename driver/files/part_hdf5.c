#include "base/memory.h"
#include "files/history_head_hdf5.h"
#include "files/parts.h"

static hsize_t rows_of(hid_t group, const char *name)
{
    CLOSED const hid_t dataset = H5Lexists(group, name, H5P_DEFAULT) > 0 ? H5Dopen2(group, name, H5P_DEFAULT) : -1;
    CLOSED const hid_t space = dataset < 0 ? dataset : H5Dget_space(dataset);
    hsize_t extent[NETCDF_MAX_RANK] = {0};
    const int rank = space < 0 ? 0 : H5Sget_simple_extent_ndims(space);
    return rank > 0 && rank <= NETCDF_MAX_RANK && H5Sget_simple_extent_dims(space, extent, NULL) == rank ? extent[0]
                                                                                                         : 0;
}

/** Report why a part cannot be read: the system error, if there is one. */
static bool refuse_part(const char *path, const char *reason, evl_error *error)
{
    return reason != NULL ? evl_error_set(error, EVL_EXIT_IO, path, "cannot be read: %s; correct this", reason)
                          : evl_error_set(error, EVL_EXIT_IO, path,
                                          "is damaged; put a copy of it back, or start again without --continue");
}

/** Append all rows of a series, in blocks as space permits. @return false with the reason in `error` */
static bool append_rows(hid_t group, const char *path, history *to, series *rows, evl_error *error)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const int shift = rows == &to->body.events ? (int)to->body.n_events : 0;
    series_source source;
    bool is_readable = series_source_open(&source, rows, group, &arena), good = is_readable;
    while (good && source.next < source.rows && (to->grows || history_reserve(to, rows))) {
        good = to->grows ? series_copy(rows, &to->netcdf, &source, shift) : series_take(rows, &source, shift);
        is_readable = good || to->netcdf.reason[0] != '\0';
        good = good && history_flush_if_due(to);
    }
    good = good && source.next == source.rows;
    to->body.n_events += rows == &to->body.events ? (long long)source.rows : 0;
    series_source_close(&source, rows);
    return good || (is_readable ? history_refuse(to, error) : refuse_part(path, source.reason, error));
}

bool part_append(const char *path, history *to, evl_error *error)
{
    const hid_t file = netcdf_open(path), events = file < 0 ? file : H5Gopen2(file, "events", H5P_DEFAULT);
    const bool good = events < 0 ? refuse_part(path, netcdf_system_reason(NULL), error)
                                 : append_rows(file, path, to, &to->body.times, error) &&
                                       append_rows(events, path, to, &to->body.events, error);
    (void)(events >= 0 && H5Gclose(events));
    (void)(file >= 0 && H5Fclose(file));
    return good;
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
