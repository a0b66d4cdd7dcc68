/* A run in memory whose outputs, which wait for each other, show that an event was missed: it is made again without waiting.
 *
 * No case is known that comes to that. So the library's sources are compiled here with a simulation that says so. */
#include <evolvent/evolvent.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "simulate/simulate.h"

static int n_runs, n_misses;

/* What the library calls in place of `simulate`; the macro of that name is for its sources. */
#undef simulate
void simulate(const case_plan *plan, const simulate_sink *sink, const dae_state *start, simulate_result *result);

void simulate_as_told(const case_plan *plan, const simulate_sink *sink, const dae_state *start, simulate_result *result)
{
    simulate(plan, sink, start, result);
    n_runs++;
    if (sink->waits && n_misses > 0) {
        n_misses--;
        result->end = SIMULATE_MISSED;
    }
}

static evolvent_record *run(int misses)
{
    static const char *const set[] = {"meshes.0.tracking=closed_form", "simulation.duration=0.1"};
    evolvent_error error;
    evolvent_case *gearbox = evolvent_case_read("examples/paper-friction.yaml", 2, set, &error);
    assert_non_null(gearbox);
    evolvent_record *record = NULL;
    n_runs = 0;
    n_misses = misses;
    assert_int_equal(evolvent_run(gearbox, NULL, &record, NULL), EVOLVENT_OK);
    evolvent_case_free(gearbox);
    return record;
}

static size_t count_of(const evolvent_variable *variable)
{
    size_t n = 1;
    for (int i = 0; i < variable->rank; i++) {
        n *= variable->lengths[i];
    }
    return n;
}

static void a_run_whose_outputs_show_a_missed_event_is_made_again_and_has_its_rows_once(void **state)
{
    (void)state;
    evolvent_record *plain = run(0);
    assert_int_equal(n_runs, 1);
    evolvent_record *again = run(1);
    assert_int_equal(n_runs, 2);
    int n, m;
    const evolvent_variable *a = evolvent_record_variables(plain, &n), *b = evolvent_record_variables(again, &m);
    assert_int_equal(n, m);
    for (int i = 0; i < n; i++) {
        assert_string_equal(a[i].name, b[i].name);
        assert_int_equal(count_of(&a[i]), count_of(&b[i]));
        if (a[i].type == EVOLVENT_REAL) {
            assert_memory_equal(a[i].values, b[i].values, count_of(&a[i]) * sizeof(double));
        }
    }
    evolvent_record_free(plain);
    evolvent_record_free(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_whose_outputs_show_a_missed_event_is_made_again_and_has_its_rows_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
