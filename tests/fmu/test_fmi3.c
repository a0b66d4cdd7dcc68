/* An FMU in an importer: it moves as it should by steps and by states, and every call has its modes. */
#include "importer.h"

#include "base/memory.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* ---- motions ---- */

static void each_case_is_moved_by_steps_and_put_away_and_reset_to_the_same_bits(void **state)
{
    (void)state;
    for (int i = 0; i < N_GEARBOXES; i++) {
        static double expected[MOST], got[MOST], start[MOST];
        const size_t size = (size_t)gearboxes[i].n_outputs * sizeof *got;
        fmi3Instance fmu = make(i, true), other = make(i, true);
        fmi3FMUState kept = NULL, read = NULL;
        begin(fmu);
        outputs(fmu, i, start);
        steps(fmu, 0, STEPS / 2);
        assert_int_equal(GetFMUState(fmu, &kept), fmi3OK);
        steps(fmu, STEPS / 2, STEPS);
        outputs(fmu, i, expected);
        assert_memory_not_equal(expected, start, size);
        size_t n = 0;
        assert_int_equal(SerializedFMUStateSize(fmu, kept, &n), fmi3OK);
        CLEANUP_FREE fmi3Byte *bytes = xcalloc(n, 1);
        assert_int_equal(SerializeFMUState(fmu, kept, bytes, n), fmi3OK);
        assert_int_equal(DeserializeFMUState(other, bytes, n, &read), fmi3OK);
        for (int k = 0; k < 2; k++) { /* into another one, and back */
            fmi3Instance on = k == 0 ? other : fmu;
            assert_int_equal(SetFMUState(on, k == 0 ? read : kept), fmi3OK);
            steps(on, STEPS / 2, STEPS);
            outputs(on, i, got);
            assert_memory_equal(got, expected, size);
        }
        assert_int_equal(Terminate(fmu), fmi3OK);
        outputs(fmu, i, got);
        assert_memory_equal(got, expected, size);
        assert_int_equal(Reset(fmu), fmi3OK);
        begin(fmu);
        outputs(fmu, i, got);
        assert_memory_equal(got, start, size);
        assert_int_equal(FreeFMUState(fmu, &kept), fmi3OK);
        assert_int_equal(FreeFMUState(other, &read), fmi3OK);
        assert_null(kept);
        FreeInstance(fmu);
        FreeInstance(other);
    }
}

static void instances_side_by_side_have_the_bits_of_each_alone(void **state)
{
    (void)state;
    static double alone[N_GEARBOXES][MOST], got[MOST];
    for (int i = 0; i < N_GEARBOXES; i++) {
        fmi3Instance fmu = make(i, true);
        begin(fmu);
        steps(fmu, 0, STEPS);
        outputs(fmu, i, alone[i]);
        FreeInstance(fmu);
    }
    fmi3Instance fmus[2 * N_GEARBOXES];
    for (int i = 0; i < 2 * N_GEARBOXES; i++) {
        fmus[i] = make(i % N_GEARBOXES, true);
        begin(fmus[i]);
    }
    for (int k = 0; k < STEPS; k++) {
        for (int i = 0; i < 2 * N_GEARBOXES; i++) {
            steps(fmus[i], k, k + 1);
        }
    }
    for (int i = 0; i < 2 * N_GEARBOXES; i++) {
        outputs(fmus[i], i % N_GEARBOXES, got);
        assert_memory_equal(got, alone[i % N_GEARBOXES], (size_t)gearboxes[i % N_GEARBOXES].n_outputs * sizeof *got);
        FreeInstance(fmus[i]);
    }
}

/* By Heun's steps, so short that contacts are not stiff; events where an indicator changes its sign. */
static void each_case_is_moved_by_its_states_as_by_steps(void **state)
{
    (void)state;
    enum { N = 1000 };
    const double h = 2e-8;
    for (int i = 0; i < N_GEARBOXES; i++) {
        static double own[MOST], expected[MOST], before[MOST], after[MOST];
        double y[MOST_STATES], f[MOST_STATES], g[MOST_STATES], mean[MOST_STATES];
        size_t n, n_indicators;
        bool again = true, event, terminate;
        fmi3Instance fmu = make(i, false), stepped = make(i, true);
        begin(fmu);
        begin(stepped);
        assert_int_equal(GetNumberOfContinuousStates(fmu, &n), fmi3OK);
        assert_int_equal(GetNumberOfEventIndicators(fmu, &n_indicators), fmi3OK);
        assert_in_range(n, 1, MOST_STATES);
        assert_in_range(n_indicators, 1, MOST);
        for (int k = 0; k < 10 && again; k++) {
            assert_int_equal(update(fmu, &again), fmi3OK);
        }
        assert_int_equal(EnterContinuousTimeMode(fmu), fmi3OK);
        assert_int_equal(GetEventIndicators(fmu, before, n_indicators), fmi3OK);
        for (int k = 1; k <= N; k++) {
            assert_int_equal(GetContinuousStates(fmu, y, n), fmi3OK);
            assert_int_equal(GetContinuousStateDerivatives(fmu, f, n), fmi3OK);
            for (size_t j = 0; j < n; j++) {
                mean[j] = y[j] + h * f[j];
            }
            assert_int_equal(SetTime(fmu, k * h), fmi3OK);
            assert_int_equal(SetContinuousStates(fmu, mean, n), fmi3OK);
            assert_int_equal(GetContinuousStateDerivatives(fmu, g, n), fmi3OK);
            for (size_t j = 0; j < n; j++) {
                y[j] += h / 2 * (f[j] + g[j]);
            }
            assert_int_equal(SetContinuousStates(fmu, y, n), fmi3OK);
            assert_int_equal(CompletedIntegratorStep(fmu, true, &event, &terminate), fmi3OK);
            assert_int_equal(GetEventIndicators(fmu, after, n_indicators), fmi3OK);
            for (size_t j = 0; j < n_indicators; j++) {
                event = event || (before[j] > 0) != (after[j] > 0);
            }
            if (event) {
                assert_int_equal(EnterEventMode(fmu), fmi3OK);
                again = true;
                for (int m = 0; m < 10 && again; m++) {
                    assert_int_equal(update(fmu, &again), fmi3OK);
                }
                assert_int_equal(EnterContinuousTimeMode(fmu), fmi3OK);
                assert_int_equal(GetEventIndicators(fmu, after, n_indicators), fmi3OK);
            }
            memcpy(before, after, n_indicators * sizeof *after);
        }
        assert_int_equal(step(stepped, 0, N * h), fmi3OK);
        fmi3ValueReference references[MOST_STATES];
        for (size_t j = 0; j < n; j++) {
            references[j] = fmu_reference(FMU_STATE, (int)j);
        }
        assert_int_equal(GetFloat64(fmu, references, n, own, n), fmi3OK);
        assert_int_equal(GetFloat64(stepped, references, n, expected, n), fmi3OK);
        assert_int_equal(GetNominalsOfContinuousStates(fmu, mean, n), fmi3OK);
        for (size_t j = 0; j < n; j++) {
            assert_true(fabs(own[j] - expected[j]) <= 1e-6 * fmax(mean[j], fabs(expected[j]))); /* O(h^2) */
        }
        FreeInstance(fmu);
        FreeInstance(stepped);
    }
}

/* ---- modes ---- */

/* One call after the other, all with what is right for them where they are allowed. */
static fmi3Status call(int which, fmi3Instance fmu)
{
    static double many[MOST];
    static fmi3FMUState none;
    static const fmi3ValueReference time_of_it[] = {0},
                                    parameter[] = {(fmi3ValueReference)FMU_PARAMETER << FMU_KIND_SHIFT};
    size_t n = 0;
    bool one, two;
    double number = 0;
    (void)GetNumberOfContinuousStates(fmu, &n);
    switch (which) {
    case 0:
        return EnterInitializationMode(fmu, false, 0, 0, false, 0);
    case 1:
        return ExitInitializationMode(fmu);
    case 2:
        return EnterEventMode(fmu);
    case 3:
        return Terminate(fmu);
    case 4:
        return Reset(fmu);
    case 5:
        return EnterConfigurationMode(fmu);
    case 6:
        return ExitConfigurationMode(fmu);
    case 7:
        return GetFloat64(fmu, time_of_it, 1, &number, 1);
    case 8:
        (void)GetFloat64(fmu, parameter, 1, &number, 1);
        return SetFloat64(fmu, parameter, 1, &number, 1);
    case 9:
        return FreeFMUState(fmu, &none);
    case 10:
        return EvaluateDiscreteStates(fmu);
    case 11:
        return update(fmu, &one);
    case 12:
        return EnterContinuousTimeMode(fmu);
    case 13:
        return CompletedIntegratorStep(fmu, true, &one, &two);
    case 14:
        return SetTime(fmu, 0);
    case 15:
        return GetContinuousStates(fmu, many, n) == fmi3OK ? SetContinuousStates(fmu, many, n) : fmi3Error;
    case 16:
        return GetContinuousStateDerivatives(fmu, many, n);
    case 17:
        (void)GetNumberOfEventIndicators(fmu, &n);
        return GetEventIndicators(fmu, many, n);
    case 18:
        return GetContinuousStates(fmu, many, n);
    case 19:
        return GetNominalsOfContinuousStates(fmu, many, n);
    case 20:
        return EnterStepMode(fmu);
    case 21:
        return step(fmu, 0, 1e-4);
    default:
        return SetDebugLogging(fmu, true, 0, NULL);
    }
}

/* Of the state machines of FMI 3.0, 2.3.1, 3.2.1 and 4.2.1. Time and states may be set in event mode, too, as FMI 2.0 has it; a housing
 * of co-simulation has no event mode. */
static void every_call_is_allowed_in_its_modes_and_refused_in_others(void **state)
{
    (void)state;
    static const int allowed[] = {
        INSTANTIATED,
        INITIALIZATION,
        CONTINUOUS,
        EVENT | CONTINUOUS | STEP,
        127,
        INSTANTIATED,
        CONFIGURATION,
        INITIALIZATION | EVENT | CONTINUOUS | STEP | TERMINATED,
        INSTANTIATED | INITIALIZATION,
        127,
        INITIALIZATION | EVENT,
        EVENT,
        EVENT,
        CONTINUOUS,
        EVENT | CONTINUOUS,
        EVENT | CONTINUOUS,
        INITIALIZATION | EVENT | CONTINUOUS | STEP,
        INITIALIZATION | EVENT | CONTINUOUS | STEP,
        INITIALIZATION | EVENT | CONTINUOUS | STEP,
        INITIALIZATION | EVENT | CONTINUOUS | STEP,
        0,
        STEP,
        127,
    };
    for (int which = 0; which < (int)(sizeof allowed / sizeof *allowed); which++) {
        for (int mode = INSTANTIATED; mode <= TERMINATED; mode *= 2) {
            fmi3Instance fmu = in_mode(mode);
            n_logged = 0;
            const fmi3Status status = call(which, fmu), expected = (allowed[which] & mode) != 0 ? fmi3OK : fmi3Error;
            if (status != expected) {
                fail_msg("call %d in mode %d: %d, %s", which, mode, (int)status, logged);
            }
            assert_true(status == fmi3OK || n_logged > 0);
            FreeInstance(fmu);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_case_is_moved_by_steps_and_put_away_and_reset_to_the_same_bits),
        cmocka_unit_test(instances_side_by_side_have_the_bits_of_each_alone),
        cmocka_unit_test(each_case_is_moved_by_its_states_as_by_steps),
        cmocka_unit_test(every_call_is_allowed_in_its_modes_and_refused_in_others)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
