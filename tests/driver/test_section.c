/* The section goes out of the way of events, and is reached once a common period. */
#include "respond/section.h"
#include "simulate/case_plan.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const char speed[] = "wheels.pinion.loads.0={kind: speed, value: -157}";
static const char torque[] = "wheels.gear.loads.0={kind: torque, value: -90}";

typedef struct {
    memory_arena arena;
    case_plan plan;
    model_period period;
    dae_state state;
    section section;
    double pitch; /* [s] */
} fixture;

static int set_up(void **state)
{
    static fixture f;
    const char *const set[] = {speed, torque};
    evl_error error;
    model_message refusal;
    memset(&f, 0, sizeof f);
    assert_true(
        case_plan_make(&f.plan, &(plan_request){.name = "examples/spur-pair.yaml", .n_set = 2, .set = set}, &error));
    assert_true(model_find_period(f.plan.model, &f.period, &refusal));
    assert_true(f.period.by_time);
    f.state = dae_state_create(&model_about(f.plan.model)->dae, &f.arena);
    f.pitch = f.period.time / f.period.pitches;
    section_begin(&f.section, &f.arena, f.plan.model, &f.period, SECTION_USUAL_PHASE, &f.state);
    *state = &f;
    return 0;
}

static int tear_down(void **state)
{
    fixture *f = *state;
    case_plan_free(&f->plan);
    arena_free(&f->arena);
    return 0;
}

static void happen(fixture *f, double position)
{
    f->state.t = position * f->pitch;
    const event_record record = {.t = f->state.t, .before = &f->state, .after = &f->state};
    section_event(&f->section, &record);
}

static void test_period_of_a_pair_is_a_pitch(void **state)
{
    const fixture *f = *state;
    const double pi = 3.14159265358979323846;
    assert_int_equal(f->period.pitches, 1);
    assert_true(fabs(f->period.time - 2 * pi / (19 * 157)) < 1e-15); /* a rounding of 2e-3 s is 4e-19 s */
}

static void test_it_stays_where_events_are_far(void **state)
{
    fixture *f = *state;
    assert_true(fabs(f->section.target - 0.5) <= 0);
    happen(f, 0.1);
    happen(f, 0.7);
    section_passed(&f->section);
    happen(f, 0.5 + 2e-6);
    assert_false(section_moves(&f->section));
    assert_true(fabs(f->section.target - 1.5) <= 0);
}

static void test_it_moves_to_the_middle_of_the_longest_way_between_events(void **state)
{
    fixture *f = *state;
    happen(f, 0.1);
    happen(f, 0.2);
    section_passed(&f->section); /* at 0.5 */
    happen(f, 0.5 + 5e-7);
    assert_true(section_moves(&f->section));
    /* from 0.5 to 1.1 it is longest */
    assert_true(fabs(f->section.phase - 0.8) < 1e-6);
    assert_true(fabs(f->section.target - 0.8) < 1e-6);
    assert_false(section_moves(&f->section)); /* once */
}

static void test_an_event_before_the_section_counts_as_one_behind(void **state)
{
    fixture *f = *state;
    happen(f, 0.5 - 5e-7);
    section_passed(&f->section);
    happen(f, 0.9);
    assert_true(section_moves(&f->section));
    assert_true(fabs(f->section.phase - 0.2) < 1e-6);
    assert_true(fabs(f->section.target - 1.2) < 1e-6); /* behind where the motion is */
}

static void test_events_of_two_periods_count_by_their_places_in_one(void **state)
{
    fixture *f = *state;
    section_passed(&f->section); /* at 0.5 */
    happen(f, 0.6);
    happen(f, 1.0);
    happen(f, 1.5 - 5e-7);
    section_passed(&f->section);
    happen(f, 2.45);
    assert_true(section_moves(&f->section));
    /* 0, 0.45, 0.5 and 0.6: from 0 to 0.45 it is longest */
    assert_true(fabs(f->section.phase - 0.225) < 1e-6);
    assert_true(fabs(f->section.target - 3.225) < 1e-6);
}

static void test_it_gives_up_where_events_are_everywhere(void **state)
{
    fixture *f = *state;
    int n = 0;
    bool moves = true;
    while (moves && n < 1000) {
        section_passed(&f->section);
        happen(f, f->section.here);
        moves = section_moves(&f->section);
        n += moves;
    }
    assert_int_equal(n, 32);
    assert_false(f->section.is_crossed);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_period_of_a_pair_is_a_pitch, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_it_stays_where_events_are_far, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_it_moves_to_the_middle_of_the_longest_way_between_events, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(test_an_event_before_the_section_counts_as_one_behind, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_events_of_two_periods_count_by_their_places_in_one, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_it_gives_up_where_events_are_everywhere, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
