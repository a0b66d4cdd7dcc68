/* A wheel on file: what is damaged, cut, or another's is refused, and no false number comes in. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <unistd.h>

#include "files/wheel_file.h"

enum { N_KEY = 19, N = 601, MOST_BYTES = 1 << 16, EVERY = 7 };
static const char path[] = "test_wheel_file.tmp.h5";
static double key[N_KEY], numbers[N], found[N];
static unsigned char bytes[MOST_BYTES];

static wheel_numbers wheel_at(double *to)
{
    return (wheel_numbers){.n_key = N_KEY, .key = key, .n = N, .numbers = to};
}

/** Write a made-up wheel. @return how many bytes the file has, which are read */
static size_t make_file(void)
{
    evl_error error;
    for (int i = 0; i < N; i++) {
        key[i % N_KEY] = 1.0 / (i % N_KEY + 3);
        numbers[i] = 1.0 / (i + 7);
    }
    const wheel_numbers wheel = wheel_at(numbers);
    (void)unlink(path);
    assert_true(wheel_file_write(path, &wheel, &error));
    FILE *file = fopen(path, "rb");
    const size_t n = file == NULL ? 0 : fread(bytes, 1, sizeof bytes, file);
    assert_true(file != NULL && fclose(file) == 0);
    assert_in_range(n, (N_KEY + N) * sizeof(double), MOST_BYTES - 1);
    return n;
}

static void write_bytes(size_t n)
{
    FILE *file = fopen(path, "wb");
    const size_t written = file == NULL || n > sizeof bytes ? 0 : fwrite(bytes, 1, n, file);
    assert_true(file != NULL && fclose(file) == 0);
    assert_int_equal(written, n);
}

static void assert_refused(const char *reason)
{
    evl_error error;
    const wheel_numbers wheel = wheel_at(found);
    assert_int_equal(wheel_file_read(path, &wheel, &error), WHEEL_FILE_REFUSED);
    assert_int_equal(error.code, EVL_EXIT_CASE);
    assert_string_equal(error.location, path);
    assert_non_null(strstr(error.message, reason));
    assert_non_null(strstr(error.message, "; delete it and continue with --resume"));
    assert_null(strchr(error.message, '\n'));
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path) == 0 || access(path, F_OK) != 0 ? 0 : -1;
}

static void a_wheel_comes_back_to_the_bit_and_stays_as_it_was_first(void **state)
{
    (void)state;
    evl_error error;
    const wheel_numbers wheel = wheel_at(found);
    (void)make_file();
    memset(found, 0, sizeof found);
    assert_true(wheel_file_write(path, &wheel, &error));
    assert_int_equal(wheel_file_read(path, &wheel, &error), WHEEL_FILE_READ);
    assert_memory_equal(found, numbers, sizeof found);
    assert_int_equal(unlink(path), 0);
    assert_int_equal(wheel_file_read(path, &wheel, &error), WHEEL_FILE_MISSING);
}

static void every_changed_bit_is_noticed_before_the_library_reads_the_file(void **state)
{
    (void)state;
    const size_t n = make_file();
    for (size_t i = 0; i < n; i += EVERY) {
        const unsigned char flip = (unsigned char)(1 << i % 8);
        bytes[i] ^= flip;
        write_bytes(n);
        bytes[i] ^= flip;
        assert_refused("is damaged: its checksum is wrong");
    }
}

static void a_file_that_was_cut_is_refused(void **state)
{
    (void)state;
    static const size_t less[] = {1, 100, 4096};
    const size_t n = make_file();
    for (size_t i = 0; i < sizeof less / sizeof *less; i++) {
        write_bytes(n - less[i]);
        assert_refused("damaged");
        write_bytes(less[i] - 1);
        assert_refused("damaged");
    }
}

static void a_file_of_another_wheel_or_size_is_refused(void **state)
{
    (void)state;
    evl_error error;
    (void)make_file();
    key[N_KEY - 1] += 1e-15;
    assert_refused("belongs to another wheel");
    assert_int_equal(unlink(path), 0);
    const wheel_numbers shorter = {.n_key = N_KEY, .key = key, .n = N - 1, .numbers = numbers};
    assert_true(wheel_file_write(path, &shorter, &error));
    assert_refused("has the wrong number of values");
}

#define TEST(name) cmocka_unit_test_teardown(name, remove_file)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(a_wheel_comes_back_to_the_bit_and_stays_as_it_was_first),
        TEST(every_changed_bit_is_noticed_before_the_library_reads_the_file),
        TEST(a_file_that_was_cut_is_refused),
        TEST(a_file_of_another_wheel_or_size_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
