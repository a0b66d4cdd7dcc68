/* Outputs by position: which positions a known motion passes, and when. */
#include "integrate/integrate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_ROWS = 4000 };

/* What the observer heard. */
typedef struct {
    int n;
    double t[MOST_ROWS], position[MOST_ROWS];
    output_mark mark[MOST_ROWS];
    int complaints; /* so many outputs are answered by INTEGRATE_ANEW, each other one */
} record;

static int on_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    record *r = self;
    assert_non_null(mark);
    if (state->t > 0 && r->complaints > 0 && r->complaints-- % 2 == 0) {
        (void)snprintf(reason, DAE_MESSAGE_LENGTH, "an event was missed");
        return INTEGRATE_ANEW;
    }
    assert_true(r->n < MOST_ROWS);
    r->t[r->n] = state->t;
    r->position[r->n] = state->y[0];
    r->mark[r->n++] = *mark;
    return 0;
}

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

/* ---- a motion that is known, told in steps of a stepper ---- */

typedef struct {
    double (*position)(double t, double size);
    double size, step;          /* of the motion; the longest step */
    double t_from, t_to, stops; /* of the last step; it may be shorter after a step was made anew */
} motion;

static void *create(const void *self, double tolerance, double max_step, char *message)
{
    (void)tolerance, (void)max_step, (void)message;
    motion *m = malloc(sizeof *m);
    assert_non_null(m);
    memcpy(m, self, sizeof *m);
    return m;
}

static int start(void *stepper, const dae_state *state, char *message)
{
    (void)message;
    ((motion *)stepper)->t_to = state->t;
    return DAE_OK;
}

static int advance(void *stepper, double t_stop, dae_state *state, int *fired, dae_outcome *outcome, char *message)
{
    (void)fired, (void)message;
    motion *m = stepper;
    m->t_from = m->t_to;
    m->t_to = fmin(m->t_from + m->step, t_stop);
    *outcome = m->t_to >= t_stop ? DAE_AT_STOP : DAE_STEPPED;
    state->t = m->t_to;
    state->y[0] = m->position(m->t_to, m->size);
    return DAE_OK;
}

static bool interpolate(const void *stepper, double t, double *y)
{
    const motion *m = stepper;
    assert_true(t >= m->t_from && t <= m->t_to);
    y[0] = m->position(t, m->size);
    return true;
}

static void redo(void *stepper, dae_state *state)
{
    motion *m = stepper;
    m->t_to = state->t = m->t_from;
    m->step *= 0.3;
    state->y[0] = m->position(m->t_to, m->size);
}

static void restart(void *stepper, const dae_state *state)
{
    (void)stepper, (void)state;
}

static void count_nothing(const void *stepper, integrate_counts *counts)
{
    (void)stepper, (void)counts;
}

static double no_time_event(const void *self, const dae_state *state)
{
    (void)self, (void)state;
    return INFINITY;
}

static double first_state(const void *self, int which, const dae_state *state)
{
    (void)self;
    assert_int_equal(which, 5);
    return state->y[0];
}

static record *follow(double (*position)(double, double), double size, double step, int per_unit, int complaints)
{
    static const dae_stepper stepper = {.create = create,
                                        .destroy = free,
                                        .start = start,
                                        .advance = advance,
                                        .interpolate = interpolate,
                                        .restart = restart,
                                        .redo = redo,
                                        .counts = count_nothing};
    const double one = 1;
    const motion motion = {.position = position, .size = size, .step = step};
    const dae model = {.self = &motion,
                       .n = 1,
                       .n_roots = 0,
                       .scale = &one,
                       .row_scale = &one,
                       .next_time_event = no_time_event,
                       .position = first_state,
                       .stepper = &stepper};
    const integrate_options options = {.t_end = 1, .per_unit = per_unit, .position_of = 5, .by_stepper = true};
    record *heard = calloc(1, sizeof *heard);
    assert_non_null(heard);
    heard->complaints = complaints;
    const integrate_observer observer = {.self = heard, .output = on_output, .step = on_step};
    dae_state state = dae_state_create(&model, NULL);
    state.y[0] = position(0, size);
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    assert_int_equal(integrate(&model, &options, &observer, &state, &counts, reason), INTEGRATE_DONE);
    dae_state_free(&state);
    return heard;
}

static void assert_close(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
    }
}

/* What holds of any motion: start and end are there once, times rise, rows are on the grid to 1e-9 of its steps, and from each
 * to the next the motion passes no other line. */
static void assert_is_complete(const record *heard, int per_unit)
{
    double line = NAN;
    assert_true(heard->n >= 2 && heard->t[0] == 0 && heard->t[heard->n - 1] == 1);
    for (int i = 0; i < heard->n; i++) {
        const output_mark *mark = &heard->mark[i];
        const double u = mark->position * per_unit;
        assert_true(i == 0 || heard->t[i] > heard->t[i - 1]);
        assert_close(mark->position, heard->position[i], 1e-9 / per_unit + 1e-15 * fabs(heard->position[i]));
        if (mark->kind == OUTPUT_OFF_GRID) {
            assert_true(i == 0 || i == heard->n - 1);
            line = i == 0 ? NAN : line;
            continue;
        }
        assert_close(u, round(u), 1e-12 * fabs(u));
        if (!isnan(line) && i < heard->n - 1) {
            const double moved = round(u) - line;
            assert_true(fabs(moved) <= 1 && (moved >= 0 || mark->kind == OUTPUT_BACKWARDS) &&
                        (moved <= 0 || mark->kind == OUTPUT_FORWARDS));
        }
        line = round(u);
    }
}

/* ---- motions ---- */

static const double pi = 3.14159265358979323846;

/* Chebyshev's polynomial of the largest degree that a step may have: it turns six times in the run. */
static double turning(double t, double size)
{
    return size * cos(DAE_DENSE_DEGREE * acos(2 * t - 1));
}

static double steady(double t, double size)
{
    return 0.1 + size * t;
}

static double back(double t, double size)
{
    return -size * t;
}

/* Stands on a line but for rounding. */
static double standing(double t, double size)
{
    return size + 1e-13 * sin(1e7 * t);
}

static double creeping(double t, double size)
{
    return size * (t - t * t);
}

/* ---- tests ---- */

static void every_position_of_a_motion_that_turns_is_found_when_it_is_passed(void **state)
{
    (void)state;
    static const double sizes[] = {0.6, 1.3, 3.7, 17.2}, steps[] = {1, 0.21, 0.013};
    for (int i = 0; i < 12; i++) {
        const double size = sizes[i % 4], step = steps[i / 4];
        record *heard = follow(turning, size, step, 2, 0);
        assert_is_complete(heard, 2);
        /* each of the seven branches passes every line between -size and size */
        const int lines = 2 * (int)floor(2 * size) + 1;
        assert_int_equal(heard->n, 2 + DAE_DENSE_DEGREE * lines);
        for (int k = 1; k < heard->n - 1; k++) {
            const int branch = (k - 1) / lines, at = (k - 1) % lines; /* the first one rises */
            const double line = (branch % 2 == 0 ? at - lines / 2 : lines / 2 - at) / 2.0;
            const double angle = acos(line / size), phase = branch % 2 == 0 ? pi - angle : angle;
            assert_true(heard->mark[k].position == line);
            assert_int_equal(heard->mark[k].kind, branch % 2 == 0 ? OUTPUT_FORWARDS : OUTPUT_BACKWARDS);
            /* where the motion is slow, 1e-9 of the grid takes some time */
            assert_close(heard->t[k], 0.5 - 0.5 * cos((phase + branch * pi) / DAE_DENSE_DEGREE), 1e-8);
        }
        free(heard);
    }
}

static void a_line_that_a_motion_touches_is_one_output(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        record *heard = follow(turning, 3, i == 0 ? 1 : 0.037, 1, 0);
        assert_is_complete(heard, 1);
        /* from -3 to 3 and back three and a half times: the ends of all branches are shared, and those of the run are on the grid */
        assert_int_equal(heard->n, 7 * 6 + 1);
        assert_int_equal(heard->mark[0].kind, OUTPUT_FORWARDS);
        assert_int_equal(heard->mark[heard->n - 1].kind, OUTPUT_FORWARDS);
        free(heard);
    }
}

static void a_steady_motion_passes_each_position_once_however_long_its_steps(void **state)
{
    (void)state;
    static const double steps[] = {1, 0.3, 1e-3};
    for (int i = 0; i < 3; i++) {
        record *heard = follow(steady, 12.345, steps[i], 100, 0);
        assert_is_complete(heard, 100);
        assert_int_equal(heard->n, 1 + 1234 + 1); /* 0.1 at the start, which is on the grid; 12.445 at the end */
        assert_int_equal(heard->mark[0].kind, OUTPUT_FORWARDS);
        assert_int_equal(heard->mark[heard->n - 1].kind, OUTPUT_OFF_GRID);
        for (int k = 0; k < heard->n - 1; k++) {
            assert_close(heard->t[k], k / 1234.5, 1e-14);
            assert_int_equal(heard->mark[k].kind, OUTPUT_FORWARDS);
        }
        free(heard);
    }
}

static void a_motion_backwards_has_the_start_and_positions_that_say_so(void **state)
{
    (void)state;
    record *heard = follow(back, 3.5, 0.11, 2, 0);
    assert_is_complete(heard, 2);
    assert_int_equal(heard->n, 8); /* 0, -0.5, ..., -3.5; the last one is the end, on the grid */
    for (int k = 1; k < 7; k++) {
        assert_int_equal(heard->mark[k].kind, OUTPUT_BACKWARDS);
    }
    assert_int_equal(heard->mark[7].kind, OUTPUT_FORWARDS);
    free(heard);
}

static void what_stands_on_a_line_gives_start_and_end_only(void **state)
{
    (void)state;
    static const double positions[] = {0, 7, -3, 0.25};
    for (int i = 0; i < 4; i++) {
        record *heard = follow(standing, positions[i], 0.003, 1, 0);
        assert_int_equal(heard->n, 2);
        assert_int_equal(heard->mark[1].kind, i < 3 ? OUTPUT_FORWARDS : OUTPUT_OFF_GRID);
        free(heard);
    }
    record *heard = follow(creeping, 0.9, 1, 4, 0); /* to 0.225 and back */
    assert_int_equal(heard->n, 2);
    free(heard);
}

static void steps_made_anew_repeat_no_output(void **state)
{
    (void)state;
    record *once = follow(turning, 3.5, 0.31, 3, 0);
    for (int complaints = 2; complaints < 20; complaints++) {
        record *heard = follow(turning, 3.5, 0.31, 3, complaints);
        assert_is_complete(heard, 3);
        assert_int_equal(heard->n, once->n);
        for (int k = 0; k < heard->n; k++) {
            assert_close(heard->t[k], once->t[k], 1e-9);
            assert_true(heard->mark[k].kind == once->mark[k].kind);
        }
        free(heard);
    }
    free(once);
}

/* ---- by IDA: a wheel that swings, y0'' = -w^2 y0 ---- */

static const double w = 7;

static int residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)self, (void)message;
    r[0] = s->yp[0] - s->y[1];
    r[1] = s->yp[1] + w * w * s->y[0];
    return DAE_OK;
}

static int jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)self, (void)s, (void)message;
    const double columns[4] = {cj, w * w, -1, cj};
    memcpy(j, columns, sizeof columns);
    return DAE_OK;
}

static int roots(const void *self, const dae_state *s, double *values, char *message)
{
    (void)self, (void)message;
    values[0] = s->y[0];
    return DAE_OK;
}

static void root_directions(const void *self, const int *integers, int *directions)
{
    (void)self, (void)integers;
    directions[0] = 1;
}

static int apply_event(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events,
                       int *n_events, char *message)
{
    (void)self, (void)s, (void)fired, (void)time_event, (void)events, (void)message;
    *n_events = 0;
    return DAE_OK;
}

/* Of who watches no channel. */
static int roots_and_nothing(const void *self, const dae_state *s, const double *highest, double *cached,
                             double *values, double *monitored, char *message)
{
    (void)highest, (void)cached, (void)monitored;
    return roots(self, s, values, message);
}

static void watch_nothing(void *self, const integrate_step *step)
{
    (void)self, (void)step;
}

static void swing(bool is_monitored)
{
    const double scale[2] = {1, 1};
    const dae model = {.n = 2,
                       .n_roots = 1, /* half a turn of the swing each: it is started anew there */
                       .n_events = 1,
                       .scale = scale,
                       .row_scale = scale,
                       .residual = residual,
                       .jacobian = jacobian,
                       .roots = roots,
                       .roots_and_monitored = roots_and_nothing,
                       .root_directions = root_directions,
                       .next_time_event = no_time_event,
                       .apply_event = apply_event,
                       .position = first_state};
    const integrate_options options = {
        .t_end = 1, .per_unit = 4, .position_of = 5, .tolerance = 1e-10, .max_step = 0.1};
    record *heard = calloc(1, sizeof *heard);
    assert_non_null(heard);
    const integrate_observer observer = {
        .self = heard, .output = on_output, .step = on_step, .monitor = is_monitored ? watch_nothing : NULL};
    dae_state at = dae_state_create(&model, NULL);
    at.y[0] = 1.3;
    at.yp[1] = -w * w * 1.3;
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    assert_int_equal(integrate(&model, &options, &observer, &at, &counts, reason), INTEGRATE_DONE);
    assert_is_complete(heard, 4);
    /* start and end; two half swings of 11 lines each, and two more until 1.3 cos 7 = 0.98 */
    assert_int_equal(heard->n, 2 + 2 * 11 + 2);
    for (int k = 1; k < heard->n - 1; k++) {
        const int swing = (k - 1) / 11;
        const double angle = acos(heard->mark[k].position / 1.3);
        assert_int_equal(heard->mark[k].kind, swing % 2 == 0 ? OUTPUT_BACKWARDS : OUTPUT_FORWARDS);
        /* the tolerance, added up; slowest at 1.25 */
        assert_close(heard->t[k], (swing % 2 == 0 ? swing * pi + angle : (swing + 1) * pi - angle) / w, 1e-7);
    }
    dae_state_free(&at);
    free(heard);
}

static void ida_finds_the_positions_between_its_steps(void **state)
{
    (void)state;
    swing(false);
}

/* Who watches is told which steps go on, and steps that go on are passed over where no position is near. */
static void who_watches_takes_no_position_away(void **state)
{
    (void)state;
    swing(true);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_position_of_a_motion_that_turns_is_found_when_it_is_passed),
        cmocka_unit_test(a_line_that_a_motion_touches_is_one_output),
        cmocka_unit_test(a_steady_motion_passes_each_position_once_however_long_its_steps),
        cmocka_unit_test(a_motion_backwards_has_the_start_and_positions_that_say_so),
        cmocka_unit_test(what_stands_on_a_line_gives_start_and_end_only),
        cmocka_unit_test(steps_made_anew_repeat_no_output),
        cmocka_unit_test(ida_finds_the_positions_between_its_steps),
        cmocka_unit_test(who_watches_takes_no_position_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
