/* The integrator on problems without gears, whose solutions are known. */
#include "integrate/integrate.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST_ROWS = 4000, MOST_EVENTS = 400, MOST_COPIES = 17, MOST_STATES = 3 * MOST_COPIES };

/* What the observer heard. */
typedef struct {
    int n_states, n_rows, n_events, n_steps;
    double t[MOST_ROWS], y[MOST_ROWS][MOST_STATES];
    struct {
        double t, before[MOST_STATES], after[MOST_STATES];
        dae_event what;
    } events[MOST_EVENTS];
    int stop_at_row, stop_at_event, stop_at_step; /* -1: never */
    void (*meanwhile)(void);                      /* done at every output */
    double complaints;                            /* of events that were missed */
} record;

static int on_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    (void)mark;
    record *r = self;
    /* from 0.5 on it is content after so many complaints */
    if (state->t > 0.5 && r->complaints > 0) {
        r->complaints--;
        (void)snprintf(reason, DAE_MESSAGE_LENGTH, "an event was missed");
        return INTEGRATE_ANEW;
    }
    assert_true(r->n_rows < MOST_ROWS);
    r->t[r->n_rows] = state->t;
    memcpy(r->y[r->n_rows], state->y, (size_t)r->n_states * sizeof(double));
    if (r->meanwhile) {
        r->meanwhile();
    }
    return r->n_rows++ == r->stop_at_row;
}

static int on_event(void *self, const event_record *event)
{
    record *r = self;
    if (r->n_events == MOST_EVENTS) { /* of a model that chatters; enough is known */
        return 0;
    }
    assert_true(event->t == event->after->t && event->t == event->before->t);
    r->events[r->n_events].t = event->t;
    r->events[r->n_events].what = event->what;
    memcpy(r->events[r->n_events].before, event->before->y, (size_t)event->n * sizeof(double));
    memcpy(r->events[r->n_events].after, event->after->y, (size_t)event->n * sizeof(double));
    return r->n_events++ == r->stop_at_event;
}

static int on_step(void *self, double t)
{
    (void)t;
    record *r = self;
    return r->n_steps++ == r->stop_at_step;
}

/* A problem with its state; what its procedures count is in `calls`. */
typedef struct {
    dae model;
    double scale[MOST_STATES], row_scale[MOST_STATES];
    struct {
        long residuals, jacobians;
    } *calls;
    double parameter;
    dae_state state;
    double y[MOST_STATES], yp[MOST_STATES], reals[1];
    int integers[1];
} problem;

typedef struct {
    integrate_code code;
    integrate_counts counts;
    char reason[DAE_MESSAGE_LENGTH];
    record *heard;
} outcome;

static int no_roots(const void *self, const dae_state *state, double *values, char *message)
{
    (void)self, (void)state, (void)message;
    values[0] = 1;
    return DAE_OK;
}

static void no_directions(const void *self, const int *integers, int *directions)
{
    (void)self, (void)integers;
    directions[0] = 0;
}

static double no_time_event(const void *self, const dae_state *state)
{
    (void)self, (void)state;
    return INFINITY;
}

static problem *make(int n)
{
    problem *p = calloc(1, sizeof *p);
    assert_non_null(p);
    p->calls = calloc(1, sizeof *p->calls);
    assert_non_null(p->calls);
    for (int i = 0; i < MOST_STATES; i++) {
        p->scale[i] = p->row_scale[i] = 1;
    }
    p->state = (dae_state){.y = p->y, .yp = p->yp, .integers = p->integers, .reals = p->reals};
    p->model = (dae){.self = p,
                     .n = n,
                     .n_integers = 1,
                     .n_reals = 1,
                     .n_roots = 1,
                     .n_events = 4,
                     .scale = p->scale,
                     .row_scale = p->row_scale,
                     .roots = no_roots,
                     .root_directions = no_directions,
                     .next_time_event = no_time_event};
    return p;
}

static record *listen(void)
{
    record *heard = calloc(1, sizeof *heard);
    assert_non_null(heard);
    heard->stop_at_row = heard->stop_at_event = heard->stop_at_step = -1;
    return heard;
}

static outcome solve_for(record *heard, problem *p, double t_end, double interval, double tolerance)
{
    outcome result = {.heard = heard};
    heard->n_states = p->model.n;
    const integrate_options options = {
        .t_end = t_end, .output_interval = interval, .tolerance = tolerance, .max_step = 0.1};
    const integrate_observer observer = {.self = heard, .output = on_output, .event = on_event, .step = on_step};
    result.code = integrate(&p->model, &options, &observer, &p->state, &result.counts, result.reason);
    return result;
}

static outcome solve(problem *p, double t_end, double interval, double tolerance)
{
    return solve_for(listen(), p, t_end, interval, tolerance);
}

static void finish(problem *p, outcome *result)
{
    free(result->heard);
    free(p->calls);
    free(p);
}

static void assert_close(double value, double expected, double tolerance)
{
    if (!(fabs(value - expected) <= tolerance)) {
        fail_msg("%.17g is not %.17g within %g", value, expected, tolerance);
    }
}

/* ---- oscillator: y0' = y1, y1' = -w^2 y0, and the algebraic y2 = y0 + y1 ---- */

static const double w = 7.0;

static int oscillator_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)message;
    ((const problem *)self)->calls->residuals++;
    r[0] = s->yp[0] - s->y[1];
    r[1] = s->yp[1] + w * w * s->y[0];
    r[2] = s->y[2] - s->y[0] - s->y[1];
    return DAE_OK;
}

static int oscillator_jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)s, (void)message;
    ((const problem *)self)->calls->jacobians++;
    const double columns[9] = {cj, w * w, -1, -1, cj, -1, 0, 0, 1};
    memcpy(j, columns, sizeof columns);
    return DAE_OK;
}

static problem *make_oscillator(double amplitude)
{
    problem *p = make(3);
    p->model.residual = oscillator_residual;
    p->model.jacobian = oscillator_jacobian;
    p->y[0] = p->y[2] = amplitude;
    p->yp[1] = p->yp[2] = -w * w * amplitude;
    return p;
}

static void an_oscillation_is_followed_within_the_tolerance_between_the_steps_too(void **state)
{
    (void)state;
    static const double tolerances[] = {1e-6, 1e-8, 1e-10};
    for (int k = 0; k < 3; k++) {
        const double tolerance = tolerances[k];
        problem *p = make_oscillator(1);
        outcome result = solve(p, 5.0, 0.0013, tolerance);
        assert_int_equal(result.code, INTEGRATE_DONE);
        for (int i = 0; i < result.heard->n_rows; i++) {
            const double t = result.heard->t[i], *y = result.heard->y[i];
            /* errors add up over 5.6 periods and hundreds of steps: a few hundred times the tolerance */
            assert_close(y[0], cos(w * t), 1000 * tolerance);
            assert_close(y[1], -w * sin(w * t), 1000 * w * tolerance);
            assert_close(y[2], y[0] + y[1], 1000 * w * tolerance);
        }
        assert_close(p->state.y[0], cos(w * 5), 1000 * tolerance);
        assert_true(p->state.t == 5.0);
        finish(p, &result);
    }
}

static void outputs_come_at_the_grid_and_at_the_end_once_and_in_order(void **state)
{
    (void)state;
    static const struct {
        double t_start, t_end, interval;
        int rows;
    } grids[] = {
        {0, 1, 0.25, 5},
        {0, 1, 0.3, 5},
        {0, 0.3, 0.1, 4},
        {0, 1, 5, 2},
        {2, 3, 0.1, 11},
        {0, 2, 1e-3, 2001},
        {-1, 1, 0.5, 5},
        {0, 0.7, 0.1, 8},
        /* the last of the grid is rounded to just before the end, or falls short of it by 1e-8 of an interval */
        {0, 1, 1.0 / 49, 50},
        {0, 1 + 1e-9, 0.1, 11}};
    assert_true(49 * (1.0 / 49) < 1);
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++) {
        problem *p = make_oscillator(1);
        p->state.t = grids[g].t_start;
        outcome result = solve(p, grids[g].t_end, grids[g].interval, 1e-7);
        const record *heard = result.heard;
        assert_int_equal(result.code, INTEGRATE_DONE);
        assert_int_equal(heard->n_rows, grids[g].rows);
        for (int i = 0; i < heard->n_rows - 1; i++) {
            assert_close(heard->t[i], grids[g].t_start + i * grids[g].interval, 1e-15 * fabs(grids[g].t_end));
            assert_true(heard->t[i + 1] > heard->t[i]);
        }
        assert_true(heard->t[heard->n_rows - 1] == grids[g].t_end);
        finish(p, &result);
    }
}

static void the_same_problem_twice_gives_the_same_bits(void **state)
{
    (void)state;
    problem *p = make_oscillator(1), *q = make_oscillator(1);
    outcome one = solve(p, 2.0, 0.01, 1e-8), two = solve(q, 2.0, 0.01, 1e-8);
    assert_memory_equal(one.heard->y, two.heard->y, sizeof one.heard->y);
    assert_int_equal(one.counts.steps, two.counts.steps);
    finish(p, &one);
    finish(q, &two);
}

static void only_scaled_states_matter(void **state)
{
    (void)state;
    /* powers of two: the same bits but for the exponent */
    const double unit = ldexp(1, -30);
    problem *p = make_oscillator(1), *q = make_oscillator(unit);
    for (int i = 0; i < 3; i++) {
        q->scale[i] = q->row_scale[i] = unit;
    }
    outcome one = solve(p, 2.0, 0.01, 1e-8), two = solve(q, 2.0, 0.01, 1e-8);
    assert_int_equal(one.heard->n_rows, two.heard->n_rows);
    for (int i = 0; i < one.heard->n_rows; i++) {
        for (int k = 0; k < 3; k++) {
            assert_true(two.heard->y[i][k] == unit * one.heard->y[i][k]);
        }
    }
    finish(p, &one);
    finish(q, &two);
}

static void integrate_another(void)
{
    problem *p = make_oscillator(3);
    outcome result = solve(p, 0.05, 0.01, 1e-7);
    assert_int_equal(result.code, INTEGRATE_DONE);
    finish(p, &result);
}

static void an_integration_within_another_leaves_it_alone(void **state)
{
    (void)state;
    problem *p = make_oscillator(1), *q = make_oscillator(1);
    outcome one = solve(p, 1.0, 0.01, 1e-8);
    record *heard = listen();
    heard->meanwhile = integrate_another;
    outcome two = solve_for(heard, q, 1.0, 0.01, 1e-8);
    assert_int_equal(two.code, INTEGRATE_DONE);
    assert_memory_equal(one.heard->y, two.heard->y, sizeof heard->y);
    assert_memory_equal(p->y, q->y, sizeof p->y);
    finish(p, &one);
    finish(q, &two);
}

static void an_observer_ends_the_integration_where_it_is(void **state)
{
    (void)state;
    for (int k = 0; k < 3; k++) {
        problem *p = make_oscillator(1);
        record *heard = listen();
        heard->stop_at_row = k == 0 ? 0 : k == 1 ? 4 : -1; /* the start; a grid point; a step */
        heard->stop_at_step = k == 2 ? 2 : -1;
        outcome result = solve_for(heard, p, 1.0, 0.1, 1e-8);
        assert_int_equal(result.code, INTEGRATE_STOPPED);
        assert_true(p->state.t < 0.6);
        assert_close(p->state.y[0], cos(w * p->state.t), 1e-5);
        if (k < 2) {
            assert_int_equal(heard->n_rows, k == 0 ? 1 : 5);
            assert_close(p->state.t, k == 0 ? 0 : 0.4, 1e-15);
        }
        finish(p, &result);
    }
}

/* ---- roots of an oscillation, counted in one direction ---- */

static int oscillator_roots(const void *self, const dae_state *s, double *values, char *message)
{
    (void)self, (void)message;
    values[0] = s->y[0];
    return DAE_OK;
}

static void rising_only(const void *self, const int *integers, int *directions)
{
    (void)integers;
    directions[0] = ((const problem *)self)->parameter > 0 ? 1 : -1;
}

static int note_only(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                     char *message)
{
    (void)self, (void)s, (void)message;
    assert_true(fired[0] != 0 || time_event);
    events[0] = (dae_event){.kind = 3, .subject = 1, .side = -1, .count = 4};
    *n = 1;
    return DAE_OK;
}

enum { MANY = 40 };

static int note_many(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                     char *message)
{
    (void)self, (void)s, (void)fired, (void)time_event, (void)message;
    for (*n = 0; *n < MANY; (*n)++) {
        events[*n] = (dae_event){.kind = *n, .subject = -1, .side = -1, .count = -1};
    }
    return DAE_OK;
}

static void all_events_of_one_instant_are_heard_in_their_order(void **state)
{
    (void)state;
    problem *p = make_oscillator(1);
    p->model.roots = oscillator_roots;
    p->model.root_directions = rising_only;
    p->model.apply_event = note_many;
    p->model.n_events = MANY;
    p->parameter = 1;
    outcome result = solve(p, 1.0, 0.1, 1e-9);
    assert_int_equal(result.code, INTEGRATE_DONE);
    assert_int_equal(result.heard->n_events, MANY); /* cos(7 t) rises through zero once, at 3 pi/14 */
    for (int i = 0; i < MANY; i++) {
        assert_int_equal(result.heard->events[i].what.kind, i);
        assert_true(result.heard->events[i].t == result.heard->events[0].t);
    }
    finish(p, &result);
}

static void roots_count_in_their_direction_only(void **state)
{
    (void)state;
    for (int direction = -1; direction <= 1; direction += 2) {
        problem *p = make_oscillator(1);
        p->model.roots = oscillator_roots;
        p->model.root_directions = rising_only;
        p->model.apply_event = note_only;
        p->parameter = direction;
        outcome result = solve(p, 5.0, 0.1, 1e-11);
        assert_int_equal(result.code, INTEGRATE_DONE);
        /* cos falls through zero at (1/2 + 2k) pi/w, rises at (3/2 + 2k) pi/w; 35/(2 pi) = 5.6 periods */
        assert_int_equal(result.heard->n_events, direction < 0 ? 6 : 5);
        for (int i = 0; i < result.heard->n_events; i++) {
            const double expected = (2 * i + (direction < 0 ? 0.5 : 1.5)) * acos(-1) / w;
            assert_close(result.heard->events[i].t, expected, 1e-9);
            assert_int_equal(result.heard->events[i].what.kind, 3);
            assert_int_equal(result.heard->events[i].what.subject, 1);
            assert_int_equal(result.heard->events[i].what.count, 4);
        }
        finish(p, &result);
    }
}

/* ---- a clock, and who hears its outputs finds fault with them ---- */

static int clock_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)message;
    ((const problem *)self)->calls->residuals++;
    r[0] = s->yp[0] - 1;
    return DAE_OK;
}

static int clock_jacobian(const void *self, const dae_state *s, double cj, double *jacobian, char *message)
{
    (void)s, (void)message;
    ((const problem *)self)->calls->jacobians++;
    jacobian[0] = cj;
    return DAE_OK;
}

static outcome solve_clock(problem **clock, double complaints)
{
    problem *p = *clock = make(1);
    p->model.residual = clock_residual;
    p->model.jacobian = clock_jacobian;
    p->yp[0] = 1;
    record *heard = listen();
    heard->complaints = complaints;
    return solve_for(heard, p, 1.0, 0.05, 1e-6);
}

static void an_output_that_shows_a_missed_event_has_its_step_made_anew(void **state)
{
    (void)state;
    problem *p;
    outcome content = solve_clock(&p, 0);
    const long steps = content.counts.steps;
    finish(p, &content);
    outcome result = solve_clock(&p, 3);
    assert_int_equal(result.code, INTEGRATE_DONE);
    assert_string_equal(result.reason, "");
    assert_true(result.counts.steps > steps + 3);
    assert_int_equal(result.heard->n_rows, 21); /* each output once, in order */
    for (int i = 0; i < result.heard->n_rows; i++) {
        assert_close(result.heard->t[i], 0.05 * i, 1e-15);
        assert_close(result.heard->y[i][0], 0.05 * i, 1e-9);
    }
    finish(p, &result);
}

static void a_state_that_never_agrees_ends_the_run_before_it_with_the_models_words(void **state)
{
    (void)state;
    problem *p;
    outcome result = solve_clock(&p, INFINITY);
    assert_int_equal(result.code, INTEGRATE_FAILED);
    assert_string_equal(result.reason, "an event was missed");
    assert_true(p->state.t < 0.55); /* the outputs up to there are given, and no later state */
    assert_int_equal(result.heard->n_rows, 11);
    finish(p, &result);
}

/* ---- a ball that bounces: y0 its height, y1 its speed; each bounce keeps a part of it ---- */

static const double gravity = 9.81, kept = 0.8;

static int ball_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)message;
    ((const problem *)self)->calls->residuals++;
    r[0] = s->yp[0] - s->y[1];
    r[1] = s->yp[1] + gravity;
    return DAE_OK;
}

static int ball_jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)s, (void)message;
    ((const problem *)self)->calls->jacobians++;
    const double columns[4] = {cj, 0, -1, cj};
    memcpy(j, columns, sizeof columns);
    return DAE_OK;
}

static void falling_only(const void *self, const int *integers, int *directions)
{
    (void)self, (void)integers;
    directions[0] = -1;
}

static int bounce(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                  char *message)
{
    (void)self, (void)message;
    assert_true(fired[0] != 0);
    assert_false(time_event);
    s->y[0] = 0;
    s->y[1] *= -kept;
    s->yp[0] = s->y[1];
    s->yp[1] = -gravity;
    s->integers[0]++;
    s->reals[0] = s->y[1];
    events[0] = (dae_event){.kind = 0, .subject = -1, .side = -1, .count = s->integers[0]};
    *n = 1;
    return DAE_OK;
}

static problem *make_ball(void)
{
    problem *p = make(2);
    p->model.residual = ball_residual;
    p->model.jacobian = ball_jacobian;
    p->model.roots = oscillator_roots;
    p->model.root_directions = falling_only;
    p->model.apply_event = bounce;
    p->y[0] = 1;
    p->yp[1] = -gravity;
    return p;
}

static void bounces_are_found_where_they_are(void **state)
{
    (void)state;
    problem *p = make_ball();
    outcome result = solve(p, 3.0, 0.01, 1e-11);
    assert_int_equal(result.code, INTEGRATE_DONE);
    double t = sqrt(2 / gravity), v = sqrt(2 * gravity);
    int n = 0;
    for (; t < 3.0; n++) {
        assert_true(n < result.heard->n_events);
        assert_close(result.heard->events[n].t, t, 1e-9);
        assert_int_equal(result.heard->events[n].what.count, n + 1);
        assert_close(result.heard->events[n].before[0], 0, 1e-9);
        assert_close(result.heard->events[n].before[1], -v, 1e-8);
        assert_true(result.heard->events[n].after[1] == -kept * result.heard->events[n].before[1]);
        v *= kept;
        t += 2 * v / gravity;
    }
    assert_int_equal(result.heard->n_events, n);
    assert_int_equal(result.counts.events, n);
    assert_int_equal(p->state.integers[0], n);
    assert_true(p->state.reals[0] == result.heard->events[n - 1].after[1]);
    /* between the bounces the height is a parabola, also on the grid points next to a bounce */
    for (int i = 0, k = 0; i < result.heard->n_rows; i++) {
        while (k < n && result.heard->events[k].t < result.heard->t[i]) {
            k++;
        }
        const double since = result.heard->t[i] - (k == 0 ? 0 : result.heard->events[k - 1].t);
        const double speed = k == 0 ? 0 : result.heard->events[k - 1].after[1];
        const double height = k == 0 ? 1 : 0;
        assert_close(result.heard->y[i][0], height + since * (speed - gravity * since / 2), 1e-9);
    }
    finish(p, &result);
}

static void counts_add_up_over_all_restarts(void **state)
{
    (void)state;
    problem *p = make_ball();
    outcome result = solve(p, 3.0, 0.1, 1e-8);
    assert_int_equal(result.code, INTEGRATE_DONE);
    assert_true(result.heard->n_events > 5);
    assert_int_equal(result.counts.residuals, p->calls->residuals);
    assert_int_equal(result.counts.jacobians, p->calls->jacobians);
    assert_true(result.counts.steps >= result.counts.events);
    assert_true(result.counts.newton_iterations >= result.counts.steps);
    assert_true(result.counts.linear_setups >= result.counts.events); /* each restart sets its matrix up */
    assert_true(result.counts.roots_evaluated > result.counts.steps);
    assert_true(result.counts.cpu_seconds >= 0);
    finish(p, &result);
}

static void an_observer_may_stop_at_an_event(void **state)
{
    (void)state;
    problem *p = make_ball();
    record *heard = listen();
    heard->stop_at_event = 1;
    outcome result = solve_for(heard, p, 3.0, 0.1, 1e-9);
    assert_int_equal(result.code, INTEGRATE_STOPPED);
    assert_int_equal(heard->n_events, 2);
    assert_true(p->state.t == heard->events[1].t);
    assert_true(p->state.y[1] == heard->events[1].after[1]);
    assert_int_equal(result.counts.events, 2);
    finish(p, &result);
}

/* ---- a slope that changes at given times, where the value jumps: y' = integers[0]. Some of the times are within rounding
 * of the grid, of each other or of the end. ---- */

static const double knots[] = {0.1, 0.3, 0.3 + 1e-12, 0.5, 0.9999999999999999};
enum { N_KNOTS = sizeof knots / sizeof *knots };

static int slope_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)self, (void)message;
    r[0] = s->yp[0] - s->integers[0];
    return DAE_OK;
}

static int slope_jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)self, (void)s, (void)message;
    j[0] = cj;
    return DAE_OK;
}

static double next_knot(const void *self, const dae_state *s)
{
    (void)self;
    return s->integers[0] < N_KNOTS ? knots[s->integers[0]] : INFINITY;
}

static int pass_knot(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                     char *message)
{
    (void)self, (void)fired, (void)message;
    assert_true(time_event);
    s->integers[0]++;
    s->y[0] += 10;
    s->yp[0] = s->integers[0];
    events[0] = (dae_event){.kind = 8, .subject = -1, .side = -1, .count = -1};
    *n = 1;
    return DAE_OK;
}

static void time_events_are_hit_exactly_and_outputs_there_show_the_state_before(void **state)
{
    (void)state;
    problem *p = make(1);
    p->model.residual = slope_residual;
    p->model.jacobian = slope_jacobian;
    p->model.next_time_event = next_knot;
    p->model.apply_event = pass_knot;
    outcome result = solve(p, 1.0, 0.1, 1e-10);
    assert_int_equal(result.code, INTEGRATE_DONE);
    assert_int_equal(result.heard->n_events, N_KNOTS);
    double y = 0;
    for (int k = 0; k < N_KNOTS; k++) {
        y += 10 * (k > 0) + k * (knots[k] - (k == 0 ? 0 : knots[k - 1]));
        assert_true(result.heard->events[k].t == knots[k]);
        assert_close(result.heard->events[k].before[0], y, 1e-8);
        assert_close(result.heard->events[k].after[0], y + 10, 1e-8);
    }
    assert_int_equal(result.heard->n_rows, 11);
    assert_close(result.heard->y[1][0], 0, 1e-8);                                 /* at 0.1, where y jumps */
    assert_close(result.heard->y[2][0], 10.1, 1e-8);                              /* at 0.2 */
    assert_close(result.heard->y[5][0], result.heard->events[3].before[0], 1e-8); /* at 0.5 */
    assert_close(p->state.y[0], y + 10 + 5 * (1 - knots[4]), 1e-8);
    finish(p, &result);
}

/* ---- problems that end badly ---- */

static int limited_residual(const void *self, const dae_state *s, double *r, char *message)
{
    const problem *p = self;
    if (s->y[0] > 1) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "y = %.6g exceeds the limit 1", s->y[0]);
        return p->parameter > 0 ? DAE_FATAL : DAE_RECOVERABLE;
    }
    r[0] = s->yp[0] - 1;
    return DAE_OK;
}

static void a_model_that_has_no_answer_ends_the_run_with_its_own_words(void **state)
{
    (void)state;
    for (int fatal = 0; fatal <= 1; fatal++) {
        problem *p = make(1);
        p->model.residual = limited_residual;
        p->model.jacobian = slope_jacobian;
        p->parameter = fatal;
        p->yp[0] = 1;
        outcome result = solve(p, 3.0, 0.01, 1e-9);
        assert_int_equal(result.code, INTEGRATE_FAILED);
        assert_non_null(strstr(result.reason, "exceeds the limit 1"));
        /* the last good state, and the outputs up to there */
        assert_true(p->state.y[0] <= 1);
        assert_close(p->state.y[0], p->state.t, 1e-8);
        assert_true(p->state.t > (fatal ? 0.8 : 1 - 1e-6)); /* a fatal one lies within a step of at most 0.1 s */
        assert_true(result.heard->n_rows >= 80);
        assert_true(result.heard->t[result.heard->n_rows - 1] <= p->state.t);
        assert_true(result.counts.steps > 0);
        finish(p, &result);
    }
}

static int hopeless_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)self, (void)message;
    r[0] = s->yp[0] - 1 / ((1 - s->t) * (1 - s->t)); /* a pole at t = 1 */
    return DAE_OK;
}

static void a_solution_that_runs_away_ends_the_run_with_the_integrators_words(void **state)
{
    (void)state;
    static const dae_stepper never_asked = {0};
    for (int has_stepper = 0; has_stepper < 2; has_stepper++) {
        problem *p = make(1);
        p->model.residual = hopeless_residual;
        p->model.jacobian = slope_jacobian;
        p->model.stepper = has_stepper ? &never_asked : NULL;
        p->yp[0] = 1;
        outcome result = solve(p, 2.0, 0.01, 1e-9);
        assert_int_equal(result.code, INTEGRATE_FAILED);
        assert_non_null(strstr(result.reason, "cannot continue (IDA_"));
        /* what the model has not is no remedy */
        assert_int_equal(strstr(result.reason, "radau") != NULL, has_stepper);
        assert_close(p->state.t, 1, 1e-2);
        finish(p, &result);
    }
}

static double from_then_on(const void *self, const dae_state *s)
{
    (void)self;
    return s->t < 0.5 ? 0.5 : s->t; /* then there is always another event now */
}

static void events_without_end_at_one_time_are_refused(void **state)
{
    (void)state;
    problem *p = make_oscillator(1);
    p->model.next_time_event = from_then_on;
    p->model.apply_event = note_only;
    outcome result = solve(p, 1.0, 0.1, 1e-8);
    assert_int_equal(result.code, INTEGRATE_FAILED);
    assert_non_null(strstr(result.reason, "chatters"));
    assert_true(p->state.t == 0.5);
    finish(p, &result);
}

static int refuse_event(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                        char *message)
{
    (void)self, (void)fired, (void)time_event, (void)events;
    s->y[0] = -99;
    *n = 0;
    (void)snprintf(message, DAE_MESSAGE_LENGTH, "no rebound from a hole");
    return DAE_FATAL;
}

static void an_event_that_the_model_refuses_ends_the_run_before_it(void **state)
{
    (void)state;
    problem *p = make_ball();
    p->model.apply_event = refuse_event;
    outcome result = solve(p, 3.0, 0.1, 1e-9);
    assert_int_equal(result.code, INTEGRATE_FAILED);
    assert_string_equal(result.reason, "no rebound from a hole");
    assert_close(p->state.t, sqrt(2 / gravity), 1e-7);
    assert_close(p->state.y[0], 0, 1e-7);
    finish(p, &result);
}

/* ---- two places far away, and the force of a stiff spring between them: a' = A cos t, b' = (A - 1) cos t, F = k (a - b) ---- */

static const double away = 1e6, stiff = 1e3;

static int spring_residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)message;
    for (int i = 0; i < ((const problem *)self)->model.n; i += 3) {
        r[i] = s->yp[i] - away * cos(s->t);
        r[i + 1] = s->yp[i + 1] - (away - 1) * cos(s->t);
        r[i + 2] = s->y[i + 2] - stiff * (s->y[i] - s->y[i + 1]);
    }
    return DAE_OK;
}

static int spring_jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)s, (void)message;
    const int n = ((const problem *)self)->model.n;
    memset(j, 0, (size_t)(n * n) * sizeof *j);
    for (int i = 0; i < n; i += 3) {
        j[i * n + i] = j[(i + 1) * n + i + 1] = cj;
        j[i * n + i + 2] = -stiff;
        j[(i + 1) * n + i + 2] = stiff;
        j[(i + 2) * n + i + 2] = 1;
    }
    return DAE_OK;
}

enum { SPRING_ENTRIES = 5 };

static void *spring_pattern(const void *self, int *n_entries)
{
    const problem *p = self;
    *n_entries = SPRING_ENTRIES * (p->model.n / 3);
    int *n = malloc(sizeof *n);
    assert_non_null(n);
    *n = p->model.n;
    return n;
}

static void spring_indices(const void *pattern, int *rows, int *columns)
{
    static const int row[SPRING_ENTRIES] = {0, 2, 1, 2, 2}, column[SPRING_ENTRIES] = {0, 0, 1, 1, 2};
    for (int i = 0, k = 0; i < *(const int *)pattern; i += 3)
        for (int e = 0; e < SPRING_ENTRIES; e++, k++) {
            rows[k] = i + row[e];
            columns[k] = i + column[e];
        }
}

static int spring_entries(const void *pattern, const dae_state *s, double cj, double *entries, char *message)
{
    (void)s, (void)message;
    const double each[SPRING_ENTRIES] = {cj, -stiff, cj, stiff, 1};
    for (int i = 0; i < *(const int *)pattern / 3; i++)
        memcpy(entries + i * SPRING_ENTRIES, each, sizeof each);
    return DAE_OK;
}

/* Alone, and with others beside it by a full and by a sparse matrix. */
static void a_tolerance_below_rounding_asks_for_no_more_than_that(void **state)
{
    (void)state;
    static const dae_pattern pattern = {spring_pattern, free, spring_indices, spring_entries};
    static const struct {
        int copies;
        const dae_pattern *pattern;
    } kinds[] = {{1, NULL}, {MOST_COPIES, NULL}, {MOST_COPIES, &pattern}};
    for (int k = 0; k < 3; k++) {
        problem *p = make(3 * kinds[k].copies);
        p->model.residual = spring_residual;
        p->model.jacobian = spring_jacobian;
        p->model.pattern = kinds[k].pattern;
        for (int i = 0; i < p->model.n; i += 3) {
            p->yp[i] = away;
            p->yp[i + 1] = away - 1;
            p->yp[i + 2] = stiff;
        }
        record *heard = listen();
        heard->stop_at_step = 60; /* of outputs and thousands of steps: a minute was not enough once */
        outcome result = solve_for(heard, p, 3.0, 0.1, 1e-9);
        assert_int_equal(result.code, INTEGRATE_DONE);
        for (int i = 0; i < result.heard->n_rows; i++) {
            const double t = result.heard->t[i], rounding = stiff * away * DBL_EPSILON;
            for (int j = 2; j < p->model.n; j += 3)
                assert_close(result.heard->y[i][j], stiff * sin(t), 100 * rounding);
        }
        assert_true(result.counts.steps <
                    10000); /* seen: 1056 alone; a step of order 5 is some thousandths for 1e-15 of a place */
        finish(p, &result);
    }
}

static void the_library_tells_its_version(void **state)
{
    (void)state;
    int major = 0;
    assert_int_equal(sscanf(integrate_version(), "SUNDIALS %d.", &major), 1);
    assert_true(major >= 6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_oscillation_is_followed_within_the_tolerance_between_the_steps_too),
        cmocka_unit_test(outputs_come_at_the_grid_and_at_the_end_once_and_in_order),
        cmocka_unit_test(the_same_problem_twice_gives_the_same_bits),
        cmocka_unit_test(only_scaled_states_matter),
        cmocka_unit_test(an_integration_within_another_leaves_it_alone),
        cmocka_unit_test(an_observer_ends_the_integration_where_it_is),
        cmocka_unit_test(all_events_of_one_instant_are_heard_in_their_order),
        cmocka_unit_test(roots_count_in_their_direction_only),
        cmocka_unit_test(bounces_are_found_where_they_are),
        cmocka_unit_test(counts_add_up_over_all_restarts),
        cmocka_unit_test(an_observer_may_stop_at_an_event),
        cmocka_unit_test(time_events_are_hit_exactly_and_outputs_there_show_the_state_before),
        cmocka_unit_test(a_model_that_has_no_answer_ends_the_run_with_its_own_words),
        cmocka_unit_test(a_solution_that_runs_away_ends_the_run_with_the_integrators_words),
        cmocka_unit_test(events_without_end_at_one_time_are_refused),
        cmocka_unit_test(an_event_that_the_model_refuses_ends_the_run_before_it),
        cmocka_unit_test(an_output_that_shows_a_missed_event_has_its_step_made_anew),
        cmocka_unit_test(a_state_that_never_agrees_ends_the_run_before_it_with_the_models_words),
        cmocka_unit_test(a_tolerance_below_rounding_asks_for_no_more_than_that),
        cmocka_unit_test(the_library_tells_its_version),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
