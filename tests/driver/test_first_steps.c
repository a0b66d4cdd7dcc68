/* IDA's first steps, on a ball that bounces without loss: between two bounces its height is a parabola, of which a method of order 1
 * sees nothing but the error, a quarter of a h^2 in a step h. */
#include "integrate/integrate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { HEIGHT, SPEED, STATES };

/* Its gravity changes once, at a bounce. */
typedef struct {
    double gravity, gravity_then;
    int changes_at; /* bounce; 0: never */
    int bounces;
    double last_bounce;
    const double *unit; /* [STATES] */
} ball;

static double gravity_of(const dae_state *s)
{
    return s->reals[0];
}

static int residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)self, (void)message;
    r[HEIGHT] = s->yp[HEIGHT] - s->y[SPEED];
    r[SPEED] = s->yp[SPEED] + gravity_of(s);
    return DAE_OK;
}

static int jacobian(const void *self, const dae_state *s, double cj, double *j, char *message)
{
    (void)self, (void)s, (void)message;
    const double columns[STATES * STATES] = {cj, 0, -1, cj};
    memcpy(j, columns, sizeof columns);
    return DAE_OK;
}

static int height(const void *self, const dae_state *s, double *values, char *message)
{
    (void)message;
    values[0] = s->y[HEIGHT] / ((const ball *)self)->unit[HEIGHT];
    return DAE_OK;
}

static void falling_only(const void *self, const int *integers, int *directions)
{
    (void)self, (void)integers;
    directions[0] = -1;
}

static double no_time_event(const void *self, const dae_state *state)
{
    (void)self, (void)state;
    return INFINITY;
}

static int bounce(const void *self, dae_state *s, const int *fired, bool time_event, dae_event *events, int *n,
                  char *message)
{
    (void)fired, (void)time_event, (void)message;
    const ball *b = self;
    s->integers[0]++;
    s->reals[0] = s->integers[0] == b->changes_at ? b->gravity_then : s->reals[0];
    s->y[HEIGHT] = 0;
    s->y[SPEED] = fabs(s->y[SPEED]);
    s->yp[HEIGHT] = s->y[SPEED];
    s->yp[SPEED] = -gravity_of(s);
    events[0] = (dae_event){0};
    *n = 1;
    return DAE_OK;
}

static int on_event(void *self, const event_record *event)
{
    ball *b = self;
    b->bounces++;
    b->last_bounce = event->t;
    return 0;
}

static int on_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

static const double thrown = 1e-4; /* up [m/s] */

/* Until t_end, with a tolerance of 1e-9 units. */
static integrate_counts throw_up(ball *b, double unit, double t_end)
{
    const double scale[STATES] = {unit, thrown};
    double y[STATES] = {0, thrown}, yp[STATES] = {thrown, -b->gravity}, reals[1] = {b->gravity};
    int integers[1] = {0};
    dae_state state = {.y = y, .yp = yp, .integers = integers, .reals = reals};
    const dae model = {.self = b,
                       .n = STATES,
                       .n_integers = 1,
                       .n_reals = 1,
                       .n_roots = 1,
                       .n_events = 1,
                       .scale = scale,
                       .row_scale = scale,
                       .residual = residual,
                       .jacobian = jacobian,
                       .roots = height,
                       .root_directions = falling_only,
                       .next_time_event = no_time_event,
                       .apply_event = bounce};
    const integrate_options options = {.t_end = t_end, .output_interval = t_end, .tolerance = 1e-9, .max_step = 0.1};
    const integrate_observer observer = {.self = b, .event = on_event, .step = on_step};
    integrate_counts counts = {0};
    char reason[DAE_MESSAGE_LENGTH] = "";
    b->unit = scale;
    assert_int_equal(integrate(&model, &options, &observer, &state, &counts, reason), INTEGRATE_DONE);
    return counts;
}

static const double g = 10;
static const double every = 2e-5; /* [s] it bounces */
static const double fine = 1e-9;  /* [m]: a first step may have 6e-10 s */

/* Each would fail four times from 1e-7 s on; there is one failure more, of the step of order 3 behind it. */
static void steps_that_failed_after_one_event_are_not_tried_after_the_next(void **state)
{
    (void)state;
    ball b = {.gravity = g};
    const integrate_counts counts = throw_up(&b, fine, 500.5 * every);
    assert_int_equal(b.bounces, 500);
    assert_true(fabs(b.last_bounce - 500 * every) <
                1e-3 * every); /* each errs by 2e-9 of the height, and the next ones by it, too */
    assert_true(counts.error_test_failures < 1.5 * b.bounces);
}

static void where_events_are_gentle_again_so_are_first_steps(void **state)
{
    (void)state;
    const double gentle = g / 1e6;
    ball calm = {.gravity = gentle}, both = {.gravity = g, .gravity_then = gentle, .changes_at = 10};
    const double span = 20.5e6 * every, before = 10 * every;
    const long always = throw_up(&calm, fine, span).steps;
    const long then = throw_up(&both, fine, before + span).steps;
    const long rough = throw_up(&(ball){.gravity = g}, fine, 0.99 * before).steps;
    assert_int_equal(calm.bounces, 20);
    assert_int_equal(both.bounces, 30);
    /* the first of the gentle ones is left with a step that was learned from another, and each of them has another rounding */
    assert_true(labs(then - rough - always) < 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steps_that_failed_after_one_event_are_not_tried_after_the_next),
        cmocka_unit_test(where_events_are_gentle_again_so_are_first_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
