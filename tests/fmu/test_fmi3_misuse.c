/* An FMU in an importer that hands over what it should not, that makes many, that has no memory. */
#include "importer.h"

#include "base/memory.h"

#include <float.h>
#include <malloc.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

/* ---- misuse ---- */

static void refused(fmi3Status status, const char *words)
{
    assert_int_equal(status, fmi3Error);
    if (strstr(logged, words) == NULL) {
        fail_msg("'%s' is not in '%s'", words, logged);
    }
}

static void what_no_importer_should_hand_over_is_refused_and_changes_nothing(void **state)
{
    (void)state;
    static double expected[MOST], got[MOST];
    const double odd[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, -1e-3, -DBL_MIN};
    fmi3Instance fmu = make(RATTLE, true), other = make(RATTLE, true);
    refused(EnterInitializationMode(fmu, false, 0, NAN, false, 0), "a case starts at 0");
    refused(EnterInitializationMode(fmu, false, 0, 0, true, NAN), "the stop time is nan s");
    refused(EnterInitializationMode(fmu, false, 0, 0, true, -1), "the stop time is -1 s");
    begin(fmu);
    begin(other);
    for (unsigned kind = 0; kind < 16; kind++) {
        const fmi3ValueReference reference = (kind << FMU_KIND_SHIFT) | 0x0fffffffU;
        double number = 1;
        refused(GetFloat64(fmu, &reference, 1, &number, 1), "there is no variable with the value reference");
        refused(SetFloat64(fmu, &reference, 1, &number, 1), "there is no variable with the value reference");
    }
    const fmi3ValueReference twice[] = {0, 0};
    refused(GetFloat64(fmu, twice, 2, got, 1), "do not have 1 values");
    refused(GetFloat64(fmu, twice, 2, got, 3), "do not have 3 values");
    const fmi3ValueReference input = fmu_reference(FMU_INPUT, 0);
    for (size_t i = 0; i < 3; i++) {
        refused(SetFloat64(fmu, &input, 1, &odd[i], 1), "must be finite");
    }
    assert_int_equal(GetFloat64(fmu, NULL, 0, NULL, 0), fmi3OK);
    assert_int_equal(SetFloat64(fmu, NULL, 0, NULL, 0), fmi3OK);
    assert_int_equal(GetInt32(fmu, NULL, 0, NULL, 0), fmi3OK);
    refused(GetContinuousStates(fmu, got, 1), "1 values are requested");
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        refused(step(fmu, 0, odd[i]), "but must be positive");
    }
    refused(step(fmu, NAN, 1e-4), "the communication point is nan s");
    refused(step(fmu, 1, 1e-4), "the communication point is 1 s");
    fmi3FMUState none = NULL;
    size_t n = 7;
    refused(SetFMUState(fmu, NULL), "there is no state");
    refused(SerializedFMUStateSize(fmu, NULL, &n), "there is no state");
    refused(SerializeFMUState(fmu, NULL, (fmi3Byte *)got, 8), "there is no state");
    refused(DeserializeFMUState(fmu, (const fmi3Byte *)"", 0, &none), "not a state of this FMU");
    assert_null(none);
    assert_int_equal(FreeFMUState(fmu, NULL), fmi3OK);
    assert_int_equal(FreeFMUState(fmu, &none), fmi3OK);
    FreeInstance(NULL);
    assert_int_equal(Reset(NULL), fmi3Fatal);
    steps(fmu, 0, STEPS);
    steps(other, 0, STEPS);
    outputs(fmu, RATTLE, got);
    outputs(other, RATTLE, expected);
    assert_memory_equal(got, expected, (size_t)gearboxes[RATTLE].n_outputs * sizeof *got);
    FreeInstance(fmu);
    FreeInstance(other);
    fmu = in_mode(CONTINUOUS);
    (void)GetNumberOfContinuousStates(fmu, &n);
    for (size_t i = 0; i < n; i++) {
        got[i] = NAN;
    }
    refused(SetTime(fmu, NAN), "must be finite");
    refused(SetContinuousStates(fmu, got, n), "must be finite");
    FreeInstance(fmu);
    assert_null(InstantiateCoSimulation("one", NULL, NULL, false, false, false, false, NULL, 0, NULL, hear, NULL));
    assert_null(InstantiateModelExchange("one", NULL, "/no/such/folder", false, false, NULL, NULL));
    assert_null(InstantiateModelExchange("one", "x", gearboxes[PAPER].folder, false, false, NULL, hear));
    assert_non_null(strstr(logged, "the instantiation token"));
}

/* Every parameter by itself, with numbers that few of them may have: the initialization takes them or says why not. */
static void parameters_are_taken_or_refused_in_one_line_and_a_reset_forgets_them(void **state)
{
    (void)state;
    static const double odd[] = {0, -1, 1e300, -1e300, 1e-300, 0.5, NAN};
    static double start[MOST], got[MOST];
    fmi3Instance fmu = make(PAPER, true);
    begin(fmu);
    outputs(fmu, PAPER, start);
    int n_taken = 0, n_refused = 0;
    for (int i = 0;; i++) {
        const fmi3ValueReference reference = fmu_reference(FMU_PARAMETER, i);
        size_t n = 1;
        while (n < 64 && GetFloat64(fmu, &reference, 1, got, n) != fmi3OK) {
            n++;
        }
        if (n == 64) {
            break;
        }
        for (size_t k = 0; k < sizeof odd / sizeof *odd; k++) {
            assert_int_equal(Reset(fmu), fmi3OK);
            for (size_t j = 0; j < n; j++) {
                got[j] = odd[k];
            }
            n_logged = 0;
            fmi3Status status = SetFloat64(fmu, &reference, 1, got, n);
            if (status == fmi3OK) {
                assert_int_equal(EnterInitializationMode(fmu, false, 0, 0, false, 0), fmi3OK);
                status = ExitInitializationMode(fmu);
            }
            assert_int_equal(n_logged, status != fmi3OK);
            *(status == fmi3OK ? &n_taken : &n_refused) += 1;
        }
    }
    assert_true(n_taken > 10 && n_refused > 50);
    assert_int_equal(Reset(fmu), fmi3OK);
    begin(fmu);
    outputs(fmu, PAPER, got);
    assert_memory_equal(got, start, (size_t)gearboxes[PAPER].n_outputs * sizeof *got);
    FreeInstance(fmu);
}

/* ---- memory; a sanitizer looks for what is lost itself ---- */

static long pages(int which)
{
    long all = 0, resident = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    assert_non_null(file);
    assert_int_equal(fscanf(file, "%ld %ld", &all, &resident), 2); /* NOLINT(cert-err34-c) */
    (void)fclose(file);
    return which == 0 ? all : resident;
}

static void instances_come_and_go_without_a_trace(void **state)
{
    (void)state;
    enum { WARM = 20, MANY = 100, MOST_PAGES = 100 };
    long before = 0;
    for (int k = 0; k < WARM + MANY; k++) {
        if (k == WARM) {
            before = pages(1);
        }
        fmi3FMUState kept = NULL;
        fmi3Instance fmu = make(k % 2 == 0 ? PAPER : RATTLE, k % 3 > 0);
        begin(fmu);
        assert_int_equal(GetFMUState(fmu, &kept), fmi3OK);
        assert_int_equal(GetFMUState(fmu, &kept), fmi3OK); /* into the same */
        assert_int_equal(Reset(fmu), fmi3OK);
        assert_int_equal(SetFMUState(fmu, kept), fmi3OK);
        assert_int_equal(FreeFMUState(fmu, &kept), fmi3OK);
        FreeInstance(fmu);
    }
#if !defined(__SANITIZE_ADDRESS__)
    assert_true(pages(1) - before < MOST_PAGES);
#else
    (void)before;
#endif
}

#if !defined(__SANITIZE_ADDRESS__)
static void limit_memory(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_AS, &limit), 0);
    limit.rlim_cur = bytes == 0 ? limit.rlim_max : bytes;
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
}

static void without_memory_a_call_is_fatal_and_other_instances_go_on(void **state)
{
    (void)state;
    static double expected[MOST], got[MOST];
    static const rlim_t KIBIBYTE = 1024;
    fmi3Instance good = make(COMPLIANT, true), other = make(COMPLIANT, true);
    begin(good);
    begin(other);
    int n_fatal = 0, n_not_made = 0;
    (void)mallopt(M_MMAP_THRESHOLD, 1 << 16); /* what was freed before is no room for large pieces */
    (void)malloc_trim(0);
    for (rlim_t more = 0; more < 12 * KIBIBYTE; more += 512) {
        fmi3Instance fmu = make(COMPLIANT, true), made;
        n_logged = 0;
        limit_memory((rlim_t)pages(0) * (rlim_t)sysconf(_SC_PAGESIZE) + more * KIBIBYTE);
        made = InstantiateCoSimulation("one", NULL, gearboxes[COMPLIANT].folder, false, false, false, false, NULL, 0,
                                       NULL, hear, NULL);
        fmi3Status status = EnterInitializationMode(fmu, false, 0, 0, false, 0);
        status = status == fmi3OK ? ExitInitializationMode(fmu) : status;
        limit_memory(0);
        if (status != fmi3OK) {
            n_fatal++;
            assert_int_equal(status, fmi3Fatal);
            assert_int_equal(step(fmu, 0, 1e-4), fmi3Fatal);
            assert_int_equal(Reset(fmu), fmi3Fatal);
            assert_non_null(strstr(logged, "after a fatal error"));
        }
        n_not_made += made == NULL;
        assert_int_equal(n_logged, (made == NULL) + (status != fmi3OK ? 3 : 0));
        FreeInstance(fmu);
        FreeInstance(made);
    }
    assert_true(n_not_made > 0 && n_fatal > 0);
    steps(good, 0, STEPS);
    steps(other, 0, STEPS);
    outputs(good, COMPLIANT, got);
    outputs(other, COMPLIANT, expected);
    assert_memory_equal(got, expected, (size_t)gearboxes[COMPLIANT].n_outputs * sizeof *got);
    FreeInstance(good);
    FreeInstance(other);
}
#define MEMORY_TESTS cmocka_unit_test(without_memory_a_call_is_fatal_and_other_instances_go_on),
#else
#define MEMORY_TESTS /* a sanitizer has an allocator of its own */
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_no_importer_should_hand_over_is_refused_and_changes_nothing),
        cmocka_unit_test(parameters_are_taken_or_refused_in_one_line_and_a_reset_forgets_them),
        MEMORY_TESTS cmocka_unit_test(instances_come_and_go_without_a_trace)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
