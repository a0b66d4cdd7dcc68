#include "batch/batch_checkpoints.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

/** Another process removes the common folder whenever it is empty, as the supervisor does after the last case. */
static void folders_are_made_while_the_common_one_is_removed(void **state)
{
    (void)state;
    char parent[] = "/tmp/evolvent-test-XXXXXX";
    assert_non_null(mkdtemp(parent));
    char folder[64];
    assert_true(snprintf(folder, sizeof folder, "%s/checkpoints", parent) < (int)sizeof folder);
    const batch_checkpoints checkpoints = {.folder = folder};
    const pid_t other = fork();
    assert_true(other >= 0);
    if (other == 0) {
        for (;;) {
            (void)rmdir(folder);
        }
    }
    int n_made = 0;
    evl_error error = {.code = EVL_EXIT_OK};
    for (int i = 0; i < 300 && batch_checkpoints_make(&checkpoints, 3, &error); i++) {
        n_made++;
        batch_checkpoints_remove(&checkpoints, 3);
    }
    assert_int_equal(kill(other, SIGKILL), 0);
    assert_int_equal(waitpid(other, NULL, 0), other);
    (void)rmdir(folder);
    assert_int_equal(rmdir(parent), 0);
    assert_string_equal(error.message, "");
    assert_int_equal(n_made, 300);
}

static void a_file_in_place_of_the_folder_is_refused(void **state)
{
    (void)state;
    char file[] = "/tmp/evolvent-test-XXXXXX";
    const int descriptor = mkstemp(file);
    assert_true(descriptor >= 0);
    assert_int_equal(close(descriptor), 0);
    evl_error error = {.code = EVL_EXIT_OK};
    assert_false(batch_checkpoints_make(&(batch_checkpoints){.folder = file}, 3, &error));
    assert_int_equal(error.code, EVL_EXIT_IO);
    assert_string_equal(error.location, file);
    assert_int_equal(remove(file), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(folders_are_made_while_the_common_one_is_removed),
        cmocka_unit_test(a_file_in_place_of_the_folder_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
