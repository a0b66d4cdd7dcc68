/* A simulation whose outputs wait for each other gives those of one whose outputs do not, and says if they show a missed event. */
#include "base/memory.h"
#include "simulate/prepare.h"
#include "simulate/simulate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { MOST = 400, N_NAMES = 4 };
static const char *const names[N_NAMES] = {"kinetic_energy", "normal_force", "gap", "angular_velocity"};

typedef struct {
    prepared_case prepared;
    dae_state start;
} fixture;

/* What a sink hears. */
typedef struct {
    memory_pool pool;
    wanted_outputs wanted;
    int places[N_NAMES];
    int n, n_blocks, n_events;
    double t[MOST], values[MOST][N_NAMES];
    double t_event;
} heard;

static bool on_outputs(void *self, const output_block *block)
{
    heard *h = self;
    h->n_blocks++;
    for (int k = 0; k < block->n; k++, h->n++) {
        assert_true(h->n < MOST);
        assert_true(block->t[k] >= h->t_event); /* those before an event come before it */
        h->t[h->n] = block->t[k];
        for (int i = 0; i < N_NAMES; i++) {
            h->values[h->n][i] = output_values(block, h->places[i])[k];
        }
    }
    return true;
}

static bool on_event(void *self, const event_record *record)
{
    heard *h = self;
    h->n_events++;
    h->t_event = record->t;
    assert_true(h->t[h->n - 1] <= record->t);
    return true;
}

static void hear(const fixture *f, bool all, bool waits, heard *h, simulate_result *result)
{
    const dae *dae = &model_about(f->prepared.model)->dae;
    *h = (heard){.n = 0};
    wanted_init(&h->wanted, f->prepared.model, all, &h->pool);
    for (int i = 0; i < N_NAMES; i++) {
        h->places[i] = wanted_add(&h->wanted, names[i]);
    }
    dae_state state = dae_state_create(dae, &h->pool);
    dae_state_copy(dae, &state, &f->start);
    const simulate_sink sink = {
        .self = h, .wanted = &h->wanted, .waits = waits, .outputs = on_outputs, .event = on_event};
    simulate(&f->prepared, &sink, &state, result);
    pool_free(&h->pool);
}

static int set_up(void **state)
{
    static const char *const set[] = {"meshes.0.tracking=closed_form",
                                      "simulation={duration: 1.6, output_interval: 0.01, tolerance: 1e-5}"};
    fixture *f = xcalloc(1, sizeof *f);
    evl_error error;
    assert_true(prepare_case(&f->prepared, "examples/paper-friction.yaml", 2, set, &error));
    assert_true(prepare_start(&f->prepared, &f->start, &error));
    *state = f;
    return 0;
}

static int tear_down(void **state)
{
    fixture *f = *state;
    prepared_case_free(&f->prepared);
    dae_state_free(&f->start);
    free(f);
    return 0;
}

static void outputs_that_wait_are_those_that_do_not(void **state)
{
    static heard alone, waiting;
    simulate_result result;
    hear(*state, true, false, &alone, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_int_equal(alone.n_blocks, alone.n);
    hear(*state, false, true, &waiting, &result);
    assert_int_equal(result.end, SIMULATE_DONE);
    assert_int_equal(waiting.n, 161);
    assert_int_equal(waiting.n, alone.n);
    assert_int_equal(waiting.n_events, alone.n_events);
    assert_true(waiting.n_events > 0 && waiting.n_blocks < waiting.n / 4);
    for (int k = 0; k < waiting.n; k++) {
        assert_true(waiting.t[k] == alone.t[k]);
        for (int i = 0; i < N_NAMES;
             i++) { /* states interpolated at once differ by rounding, times a stiffness of 1e9 N/m */
            const double value = alone.values[k][i], near = 1e-7 * fabs(value) + 1e-15;
            assert_true(fabs(waiting.values[k][i] - value) <= near);
        }
    }
}

/* At the start the teeth press on each other; then they are a millimetre apart and count as pressed. */
static void outputs_that_show_a_missed_event_are_wanted_one_by_one(void **state)
{
    static heard h;
    fixture *f = *state;
    simulate_result result;
    OWNED model_state *states = model_states(f->prepared.model);
    for (int i = 0; i < model_about(f->prepared.model)->dae.n; i++) {
        f->start.y[i] += strncmp(states[i].name, "angle_deviation", 15) == 0 ? 1e-3 : 0.0;
    }
    hear(f, false, true, &h, &result);
    assert_int_equal(result.end, SIMULATE_MISSED);
    assert_int_equal(h.n, 0);
    hear(f, false, false, &h, &result);
    assert_int_equal(result.end, SIMULATE_FAILED);
    assert_non_null(strstr(result.message, "an event was missed"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(outputs_that_wait_are_those_that_do_not, set_up, tear_down),
        cmocka_unit_test_setup_teardown(outputs_that_show_a_missed_event_are_wanted_one_by_one, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
