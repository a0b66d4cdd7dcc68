/* Long chains with IDA: with a sparse matrix they go as with a full one, as closed form says. */
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

/* y_i' = y_(i-1) - 2 y_i + y_(i+1) with ends at 0, and the last state the algebraic sum of all. */
enum { N_CELLS = 80, N = N_CELLS + 1, ROUGH = 3 };

static const double pi = 3.14159265358979323846;

static long n_full, n_sparse; /* how often a Jacobian was asked for */

static int no_roots(const void *self, const dae_state *state, double *values, char *message)
{
    (void)self, (void)state, (void)values, (void)message;
    return DAE_OK;
}

static void no_directions(const void *self, const int *integers, int *directions)
{
    (void)self, (void)integers, (void)directions;
}

static double no_time_event(const void *self, const dae_state *state)
{
    (void)self, (void)state;
    return INFINITY;
}

static int residual(const void *self, const dae_state *s, double *r, char *message)
{
    (void)self, (void)message;
    double sum = 0;
    for (int i = 0; i < N_CELLS; i++) {
        const double left = i > 0 ? s->y[i - 1] : 0, right = i + 1 < N_CELLS ? s->y[i + 1] : 0;
        r[i] = s->yp[i] - (left - 2 * s->y[i] + right);
        sum += s->y[i];
    }
    r[N_CELLS] = s->y[N_CELLS] - sum;
    return DAE_OK;
}

static double entry(int i, int j, double cj)
{
    if (i == N_CELLS) {
        return j == N_CELLS ? 1 : -1;
    }
    if (i == j) {
        return cj + 2;
    }
    return j != N_CELLS && abs(i - j) == 1 ? -1 : 0;
}

static int full_jacobian(const void *self, const dae_state *s, double cj, double *matrix, char *message)
{
    (void)self, (void)s, (void)message;
    n_full++;
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < N; i++) {
            matrix[j * N + i] = entry(i, j, cj);
        }
    }
    return DAE_OK;
}

/* The pattern: its entries, column after column. */
static int walk_entries(double cj, int *rows, int *columns, double *values)
{
    int n = 0;
    for (int j = 0; j < N; j++) {
        for (int i = 0; i < N; i++) {
            const double value = entry(i, j, cj);
            if (fabs(value) > 0) {
                if (rows != NULL) {
                    rows[n] = i;
                    columns[n] = j;
                }
                if (values != NULL) {
                    values[n] = value;
                }
                n++;
            }
        }
    }
    return n;
}

static void *create(const void *self, int *n_entries)
{
    (void)self;
    *n_entries = walk_entries(1, NULL, NULL, NULL);
    return calloc(1, 1);
}

static void indices(const void *pattern, int *rows, int *columns)
{
    (void)pattern;
    (void)walk_entries(1, rows, columns, NULL);
}

static int sparse_jacobian(const void *pattern, const dae_state *s, double cj, double *entries, char *message)
{
    (void)pattern, (void)s, (void)message;
    n_sparse++;
    (void)walk_entries(cj, NULL, NULL, entries);
    return DAE_OK;
}

static int ignore_output(void *self, const dae_state *state, const output_mark *mark, char *reason)
{
    (void)self, (void)state, (void)mark, (void)reason;
    return 0;
}

static int ignore_step(void *self, double t)
{
    (void)self, (void)t;
    return 0;
}

static double shape(int i)
{
    return sin(ROUGH * pi * (i + 1) / (N_CELLS + 1));
}

static double decay(void)
{
    const double s = sin(ROUGH * pi / (2 * (N_CELLS + 1)));
    return 4 * s * s;
}

/* The end of a motion that is one mode, which decays. */
static integrate_counts run(const dae_pattern *pattern, double *y)
{
    double scale[N], row_scale[N], yp[N], reals[1] = {0};
    int integers[1] = {0};
    char reason[DAE_MESSAGE_LENGTH];
    y[N_CELLS] = yp[N_CELLS] = 0;
    for (int i = 0; i < N_CELLS; i++) {
        y[i] = shape(i);
        yp[i] = -decay() * y[i];
        y[N_CELLS] += y[i];
        yp[N_CELLS] += yp[i];
    }
    for (int i = 0; i < N; i++) { /* units of different size for states and rows */
        scale[i] = 1 + 0.5 * (i % 3);
        row_scale[i] = 2 + i % 5;
    }
    const dae model = {.n = N,
                       .n_integers = 1,
                       .n_reals = 1,
                       .n_events = 1,
                       .scale = scale,
                       .row_scale = row_scale,
                       .residual = residual,
                       .jacobian = full_jacobian,
                       .roots = no_roots,
                       .root_directions = no_directions,
                       .next_time_event = no_time_event,
                       .pattern = pattern};
    const integrate_options options = {.t_end = 50, .output_interval = 50, .tolerance = 1e-9, .max_step = 5};
    const integrate_observer observer = {.output = ignore_output, .step = ignore_step};
    dae_state state = {.y = y, .yp = yp, .integers = integers, .reals = reals};
    integrate_counts counts = {0};
    n_full = n_sparse = 0;
    assert_int_equal(integrate(&model, &options, &observer, &state, &counts, reason), INTEGRATE_DONE);
    return counts;
}

static void assert_decayed(const double *y)
{
    const double left = exp(-50 * decay());
    for (int i = 0; i < N_CELLS; i++) {
        assert_true(fabs(y[i] - left * shape(i)) <= 1e-7); /* a hundred times the tolerance of a step */
    }
}

static const dae_pattern chain = {.create = create, .destroy = free, .indices = indices, .jacobian = sparse_jacobian};

static void a_sparse_matrix_gives_what_a_full_one_gives(void **state)
{
    (void)state;
    double full[N], sparse[N];
    const integrate_counts full_counts = run(NULL, full);
    assert_true(n_full > 0 && n_sparse == 0);
    const integrate_counts sparse_counts = run(&chain, sparse);
    assert_decayed(full);
    assert_decayed(sparse);
    for (int i = 0; i < N; i++) {
        assert_true(fabs(full[i] - sparse[i]) <= 1e-12 * (1 + fabs(full[i]))); /* rounding of the solutions */
    }
    assert_int_equal(full_counts.steps, sparse_counts.steps);
}

static void the_version_says_which_matrices_there_are(void **state)
{
    (void)state;
    double y[N];
    (void)run(&chain, y);
    const bool has_klu = strstr(integrate_version(), " with KLU") != NULL;
    assert_int_equal(has_klu, n_sparse > 0);
    assert_int_equal(!has_klu, n_full > 0);
}

static void *create_nothing(const void *self, int *n_entries)
{
    (void)self;
    *n_entries = 0;
    return NULL;
}

static void a_model_all_of_whose_entries_count_has_a_full_matrix(void **state)
{
    (void)state;
    static const dae_pattern nothing = {.create = create_nothing};
    double y[N];
    (void)run(&nothing, y);
    assert_decayed(y);
    assert_true(n_full > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sparse_matrix_gives_what_a_full_one_gives),
        cmocka_unit_test(the_version_says_which_matrices_there_are),
        cmocka_unit_test(a_model_all_of_whose_entries_count_has_a_full_matrix),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
