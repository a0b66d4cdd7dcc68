/* Wheels that were computed: found again to the bit, in a process and through a folder, where the first complete file counts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <dirent.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/memory.h"
#include "files/wheel_file.h"
#include "files/wheel_store.h"

enum { N_KEY = 19, N = 601, N_PROCESSES = 5, KILLS = 12, SHARED = 4, MANY = 1100 };
static const char folder[] = "test_wheel_store.tmp";
static double key[N_KEY], numbers[N];

/* ---- helpers ---- */

/** A made-up wheel, and what somebody has computed of it. */
static void make_wheel(double which, double by)
{
    for (int i = 0; i < N_KEY; i++) {
        key[i] = which + 1.0 / (i + 3);
    }
    for (int i = 0; i < N; i++) {
        numbers[i] = by + which / (i + 7);
    }
}

static int find_in(wheel_store *store, double found[N])
{
    const evl_wheel_store *door = wheel_store_door(store);
    return door->find(door->self, N_KEY, key, N, found);
}

/** As the kernel does. @return 1, or -1 */
static int ask(wheel_store *store, double found[N])
{
    const evl_wheel_store *door = wheel_store_door(store);
    const int status = door->find(door->self, N_KEY, key, N, found);
    if (status != 0) {
        return status;
    }
    memcpy(found, numbers, sizeof numbers);
    return door->put(door->self, N_KEY, key, N, found);
}

static wheel_store *open_store(void)
{
    evl_error error = {.code = EVL_EXIT_OK};
    wheel_store *store = wheel_store_create();
    assert_true(wheel_store_share(store, folder, &error));
    return store;
}

static void assert_computed_by(const double found[N], double which, double by)
{
    make_wheel(which, by);
    assert_memory_equal(found, numbers, sizeof numbers);
}

static wheel_numbers wheel_at(double *to)
{
    return (wheel_numbers){.n_key = N_KEY, .key = key, .n = N, .numbers = to};
}

static char *path_of(double which)
{
    make_wheel(which, 0);
    const wheel_numbers wheel = wheel_at(numbers);
    return xasprintf("%s/compliance-%016llx.h5", folder, wheel_file_hash(&wheel));
}

/** Files in the folder, whose names end like this. */
static int count_files(const char *end)
{
    int n = 0;
    DIR *entries = opendir(folder);
    if (entries == NULL) {
        return -1;
    }
    for (const struct dirent *entry = readdir(entries); entry != NULL; entry = readdir(entries)) {
        const size_t length = strlen(entry->d_name);
        n += entry->d_name[0] != '.' && length >= strlen(end) && strcmp(entry->d_name + length - strlen(end), end) == 0;
    }
    (void)closedir(entries);
    return n;
}

static int make_folder(void **state)
{
    (void)state;
    return mkdir(folder, 0777);
}

static int remove_folder(void **state)
{
    (void)state;
    DIR *entries = opendir(folder);
    if (entries == NULL) {
        return -1;
    }
    for (const struct dirent *entry = readdir(entries); entry != NULL; entry = readdir(entries)) {
        CLEANUP_FREE char *path = xasprintf("%s/%s", folder, entry->d_name);
        (void)unlink(path);
    }
    (void)closedir(entries);
    return rmdir(folder);
}

/* ---- who is found ---- */

static void a_process_computes_a_wheel_once(void **state)
{
    (void)state;
    double found[N];
    wheel_store *store = wheel_store_create();
    for (int i = 0; i < 3; i++) {
        make_wheel(1, i);
        assert_int_equal(ask(store, found), 1);
        assert_computed_by(found, 1, 0);
    }
    assert_int_equal(wheel_store_computed(store), 1);
    make_wheel(2, 5);
    assert_int_equal(find_in(store, found), 0);
    assert_int_equal(count_files(""), 0);
    wheel_store_delete(&store);
    assert_null(store);
}

static void the_first_complete_file_counts_for_all(void **state)
{
    (void)state;
    double found[N];
    wheel_store *first = open_store(), *second = open_store();
    make_wheel(1, 0);
    assert_int_equal(find_in(second, found), 0);
    assert_int_equal(ask(first, found), 1);
    /* the second has looked before there was a file, and computes other numbers */
    const evl_wheel_store *door = wheel_store_door(second);
    make_wheel(1, 0.5);
    memcpy(found, numbers, sizeof numbers);
    assert_int_equal(door->put(door->self, N_KEY, key, N, found), 1);
    assert_computed_by(found, 1, 0);
    make_wheel(1, 0.25);
    assert_int_equal(ask(second, found), 1);
    assert_computed_by(found, 1, 0);
    assert_int_equal(count_files(""), 1);
    wheel_store_delete(&first);
    wheel_store_delete(&second);
}

static void a_folder_counts_more_than_what_was_known_before(void **state)
{
    (void)state;
    double found[N];
    evl_error error;
    wheel_store *first = open_store(), *second = wheel_store_create();
    make_wheel(1, 0);
    assert_int_equal(ask(first, found), 1);
    make_wheel(1, 0.5);
    assert_int_equal(ask(second, found), 1);
    make_wheel(2, 0.5);
    assert_int_equal(ask(second, found), 1);
    assert_true(wheel_store_share(second, folder, &error));
    make_wheel(1, 0.75);
    assert_int_equal(ask(second, found), 1);
    assert_computed_by(found, 1, 0);
    make_wheel(2, 0.75);
    assert_int_equal(ask(first, found), 1);
    assert_computed_by(found, 2, 0.5);
    assert_int_equal(count_files(""), 2);
    wheel_store_delete(&first);
    wheel_store_delete(&second);
}

static void more_wheels_than_memory_holds_are_found_in_the_folder(void **state)
{
    (void)state;
    double found[N];
    wheel_store *shared = open_store(), *alone = wheel_store_create();
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < MANY; i += 1 + (pass == 0 ? 0 : MANY / 4)) {
            make_wheel(i, 0);
            assert_int_equal(ask(alone, found), 1);
            assert_computed_by(found, i, 0);
            if (i % (MANY / 4) == 0 || i > MANY - 5) {
                assert_int_equal(ask(shared, found), 1);
                assert_computed_by(found, i, 0);
            }
        }
    }
    assert_int_equal(wheel_store_computed(shared), count_files(".h5"));
    assert_true(wheel_store_computed(alone) > MANY); /* those it forgot are computed anew */
    wheel_store_delete(&shared);
    wheel_store_delete(&alone);
}

/* ---- many at once ---- */

/** Each computes its own numbers of the same wheels; which ones all of them got is told by the exit code. */
static int ask_as(int who)
{
    double found[N];
    wheel_store *store = open_store();
    int by = -1;
    for (int which = 0; which < SHARED; which++) {
        make_wheel(which, who);
        if (ask(store, found) != 1) {
            return 99;
        }
        for (int other = 0; other < N_PROCESSES; other++) {
            make_wheel(which, other);
            by = memcmp((const char *)found, (const char *)numbers, sizeof numbers) == 0 ? other : by;
        }
    }
    wheel_store_delete(&store);
    return by;
}

static void processes_at_one_time_come_to_the_same_numbers(void **state)
{
    (void)state;
    pid_t pids[N_PROCESSES];
    int by[N_PROCESSES];
    for (int i = 0; i < N_PROCESSES; i++) {
        pids[i] = fork();
        if (pids[i] == 0) {
            _exit(ask_as(i));
        }
    }
    for (int i = 0; i < N_PROCESSES; i++) {
        assert_int_equal(waitpid(pids[i], &by[i], 0), pids[i]);
        assert_true(WIFEXITED(by[i]));
        assert_true(WEXITSTATUS(by[i]) < N_PROCESSES);
        assert_int_equal(by[i], by[0]); /* of the last wheel */
    }
    assert_int_equal(count_files(""), SHARED);
}

static void kill_9_leaves_only_whole_files(void **state)
{
    (void)state;
    double found[N];
    for (int kill_number = 0; kill_number < KILLS; kill_number++) {
        const pid_t pid = fork();
        if (pid == 0) {
            wheel_store *store = open_store();
            for (int which = 0; which < MANY; which++) {
                make_wheel(MANY * kill_number + which, 0);
                (void)ask(store, found);
            }
            _exit(0);
        }
        const struct timespec wait = {.tv_nsec = 5000000 + 1370000L * kill_number};
        (void)nanosleep(&wait, NULL);
        (void)kill(pid, SIGKILL);
        (void)waitpid(pid, NULL, 0);
    }
    int n_whole = 0;
    for (int kill_number = 0; kill_number < KILLS; kill_number++) {
        for (int which = 0; which < MANY; which++) {
            evl_error error;
            const double one = MANY * kill_number + which;
            CLEANUP_FREE char *path = path_of(one);
            const wheel_numbers wheel = wheel_at(found);
            const wheel_file_status status = wheel_file_read(path, &wheel, &error);
            if (status == WHEEL_FILE_READ) {
                assert_computed_by(found, one, 0);
                n_whole++;
            } else {
                assert_int_equal(status, WHEEL_FILE_MISSING);
            }
        }
    }
    assert_int_equal(n_whole, count_files(".h5"));
    assert_true(n_whole > 0);
}

/* ---- what is refused ---- */

static void a_refused_file_is_never_computed_anew(void **state)
{
    (void)state;
    double found[N];
    CLEANUP_FREE char *path = path_of(1);
    FILE *file = fopen(path, "wb");
    assert_true(file != NULL && fclose(file) == 0);
    wheel_store *store = open_store();
    make_wheel(1, 0);
    assert_int_equal(ask(store, found), -1);
    assert_int_equal(wheel_store_error(store)->code, EVL_EXIT_CASE);
    assert_string_equal(wheel_store_error(store)->location, path);
    assert_int_equal(wheel_store_computed(store), 0);
    wheel_store_delete(&store);
}

static void what_cannot_be_written_is_told(void **state)
{
    (void)state;
    double found[N];
    evl_error error = {.code = EVL_EXIT_OK};
    wheel_store *store = wheel_store_create();
    assert_true(wheel_store_share(store, "test_wheel_store.tmp/none", &error));
    make_wheel(1, 0);
    assert_int_equal(ask(store, found), -1);
    assert_int_equal(wheel_store_error(store)->code, EVL_EXIT_IO);
    assert_non_null(strstr(wheel_store_error(store)->location, "test_wheel_store.tmp/none/compliance-"));
    wheel_store_delete(&store);
}

static void a_file_that_does_not_fit_is_told_and_leaves_nothing(void **state)
{
    (void)state;
    const pid_t pid = fork();
    if (pid == 0) {
        double found[N];
        wheel_store *store = open_store();
        const struct rlimit small = {.rlim_cur = 4096, .rlim_max = RLIM_INFINITY};
        (void)signal(SIGXFSZ, SIG_IGN);
        make_wheel(1, 0);
        const bool good = setrlimit(RLIMIT_FSIZE, &small) == 0 && ask(store, found) == -1 &&
                          wheel_store_error(store)->code == EVL_EXIT_IO &&
                          strstr(wheel_store_error(store)->message, "free space") != NULL;
        _exit(good ? 0 : 1);
    }
    int status = 0;
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    assert_int_equal(count_files(""), 0);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_process_computes_a_wheel_once),
        TEST(the_first_complete_file_counts_for_all),
        TEST(a_folder_counts_more_than_what_was_known_before),
        TEST(more_wheels_than_memory_holds_are_found_in_the_folder),
        TEST(processes_at_one_time_come_to_the_same_numbers),
        TEST(kill_9_leaves_only_whole_files),
        TEST(a_refused_file_is_never_computed_anew),
        TEST(what_cannot_be_written_is_told),
        TEST(a_file_that_does_not_fit_is_told_and_leaves_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
