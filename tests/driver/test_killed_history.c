/** A writer of histories that is killed: what is left under NAME.partial can be read, and its rows are whole. */
#include "files/history.h"

#include <hdf5.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

enum { N_SERIES = 12, N_VALUES = N_SERIES + 1, N_KILLS = 60, MANY_ROWS = 8192 };

static char folder[64], path[96], partial[112], left[120];

static int make_workspace(void **state)
{
    (void)state;
    (void)snprintf(folder, sizeof folder, "/tmp/test_killed_XXXXXX");
    if (mkdtemp(folder) == NULL) {
        return -1;
    }
    (void)snprintf(path, sizeof path, "%s/run.h5", folder);
    (void)snprintf(partial, sizeof partial, "%s.partial", path);
    (void)snprintf(left, sizeof left, "%s.new", partial);
    return 0;
}

static int remove_workspace(void **state)
{
    (void)state;
    (void)unlink(path);
    (void)unlink(partial);
    (void)unlink(left);
    (void)rmdir(folder);
    return 0;
}

/** Value i of a row. */
static double value_at(long row, int i)
{
    return i == N_SERIES ? 20 : i % 3 == 0 ? (double)(row % 1000) : (double)row + 0.01 * i;
}

/** Writes until it is killed, with a flush each 2 ms, with a pause now and then if it is slow; exits if it cannot.
 *  @param told  gets a byte once there are rows enough for the next flush to leave some */
static void write_for_ever(long max_rows, bool is_slow, int ready)
{
    static const char *const wheels[] = {"pinion", "gear"}, *const meshes[] = {"pinion-gear"}, *const kinds[] = {"a"};
    static const model_names names = {.wheels = {2, wheels}, .meshes = {1, meshes}};
    static const model_state states[] = {{"reference_angle", "rad"}};
    static char output_names[N_VALUES][8];
    model_output outputs[N_VALUES];
    for (int i = 0; i < N_VALUES; i++) {
        (void)snprintf(output_names[i], sizeof output_names[i], "v%d", i);
        outputs[i] = (model_output){output_names[i],
                                    "1",
                                    "v",
                                    "a value",
                                    i % 2 == 0 ? "mesh" : "",
                                    i == N_SERIES,
                                    i == N_SERIES || i % 3 == 0,
                                    i,
                                    1,
                                    NULL};
    }
    const history_layout layout = {.path = path,
                                   .kind = "history",
                                   .axis = {.name = "time", .units = "s", .symbol = "t", .long_name = "model time"},
                                   .names = &names,
                                   .n_outputs = N_VALUES,
                                   .outputs = outputs,
                                   .n_states = 1,
                                   .states = states,
                                   .n_event_kinds = 1,
                                   .event_kinds = kinds,
                                   .max_rows = max_rows,
                                   .flush_interval = 2e-3};
    evl_error error = {.code = EVL_EXIT_OK};
    history *history = history_create(&layout, &error);
    bool good = history != NULL;
    const struct timespec pause = {.tv_nsec = 1000000};
    for (long row = 0; good; row++) {
        (void)(is_slow && row % 50 == 0 && nanosleep(&pause, NULL));
        double values[N_VALUES];
        for (int i = 0; i < N_VALUES; i++) {
            values[i] = value_at(row, i);
        }
        const double state = (double)row;
        const history_event event = {.t = state, .before = &state, .after = &state};
        good = history_append(history, (double)row, values, &error) &&
               (row % 10 != 0 || history_add_event(history, &event, &error));
        good = good && (row != (is_slow ? 1 : MANY_ROWS) || write(ready, "", 1) == 1);
    }
    _exit(1);
}

/** Rows of a variable; its values as doubles, to be freed, `of_row` to a row. */
static long read_rows(hid_t file, const char *name, double **values, int *of_row)
{
    hsize_t extent[3] = {0};
    const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(dataset >= 0);
    const hid_t space = H5Dget_space(dataset);
    (void)H5Sget_simple_extent_dims(space, extent, NULL);
    const hssize_t n = H5Sget_simple_extent_npoints(space);
    *of_row = extent[0] == 0 ? 1 : (int)((hsize_t)n / extent[0]);
    *values = calloc((size_t)n + 1, sizeof **values);
    assert_true(H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, *values) >= 0);
    (void)H5Sclose(space);
    (void)H5Dclose(dataset);
    return (long)extent[0];
}

static void check_values(hid_t file, const char *name, long n, int i)
{
    double *values = NULL;
    int of_row = 0;
    assert_int_equal(read_rows(file, name, &values, &of_row), n);
    for (long row = 0; row < n; row++) {
        const double expected = i < 0 ? (double)row : value_at(row, i);
        assert_true(values[row * of_row] >= expected && values[row * of_row] <= expected);
    }
    free(values);
}

/** Rows of what is left under NAME.partial, each of them whole; -1 if nothing is. */
static long check_left(void)
{
    struct stat status;
    if (stat(partial, &status) != 0 || status.st_size == 0) {
        return -1;
    }
    const hid_t file = H5Fopen(partial, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    double *times = NULL, *events = NULL;
    int of_row = 0;
    const long n = read_rows(file, "time", &times, &of_row),
               n_events = read_rows(file, "events/event", &events, &of_row);
    check_values(file, "time", n, -1);
    for (int i = 0; i < N_SERIES; i++) {
        char name[8];
        (void)snprintf(name, sizeof name, "v%d", i);
        check_values(file, name, n, i);
    }
    check_values(file, "events/event", n_events, -1);
    assert_in_range(n_events, n / 10, n / 10 + 1);
    double *state = NULL;
    assert_int_equal(read_rows(file, "events/reference_angle", &state, &of_row), n_events);
    for (long row = 0; row < n_events; row++) {
        const double expected = 10.0 * (double)row;
        assert_true(state[2 * row] >= expected && state[2 * row + 1] <= expected);
    }
    assert_true(n == 0 || H5Lexists(file, "v12", H5P_DEFAULT) > 0); /* the constant */
    free(state);
    free(events);
    free(times);
    (void)H5Fclose(file);
    return n;
}

/** A while from the start of the writer or, each other time, from when it has rows: busy machines start late. */
static void wait_until_kill(int i, int ready)
{
    char byte;
    assert_true(i % 2 == 0 || read(ready, &byte, 1) == 1);
    const long moment = 1 + 80L * ((i * 37) % N_KILLS) / N_KILLS; /* ms, in no order */
    const struct timespec time = {.tv_nsec = 1000000 * moment + 7919 * i};
    (void)nanosleep(&time, NULL);
}

/** Kill writers at many moments. @return how many have left rows: held ones if they are slow, grown ones if not */
static int kill_many(long max_rows, bool is_slow)
{
    int n_left = 0;
    (void)setenv("HDF5_USE_FILE_LOCKING", "FALSE", 1);
    for (int i = 0; i < N_KILLS; i++) {
        int ready[2];
        assert_int_equal(pipe(ready), 0);
        const pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            write_for_ever(max_rows, is_slow, ready[1]);
        }
        (void)close(ready[1]); /* whoever waits for it comes to its end with the writer */
        wait_until_kill(i, ready[0]);
        (void)close(ready[0]);
        int result = 0;
        assert_int_equal(kill(child, SIGKILL), 0);
        assert_int_equal(waitpid(child, &result, 0), child);
        assert_true(WIFSIGNALED(result));
        const long n = check_left();
        n_left += is_slow ? n > 0 && n <= MANY_ROWS : n > MANY_ROWS;
    }
    print_message("%d of %d killed writers have left rows\n", n_left, N_KILLS);
    return n_left;
}

static void a_killed_writer_leaves_rows_that_were_held(void **state)
{
    (void)state;
    assert_true(kill_many(0, true) > N_KILLS / 10);
}

static void a_killed_writer_leaves_rows_that_grow_up_to_a_limit(void **state)
{
    (void)state;
    assert_true(kill_many(100000000, false) > N_KILLS / 10);
}

static void a_killed_writer_leaves_rows_that_grow_without_limit(void **state)
{
    (void)state;
    assert_true(kill_many(0, false) > N_KILLS / 10);
}

int main(void)
{
#define TEST(claim) cmocka_unit_test_setup_teardown(claim, make_workspace, remove_workspace)
    const struct CMUnitTest tests[] = {
        TEST(a_killed_writer_leaves_rows_that_were_held),
        TEST(a_killed_writer_leaves_rows_that_grow_up_to_a_limit),
        TEST(a_killed_writer_leaves_rows_that_grow_without_limit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
