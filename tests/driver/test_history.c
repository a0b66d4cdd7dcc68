/** The history's file, read back with HDF5 itself; the readers of users are tested in tests/cli. */
#include "files/history.h"

#include <hdf5.h>
#include <hdf5_hl.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

enum { N_VALUES = 9, N_STATES = 2 };

static const char *const wheels[] = {"pinion", "gear"};
static const char *const meshes[] = {"pinion-gear"};
static const model_state states[] = {{"reference_angle", "rad"}, {"angle_deviation_1", "rad"}};
static const char *const kinds[] = {"tooth_switch", "contact_closed"};
static const model_output outputs[] = {
    {"teeth", "1", "z", "number of teeth", "wheel", true, true, 0, 2, NULL},
    {"energy", "J", "T", "kinetic energy", "", false, false, 2, 1, NULL},
    {"centre", "m", "O", "displacement of the centre", "wheel axis", false, false, 3, 4, NULL},
    {"gap", "m", "kappa", "gap", "mesh", false, false, 7, 1, NULL},
    {"tooth_pair", "1", "k", "pitches since the start", "mesh", false, true, 8, 1, NULL},
};

typedef struct {
    char folder[64], path[96], partial[112];
} workspace;

static int make_workspace(void **state)
{
    workspace *workspace = calloc(1, sizeof *workspace);
    *state = workspace;
    (void)snprintf(workspace->folder, sizeof workspace->folder, "/tmp/test_history_XXXXXX");
    if (mkdtemp(workspace->folder) == NULL) {
        return -1;
    }
    (void)snprintf(workspace->path, sizeof workspace->path, "%s/run.h5", workspace->folder);
    (void)snprintf(workspace->partial, sizeof workspace->partial, "%s/run.h5.partial", workspace->folder);
    return 0;
}

static int remove_workspace(void **state)
{
    workspace *workspace = *state;
    (void)unlink(workspace->path);
    (void)unlink(workspace->partial);
    (void)rmdir(workspace->folder);
    free(workspace);
    return 0;
}

static double flush_interval = 0; /* of all runs: the usual one */

static history *create(const char *path, evl_error *error)
{
    static const history_attribute attributes[] = {{.key = "title", .text = "a test"},
                                                   {.key = "status", .text = "running"}};
    static const model_names names = {.wheels = {2, wheels}, .meshes = {1, meshes}};
    const history_layout layout = {.path = path,
                                   .kind = "history",
                                   .axis = {.name = "time", .units = "s", .symbol = "t", .long_name = "model time"},
                                   .names = &names,
                                   .n_outputs = sizeof outputs / sizeof *outputs,
                                   .outputs = outputs,
                                   .n_states = N_STATES,
                                   .states = states,
                                   .n_event_kinds = 2,
                                   .event_kinds = kinds,
                                   .flush_interval = flush_interval,
                                   .n_attributes = 2,
                                   .attributes = attributes};
    return history_create(&layout, error);
}

static void fill_values(long row, double values[N_VALUES])
{
    const double x = (double)row;
    const double filled[N_VALUES] = {20.0, 30.0, 0.5 * x, x + 0.1, x + 0.2, x + 0.3, x + 0.4, -x, x + 7.0};
    memcpy(values, filled, sizeof filled);
}

static bool append(history *history, long row, evl_error *error)
{
    double values[N_VALUES];
    fill_values(row, values);
    return history_append(history, 1e-3 * (double)row, values, error);
}

static bool add_event(history *history, double t, evl_error *error)
{
    double before[N_STATES] = {1.0 + t, 2.0}, after[N_STATES] = {3.0 + t, 4.0};
    const history_event event = {.t = t, .kind = 1, .mesh = 0, .flank = 3, .before = before, .after = after};
    return history_add_event(history, &event, error);
}

static bool close_as(history **history, bool commit, const char *status, evl_error *error)
{
    const history_attribute attributes[] = {{.key = "status", .text = status}, {.key = "steps", .integer = 42}};
    return history_close(history, commit, 2, attributes, error);
}

/** A whole run of n_rows; fails the test if anything goes wrong. */
static void write_run(const workspace *workspace, long n_rows, int n_events, bool commit)
{
    evl_error error = {.code = EVL_EXIT_OK};
    history *history = create(workspace->path, &error);
    assert_int_equal(error.code, EVL_EXIT_OK);
    assert_non_null(history);
    for (long i = 0; i < n_rows; i++) {
        assert_true(append(history, i, &error));
    }
    for (int i = 0; i < n_events; i++) {
        assert_true(add_event(history, i, &error));
    }
    assert_true(close_as(&history, commit, "done", &error));
    assert_null(history);
}

static bool exists(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0;
}

static void read_bytes(const char *path, unsigned char **bytes, size_t *size)
{
    FILE *stream = fopen(path, "rb");
    assert_non_null(stream);
    struct stat status;
    assert_int_equal(fstat(fileno(stream), &status), 0);
    *size = (size_t)status.st_size;
    *bytes = calloc(*size, 1);
    assert_int_equal(fread(*bytes, 1, *size, stream), *size);
    (void)fclose(stream);
}

/** The dataset's values as doubles, to be freed; its extents in `extent`. */
static double *read_all(hid_t file, const char *name, int rank, hsize_t *extent)
{
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(dataset >= 0);
    const hid_t space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_ndims(space), rank);
    (void)H5Sget_simple_extent_dims(space, extent, NULL);
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    double *values = calloc((size_t)n + 1, sizeof *values);
    assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    (void)H5Sclose(space);
    (void)H5Dclose(dataset);
    return values;
}

static void check_rows(const char *path, long n_rows)
{
    const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    hsize_t n[3];
    double *time = read_all(file, "time", 1, n);
    assert_int_equal(n[0], n_rows);
    double *centre = read_all(file, "centre", 3, n);
    assert_int_equal(n[0], n_rows);
    assert_int_equal(n[1], 2);
    assert_int_equal(n[2], 2);
    double *pair = read_all(file, "tooth_pair", 2, n);
    for (long i = 0; i < n_rows; i++) {
        double values[N_VALUES];
        fill_values(i, values);
        assert_true(time[i] == 1e-3 * (double)i); /* stored, not computed: equal to the bit */
        assert_memory_equal(centre + 4 * i, values + 3, 4 * sizeof *values);
        assert_true(pair[i] == values[8]);
    }
    if (n_rows > 0) { /* static variables come with the first row */
        double *teeth = read_all(file, "teeth", 1, n);
        assert_true(n[0] == 2 && teeth[0] == 20.0 && teeth[1] == 30.0);
        free(teeth);
    }
    free(pair);
    free(centre);
    free(time);
    (void)H5Fclose(file);
}

static void every_row_is_read_back_whatever_their_number(void **state)
{
    const workspace *workspace = *state;
    const long numbers[] = {0, 1, 10, 1023, 1024, 1025, 5001};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        write_run(workspace, numbers[i], 0, true);
        check_rows(workspace->path, numbers[i]);
    }
}

static void events_keep_both_sides_of_the_state(void **state)
{
    const workspace *workspace = *state;
    const int numbers[] = {0, 1, 255, 256, 600};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        write_run(workspace, 3, numbers[i], true);
        const hid_t file = H5Fopen(workspace->path, H5F_ACC_RDONLY, H5P_DEFAULT);
        hsize_t n[2];
        double *values = read_all(file, "events/reference_angle", 2, n);
        double *kind = read_all(file, "events/kind", 1, n);
        double *renamed = read_all(file, "events/angle_deviation_1", 2, n);
        assert_int_equal(n[0], numbers[i]);
        assert_int_equal(n[1], 2);
        for (int k = 0; k < numbers[i]; k++) {
            assert_true(values[2 * k] == 1.0 + k && values[2 * k + 1] == 3.0 + k);
            assert_true(kind[k] == 1.0 && renamed[2 * k] == 2.0 && renamed[2 * k + 1] == 4.0);
        }
        free(renamed);
        free(kind);
        free(values);
        (void)H5Fclose(file);
    }
}

static void check_attached(hid_t file, const char *variable, unsigned axis, const char *scale)
{
    const hid_t dataset = H5Dopen2(file, variable, H5P_DEFAULT), of_scale = H5Dopen2(file, scale, H5P_DEFAULT);
    assert_int_equal(H5DSis_attached(dataset, of_scale, axis), 1);
    (void)H5Dclose(of_scale);
    (void)H5Dclose(dataset);
}

static void every_axis_is_attached_to_its_dimension_in_the_eyes_of_hdf5(void **state)
{
    const workspace *workspace = *state;
    write_run(workspace, 3, 1, true);
    const hid_t file = H5Fopen(workspace->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    check_attached(file, "teeth", 0, "wheel");
    check_attached(file, "energy", 0, "time");
    check_attached(file, "centre", 0, "time");
    check_attached(file, "centre", 1, "wheel");
    check_attached(file, "centre", 2, "axis");
    check_attached(file, "gap", 1, "mesh");
    check_attached(file, "events/kind", 0, "events/event");
    check_attached(file, "events/reference_angle", 0, "events/event");
    check_attached(file, "events/reference_angle", 1, "events/side");
    (void)H5Fclose(file);
}

static void check_text(hid_t file, const char *variable, const char *attribute, const char *expected)
{
    char *text = NULL;
    const hid_t id = H5Aopen_by_name(file, variable, attribute, H5P_DEFAULT, H5P_DEFAULT), type = H5Aget_type(id);
    assert_true(H5Tis_variable_str(type) > 0);
    assert_true(H5Aread(id, type, (void *)&text) >= 0);
    assert_string_equal(text, expected);
    (void)H5free_memory(text);
    (void)H5Tclose(type);
    (void)H5Aclose(id);
}

/* What is known at the end only: a value, one that is none, and a whole number, of the wheels and of the mesh. */
static const model_output finals[] = {
    {"gap_max", "m", "kappa_max", "largest gap", "mesh", true, false, 1, 1, NULL},
    {"speed_max", "rad s-1", "omega_max", "largest speed", "wheel", true, false, 2, 2, NULL},
    {"times_passed", "1", "n", "how often", "wheel", true, true, 4, 2, NULL},
};
static const double final_values[] = {-99, 0.1, 1e300, NAN, 3, -4}; /* the first is of no variable */

static void finals_are_read_back_with_their_attributes(void **state)
{
    const workspace *workspace = *state;
    evl_error error = {.code = EVL_EXIT_OK};
    history *history = create(workspace->path, &error);
    assert_true(append(history, 0, &error) && append(history, 1, &error));
    assert_true(history_put_finals(history, sizeof finals / sizeof *finals, finals, final_values, &error));
    assert_true(close_as(&history, true, "done", &error));
    check_rows(workspace->path, 2);
    const hid_t file = H5Fopen(workspace->path, H5F_ACC_RDONLY, H5P_DEFAULT);
    hsize_t n;
    for (size_t i = 0; i < sizeof finals / sizeof *finals; i++) {
        const model_output *output = &finals[i];
        double *values = read_all(file, output->name, 1, &n);
        assert_int_equal(n, output->count);
        for (hsize_t k = 0; k < n; k++) { /* to the bit */
            const double expected = final_values[output->offset + (int)k];
            assert_true(isnan(expected) ? isnan(values[k]) : values[k] >= expected && values[k] <= expected);
        }
        free(values);
        check_text(file, output->name, "units", output->units);
        check_text(file, output->name, "long_name", output->long_name);
        check_text(file, output->name, "symbol", output->symbol);
        assert_int_equal(H5Aexists_by_name(file, output->name, "_FillValue", H5P_DEFAULT), !output->is_integer);
        check_attached(file, output->name, 0, output->dims);
    }
    (void)H5Fclose(file);
}

static void rows_that_come_together_are_those_that_come_one_by_one(void **state)
{
    const workspace *workspace = *state;
    enum { STRIDE = 8, N_ROWS = 9000 };
    double constants[N_VALUES], positions[STRIDE], values[N_VALUES * STRIDE], row[N_VALUES];
    evl_error error = {.code = EVL_EXIT_OK};
    history *history = create(workspace->path, &error);
    fill_values(0, constants);
    history_put_statics(history, constants);
    for (long first = 0, n = 0; first < N_ROWS; first += n) {
        n = 1 + first % STRIDE; /* 1 to 8, held ones and others: 8192 is none of their beginnings */
        n = n < N_ROWS - first ? n : N_ROWS - first;
        for (long k = 0; k < n; k++) {
            positions[k] = 1e-3 * (double)(first + k);
            fill_values(first + k, row);
            for (int i = 0; i < N_VALUES; i++) {
                values[i * STRIDE + k] = i < 2 ? -1 : row[i]; /* constants have been given */
            }
        }
        assert_true(history_append_rows(history, (int)n, positions, values, STRIDE, &error));
    }
    assert_true(close_as(&history, true, "done", &error));
    check_rows(workspace->path, N_ROWS);
}

static void no_finals_change_nothing(void **state)
{
    const workspace *workspace = *state;
    evl_error error = {.code = EVL_EXIT_OK};
    unsigned char *without, *with;
    size_t n, m;
    write_run(workspace, 3, 0, true);
    read_bytes(workspace->path, &without, &n);
    history *history = create(workspace->path, &error);
    for (long i = 0; i < 3; i++) {
        assert_true(append(history, i, &error));
    }
    assert_true(history_put_finals(history, 0, NULL, NULL, &error));
    assert_true(close_as(&history, true, "done", &error));
    read_bytes(workspace->path, &with, &m);
    assert_int_equal(n, m);
    assert_memory_equal(without, with, n);
    free(without);
    free(with);
}

static void only_a_commit_replaces_an_older_file(void **state)
{
    const workspace *workspace = *state;
    write_run(workspace, 5, 0, true);
    write_run(workspace, 7, 0, false);
    check_rows(workspace->path, 5);
    check_rows(workspace->partial, 7);
    write_run(workspace, 9, 0, true);
    check_rows(workspace->path, 9);
    assert_false(exists(workspace->partial));
}

static void the_same_run_gives_the_same_file_to_the_byte(void **state)
{
    const workspace *workspace = *state;
    unsigned char *first, *second;
    size_t n, m;
    write_run(workspace, 2000, 20, true);
    read_bytes(workspace->path, &first, &n);
    write_run(workspace, 2000, 20, true);
    read_bytes(workspace->path, &second, &m);
    assert_int_equal(n, m);
    assert_memory_equal(first, second, n);
    free(first);
    free(second);
}

static void flushes_on_the_way_change_no_byte_of_a_run_whose_rows_are_held(void **state)
{
    const workspace *workspace = *state;
    unsigned char *first, *second;
    size_t n, m;
    write_run(workspace, 30, 5, true);
    read_bytes(workspace->path, &first, &n);
    flush_interval = 1e-9; /* with each row and event */
    write_run(workspace, 30, 5, true);
    flush_interval = 0;
    read_bytes(workspace->path, &second, &m);
    assert_int_equal(n, m);
    assert_memory_equal(first, second, n);
    free(first);
    free(second);
}

static void rows_that_are_held_can_be_read_after_a_flush(void **state)
{
    const workspace *workspace = *state;
    evl_error error = {.code = EVL_EXIT_OK};
    flush_interval = 1e-9; /* with each row */
    history *history = create(workspace->path, &error);
    flush_interval = 0;
    for (long i = 0; i < 20; i++) {
        assert_true(append(history, i, &error));
        check_rows(workspace->partial, i + 1);
    }
    assert_true(close_as(&history, true, "done", &error));
    check_rows(workspace->path, 20);
}

static void a_short_run_makes_a_small_file(void **state)
{
    const workspace *workspace = *state;
    struct stat status;
    write_run(workspace, 10, 0, true);
    assert_int_equal(stat(workspace->path, &status), 0);
    assert_in_range(status.st_size, 1, 40000); /* one chunk of 1024 rows of each variable would take 90 kB */
}

static void a_path_that_cannot_be_written_is_refused_with_its_reason(void **state)
{
    const workspace *workspace = *state;
    char path[160];
    evl_error error = {.code = EVL_EXIT_OK};
    (void)snprintf(path, sizeof path, "%s/none/run.h5", workspace->folder);
    assert_null(create(path, &error));
    assert_non_null(strstr(error.message, path));
    assert_non_null(strstr(error.message, "No such file or directory; create the folder"));
    assert_null(create(workspace->folder, &error));
    assert_non_null(strstr(error.message, "Is a directory; name a file"));
    assert_null(create("/dev/null", &error));
    assert_non_null(strstr(error.message, "'/dev/null': not a regular file"));
    write_run(workspace, 3, 0, true);
    (void)snprintf(path, sizeof path, "%s/under.h5", workspace->path);
    assert_null(create(path, &error));
    assert_non_null(strstr(error.message, "Not a directory"));
    (void)snprintf(path, sizeof path, "%s.partial", workspace->folder);
    assert_false(exists(path));
}

static void a_second_run_to_the_same_name_is_refused_while_the_first_writes(void **state)
{
    const workspace *workspace = *state;
    evl_error error = {.code = EVL_EXIT_OK};
    history *first = create(workspace->path, &error);
    assert_non_null(first);
    assert_true(append(first, 0, &error));
    assert_null(create(workspace->path, &error));
    assert_non_null(strstr(error.message, "another run is writing it"));
    assert_true(close_as(&first, true, "done", &error));
    check_rows(workspace->path, 1);
}

static void an_integer_that_is_none_is_refused_by_name(void **state)
{
    const workspace *workspace = *state;
    evl_error error = {.code = EVL_EXIT_OK};
    history *history = create(workspace->path, &error);
    double values[N_VALUES];
    fill_values(0, values);
    values[8] = 1e300;
    assert_false(history_append(history, 0.0, values, &error));
    assert_non_null(strstr(error.message, "tooth_pair"));
    history_abandon(&history);
    assert_null(history);
}

/** Runs in a child, whose files may have `limit` bytes. @return 0 if the writer saw that, and said so */
static int write_past_limit(const workspace *workspace, rlim_t limit)
{
    evl_error error = {.code = EVL_EXIT_OK};
    const struct rlimit size = {.rlim_cur = limit, .rlim_max = limit};
    (void)signal(SIGXFSZ, SIG_IGN);
    if (setrlimit(RLIMIT_FSIZE, &size) != 0 || history_version()[0] == '\0') {
        return 10;
    }
    history *history = create(workspace->path, &error);
    bool good = history != NULL;
    for (long i = 0; good && i < 20000; i++) {
        good = append(history, i, &error);
    }
    if (!good && history != NULL) {
        history_abandon(&history);
    } else if (good) {
        good = close_as(&history, true, "done", &error);
    }
    return good ? 11 : strstr(error.message, "run.h5.partial': File too large; raise the limit") == NULL ? 12 : 0;
}

/* After a write that failed HDF5 cannot flush its cache, and keeps the memory. */
const char *__lsan_default_suppressions(void); // NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
const char *__lsan_default_suppressions(void)  // NOLINT(bugprone-reserved-identifier,cert-dcl37-c,cert-dcl51-cpp)
{
    return "leak:libhdf5\n";
}

static void a_final_integer_that_is_none_is_refused_by_name(void **state)
{
    const workspace *workspace = *state;
    const double nones[] = {1e300, -3e9, NAN};
    for (size_t i = 0; i < sizeof nones / sizeof *nones; i++) {
        const double values[] = {0, 0.1, 1, 2, 3, nones[i]};
        char path[120];
        evl_error error = {.code = EVL_EXIT_OK};
        (void)snprintf(path, sizeof path, "%s.%zu", workspace->path, i); /* HDF5 keeps one that was abandoned */
        history *history = create(path, &error);
        assert_true(append(history, 0, &error));
        assert_false(history_put_finals(history, sizeof finals / sizeof *finals, finals, values, &error));
        assert_non_null(strstr(error.message, "times_passed"));
        (void)unlink(history_partial_path(history));
        history_abandon(&history);
    }
}

static void a_write_that_fails_is_reported_and_leaves_the_older_file(void **state)
{
    const workspace *workspace = *state;
    const rlim_t limits[] = {0, 2000, 20000, 200000, 1000000};
    write_run(workspace, 5, 0, true);
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        const pid_t child = fork();
        if (child == 0) {
            exit(write_past_limit(workspace, limits[i])); /* through exit(): HDF5 must not crash there */
        }
        int result = -1;
        assert_int_equal(waitpid(child, &result, 0), child);
        assert_true(WIFEXITED(result));
        assert_int_equal(WEXITSTATUS(result), 0);
        check_rows(workspace->path, 5);
    }
}

int main(void)
{
#define TEST(claim) cmocka_unit_test_setup_teardown(claim, make_workspace, remove_workspace)
    const struct CMUnitTest tests[] = {
        TEST(every_row_is_read_back_whatever_their_number),
        TEST(events_keep_both_sides_of_the_state),
        TEST(every_axis_is_attached_to_its_dimension_in_the_eyes_of_hdf5),
        TEST(finals_are_read_back_with_their_attributes),
        TEST(rows_that_come_together_are_those_that_come_one_by_one),
        TEST(no_finals_change_nothing),
        TEST(only_a_commit_replaces_an_older_file),
        TEST(the_same_run_gives_the_same_file_to_the_byte),
        TEST(flushes_on_the_way_change_no_byte_of_a_run_whose_rows_are_held),
        TEST(rows_that_are_held_can_be_read_after_a_flush),
        TEST(a_short_run_makes_a_small_file),
        TEST(a_path_that_cannot_be_written_is_refused_with_its_reason),
        TEST(a_second_run_to_the_same_name_is_refused_while_the_first_writes),
        TEST(an_integer_that_is_none_is_refused_by_name),
        TEST(a_final_integer_that_is_none_is_refused_by_name),
        TEST(a_write_that_fails_is_reported_and_leaves_the_older_file),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
