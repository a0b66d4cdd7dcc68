/* Designs as files: values come back to the bit, in every type that a column may have. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <evolvent_version.h>
#include <hdf5.h>
#include <unistd.h>

#include "files/design.h"

static const char path[] = "test_design.tmp.h5";
enum { N_CASES = 3 };

static void put(hid_t object, const char *name, hid_t type, hsize_t n, const void *value)
{
    const hid_t space = n == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, NULL);
    const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Awrite(attribute, type, value) >= 0);
    (void)H5Aclose(attribute);
    (void)H5Sclose(space);
}

static hid_t text_type(void)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    assert_true(H5Tset_size(type, H5T_VARIABLE) >= 0 && H5Tset_cset(type, H5T_CSET_UTF8) >= 0);
    return type;
}

static void put_text(hid_t object, const char *name, const char *text)
{
    const hid_t type = text_type();
    put(object, name, type, 0, &text);
    (void)H5Tclose(type);
}

static void put_fixed_text(hid_t object, const char *name, const char *text)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    assert_true(H5Tset_size(type, strlen(text)) >= 0); /* no room for a zero byte, as numpy has it */
    put(object, name, type, 0, text);
    (void)H5Tclose(type);
}

static void put_column(hid_t group, const char *name, const char *set_path, hid_t type, const void *values)
{
    const hsize_t n = N_CASES;
    const hid_t space = H5Screate_simple(1, &n, NULL);
    const hid_t dataset = H5Dcreate2(group, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
    put_text(dataset, "path", set_path);
    (void)H5Dclose(dataset);
    (void)H5Sclose(space);
}

static hid_t begin_design(void)
{
    const long long format = 1, n_cases = N_CASES, every = 7;
    const double window[] = {0.25, 0.5};
    const hid_t file = H5Fcreate(path, H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    assert_true(file >= 0);
    put(file, "evolvent_design_format", H5T_NATIVE_LLONG, 0, &format);
    put(file, "n_cases", H5T_NATIVE_LLONG, 0, &n_cases);
    put(file, "history_every", H5T_NATIVE_LLONG, 0, &every);
    put(file, "window", H5T_NATIVE_DOUBLE, 2, window);
    put_text(file, "evolvent_version", EVOLVENT_VERSION);
    put_text(file, "case", "format: 1\n");
    put_fixed_text(file, "hash", "abc123");
    put_text(file, "history_variables", "gap");
    return file;
}

static void assert_option(const design *design, int column, long index, const char *expected)
{
    char *option = design_option(design, column, index, NULL);
    assert_string_equal(option, expected);
    free(option);
}

static void columns_of_every_type_become_set_options(void **state)
{
    (void)state;
    const double reals[] = {0.1, -1e-300, NAN}, derived[] = {1, 2, 3}, more[] = {INFINITY, -INFINITY, 20};
    const float singles[] = {0.5F, 2e6F, 0};
    const short integers[] = {20, -3, 0};
    const char *const texts[] = {"{law: johnson}", "\xc3\xa9", ""};
    const hid_t file = begin_design(), type = text_type();
    const hid_t group = H5Gcreate2(file, "parameters", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_column(group, "p0", "a.b", H5T_NATIVE_DOUBLE, reals);
    put_column(group, "p1", "", H5T_NATIVE_DOUBLE, derived);
    put_column(group, "p2", "c", H5T_NATIVE_SHORT, integers);
    put_column(group, "p3", "d.0", type, texts);
    put_column(group, "p4", "e", H5T_NATIVE_FLOAT, singles);
    put_column(group, "p5", "f", H5T_NATIVE_DOUBLE, more);
    (void)H5Tclose(type);
    (void)H5Gclose(group);
    (void)H5Fclose(file);

    evl_error error;
    design *design = design_read(path, &error);
    assert_non_null(design);
    assert_int_equal(design->n_cases, N_CASES);
    assert_int_equal(design->n_columns, 5); /* a derived column has no path */
    assert_int_equal(design->history_every, 7);
    /* by Python's hashlib and struct from what docs/guides/batch.md says */
    assert_string_equal(design->hash, "25c8d6395d49393505669204b15b768be4ebcd985afc0f9799763fe81a53381d");
    assert_true(design->window[0] == 0.25 && design->window[1] == 0.5);
    assert_option(design, 0, 0, "a.b=0.1");
    assert_option(design, 0, 1, "a.b=-1.0e-300");
    assert_option(design, 0, 2, "a.b=.nan");
    assert_option(design, 1, 0, "c=20");
    assert_option(design, 1, 1, "c=-3");
    assert_option(design, 2, 0, "d.0={law: johnson}");
    assert_option(design, 2, 1, "d.0=\xc3\xa9");
    assert_option(design, 2, 2, "d.0=");
    assert_option(design, 3, 1, "e=2000000");
    assert_option(design, 4, 0, "f=.inf");
    assert_option(design, 4, 1, "f=-.inf");
    assert_option(design, 4, 2, "f=20");
    design_delete(&design);
    assert_null(design);
    assert_int_equal(unlink(path), 0);
}

static void a_design_without_parameters_or_columns_is_refused(void **state)
{
    (void)state;
    evl_error error;
    hid_t file = begin_design();
    (void)H5Fclose(file);
    assert_null(design_read(path, &error));
    assert_int_equal(error.code, EVL_EXIT_CASE);
    assert_string_equal(error.message, "has no group parameters");

    const double reals[] = {1, 2, 3};
    file = begin_design();
    const hid_t group = H5Gcreate2(file, "parameters", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_column(group, "p1", "a", H5T_NATIVE_DOUBLE, reals);
    (void)H5Gclose(group);
    (void)H5Fclose(file);
    assert_null(design_read(path, &error));
    assert_string_equal(error.message, "p0: this column is missing; columns are parameters/p0, p1, ...");
    assert_int_equal(unlink(path), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns_of_every_type_become_set_options),
        cmocka_unit_test(a_design_without_parameters_or_columns_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
