#include "files/stack.h"

#include "base/crc32.h"
#include "base/log.h"
#include "base/memory.h"
#include "base/write_bytes.h"
#include "files/checksum.h"
#include "files/dimensions_in_file_hdf5.h"
#include "files/netcdf_common_hdf5.h"
#include "files/output_file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct {
    netcdf_file netcdf;
    netcdf_dimension cases, axis;
    dimensions of_outputs;
    long long first_history; /**< start of the first history, bytes */
} builder;

/* ---- creation of the file ---- */

static bool define_dimensions(builder *b, const stack_layout *layout)
{
    const netcdf_variable cases = netcdf_describe(NETCDF_LONG, "case", "1", "", "number of the case in its design");
    const history_coordinate *along = &layout->axis;
    const netcdf_variable axis =
        netcdf_describe(NETCDF_REAL, along->name, along->units, along->symbol, along->long_name);
    CLEANUP_FREE long *numbers = xcalloc((size_t)layout->n_rows, sizeof *numbers);
    for (long row = 0; row < layout->n_rows; row++) {
        numbers[row] = layout->first_case + row * layout->stride;
    }
    dimensions_plan(&b->of_outputs, DIMENSIONS_OF_STACK, layout->names, 0, NULL);
    return netcdf_define_values(&b->netcdf, b->netcdf.id, &b->cases, &cases, layout->n_rows, H5T_NATIVE_LONG,
                                numbers) &&
           netcdf_define_values(&b->netcdf, b->netcdf.id, &b->axis, &axis, along->n, H5T_NATIVE_DOUBLE,
                                along->values) &&
           dimensions_define(&b->of_outputs, &b->netcdf);
}

static bool define_variable(builder *b, const model_output *output)
{
    netcdf_variable variable =
        netcdf_describe(NETCDF_FLOAT, output->name, output->units, output->symbol, output->long_name);
    variable.rank = 2;
    variable.dimensions[0] = &b->cases;
    variable.dimensions[1] = &b->axis;
    dimensions_append(&b->of_outputs, output, &variable);
    const hid_t dataset = netcdf_define(&b->netcdf, b->netcdf.id, &variable, 0);
    const haddr_t offset = dataset < 0 ? HADDR_UNDEF : H5Dget_offset(dataset);
    if (offset != HADDR_UNDEF && (long long)offset < b->first_history) {
        b->first_history = (long long)offset;
    }
    return dataset >= 0 && (H5Dclose(dataset) >= 0 || netcdf_fail(&b->netcdf));
}

static bool fill_file(builder *b, const stack_layout *layout)
{
    netcdf_file *netcdf = &b->netcdf;
    bool good = netcdf_put_text(netcdf, netcdf->id, "Conventions", "CF-1.8") &&
                netcdf_put_text(netcdf, netcdf->id, "evolvent_kind", "stack") &&
                netcdf_put_text(netcdf, netcdf->id, "design", layout->hash) && define_dimensions(b, layout);
    for (int i = 0; i < layout->n_variables && good; i++) {
        good = define_variable(b, &layout->variables[i]);
    }
    good = good && scale_list_users(netcdf, b->cases.scale) && scale_list_users(netcdf, b->axis.scale) &&
           dimensions_finish(&b->of_outputs, netcdf);
    return good;
}

/** Reserve contiguous space for the metadata of all variables, before any history. */
static void reserve_metadata(const stack_layout *layout)
{
    enum { ANY = 24 * 1024, EACH = 2 * 1024, USUAL = 2048 /* default of HDF5 */ };
    const hsize_t block_size = layout == NULL ? USUAL : ANY + EACH * (hsize_t)layout->n_variables;
    if (netcdf_prepare()) {
        (void)H5Pset_meta_block_size(netcdf_cached.file_access, block_size);
    }
}

/** Create the file; it is renamed when it is complete. */
static bool make_file(const stack_layout *layout, evl_error *error)
{
    output_file file;
    if (!output_file_open(&file, layout->path, error)) {
        return false;
    }
    builder b = {.first_history = LLONG_MAX};
    reserve_metadata(layout);
    bool good = netcdf_create(&b.netcdf, file.partial_path);
    reserve_metadata(NULL);
    good = good && fill_file(&b, layout);
    good = netcdf_close(&b.netcdf) && good;
    if (good) {
        file.is_open_end = true;
        good = checksum_append_of_first(file.descriptor, b.first_history) ||
               output_file_refuse(file.partial_path, errno, NULL, error);
        return output_file_close(&file, good, error) && good;
    }
    output_file_drop(&file, true);
    return evl_error_set(error, EVL_EXIT_IO, layout->path,
                         "cannot be written: %s; select fewer histories, or free space", b.netcdf.reason);
}

/* ---- location of the rows ---- */

static bool has_hash(hid_t file, const char *hash)
{
    CLEANUP_FREE char *found = netcdf_get_text(file, "design", NULL);
    return found != NULL && strcmp(found, hash) == 0;
}

static bool find_rows(stack *stack, hid_t file, const stack_layout *layout)
{
    bool good = has_hash(file, layout->hash);
    for (int i = 0; i < layout->n_variables && good; i++) {
        CLOSED const hid_t dataset = H5Dopen2(file, layout->variables[i].name, H5P_DEFAULT);
        const haddr_t offset = dataset < 0 ? HADDR_UNDEF : H5Dget_offset(dataset);
        const hsize_t bytes =
            (hsize_t)layout->n_rows * (hsize_t)layout->axis.n * (hsize_t)layout->variables[i].count * sizeof(float);
        good = offset != HADDR_UNDEF && H5Dget_storage_size(dataset) == bytes;
        stack->offsets[i] = (long long)offset;
        stack->counts[i] = layout->variables[i].count;
    }
    return good;
}

/** To be called before the library opens the file, since it does not detect damage. */
static bool admits(checksum_status status, const char *path, evl_error *error)
{
    return status == CHECKSUM_CORRECT || status == CHECKSUM_NONE ||
           (status == CHECKSUM_UNREADABLE
                ? evl_error_set(error, EVL_EXIT_CASE, path, "cannot be read: %s", strerror(errno))
                : evl_error_set(
                      error, EVL_EXIT_CASE, path,
                      "is damaged: its checksum is wrong; choose another folder, or delete it, and with it the "
                      "histories of all cases that are recorded"));
}

bool stack_open(stack *stack, const stack_layout *layout, evl_error *error)
{
    *stack = (struct stack){.descriptor = -1, .n_positions = layout->axis.n, .n_variables = layout->n_variables};
    stack->path = arena_copy(&stack->arena, layout->path);
    stack->counts = arena_calloc(&stack->arena, (size_t)layout->n_variables, sizeof(int));
    stack->offsets = arena_calloc(&stack->arena, (size_t)layout->n_variables, sizeof(long long));
    checksum_status checksum = CHECKSUM_UNREADABLE;
    bool good = access(layout->path, F_OK) == 0 || make_file(layout, error);
    if (good) {
        checksum = checksum_verify(layout->path);
        good = admits(checksum, layout->path, error);
    }
    if (good) {
        CLOSED const hid_t file = netcdf_open(layout->path);
        const char *fault = "does not contain the histories of this shard and design, or cannot be read; restore it, "
                            "or choose another folder";
        good = (file >= 0 && find_rows(stack, file, layout)) ||
               evl_error_set(error, EVL_EXIT_CASE, layout->path, "%s", file < 0 ? netcdf_system_reason(fault) : fault);
    }
    if (good) {
        stack->descriptor = open(layout->path, O_WRONLY | O_CLOEXEC | O_NOFOLLOW);
        good = stack->descriptor >= 0 || evl_error_set_unwritten(error, layout->path);
    }
    if (good && checksum == CHECKSUM_NONE) {
        log_warning("%s: has no checksum, so damage would not be detected", layout->path);
    }
    if (!good) {
        stack_close(stack);
    }
    return good;
}

/* ---- rows ---- */

long stack_row_length(const stack *stack)
{
    long n = 0;
    for (int i = 0; i < stack->n_variables; i++) {
        n += (long)stack->n_positions * stack->counts[i];
    }
    return n;
}

bool stack_write(const stack *stack, long row, const float *values, evl_error *error)
{
    for (int i = 0; i < stack->n_variables; i++) {
        const size_t n = (size_t)stack->n_positions * (size_t)stack->counts[i], bytes = n * sizeof *values;
        const off_t start = (off_t)stack->offsets[i] + (off_t)row * (off_t)bytes;
        if (write_bytes(stack->descriptor, start, values, bytes) < bytes) {
            return evl_error_set_unwritten(error, stack->path);
        }
        values += n;
    }
    return true;
}

uint32_t stack_check(const stack *stack, const float *values)
{
    return crc32_on(0, values, (size_t)stack_row_length(stack) * sizeof *values);
}

bool stack_sync(const stack *stack, evl_error *error)
{
    return fdatasync(stack->descriptor) == 0 || errno == EINVAL || evl_error_set_unwritten(error, stack->path);
}

void stack_close(stack *stack)
{
    if (stack->descriptor >= 0) {
        (void)close(stack->descriptor);
    }
    arena_free(&stack->arena);
    *stack = (struct stack){.descriptor = -1};
}
