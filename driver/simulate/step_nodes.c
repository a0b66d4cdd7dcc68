#include "simulate/step_nodes.h"

#include "simulate/each_processor.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

/* Gauss-Legendre: eight nodes where the kernel evaluates eight states together, three where it evaluates them one by
 * one, in the short steps of IDA. */
static const double abscissae_of_8[] = {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290,
                                        -0.1834346424956498, 0.1834346424956498,  0.5255324099163290,
                                        0.7966664774136267,  0.9602898564975363};
static const double weights_of_8[] = {0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620,
                                      0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763};
static const double abscissae_of_3[] = {-0.7745966692414834, 0.0, 0.7745966692414834};
static const double weights_of_3[] = {0.5555555555555556, 0.8888888888888889, 0.5555555555555556};

/** Value at x of the polynomial that is 1 at node k and 0 at the others. */
static double lagrange(int n, const double *x_nodes, int k, double x)
{
    double value = 1;
    for (int j = 0; j < n; j++) {
        value *= j == k ? 1 : (x - x_nodes[j]) / (x_nodes[k] - x_nodes[j]);
    }
    return value;
}

/* ---- evenly spaced points, including the ends: at most STEP_NODES_SAMPLES ---- */

enum { PADDED_SAMPLES = (STEP_NODES_SAMPLES + 7) / 8 * 8 }; /* multiple of the vector length */

static double samples_of_8[8 * PADDED_SAMPLES], samples_of_3[3 * PADDED_SAMPLES];

/** Data of a rule with n nodes. */
typedef struct {
    int n;
    const double *abscissae, *weights;
    double *
        samples; /**< [n * PADDED_SAMPLES] weights of the nodes for the values at the evenly spaced points, node by node */
} node_rule;

static const node_rule rule_of_8 = {8, abscissae_of_8, weights_of_8, samples_of_8};
static const node_rule rule_of_3 = {3, abscissae_of_3, weights_of_3, samples_of_3};

static const node_rule *rule_of(const step_nodes *nodes)
{
    return nodes->n == 8 ? &rule_of_8 : &rule_of_3;
}

static int last_sample(const node_rule *rule)
{
    return 4 * rule->n;
}

static double sample_abscissa(const node_rule *rule, int i)
{
    return -1 + 2.0 * i / last_sample(rule);
}

static void fill_samples(const node_rule *rule)
{
    for (int k = 0; k < rule->n; k++) {
        for (int i = 0; i <= last_sample(rule); i++) {
            rule->samples[k * PADDED_SAMPLES + i] = lagrange(rule->n, rule->abscissae, k, sample_abscissa(rule, i));
        }
    }
}

static pthread_once_t once = PTHREAD_ONCE_INIT;

static void fill_all_samples(void)
{
    fill_samples(&rule_of_8);
    fill_samples(&rule_of_3);
}

FOR_EACH_PROCESSOR static void sample(int n, const double *samples, int sense, const double *values,
                                      double at[PADDED_SAMPLES])
{
    for (int k = 0; k < n; k++) {
        const double value = sense * values[k];
        for (int i = 0; i < PADDED_SAMPLES; i++) {
            at[i] += samples[k * PADDED_SAMPLES + i] * value;
        }
    }
}

/* ---- the nodes ---- */

void step_nodes_init(step_nodes *nodes, const model *model, memory_arena *arena)
{
    const model_facts *about = model_about(model);
    (void)pthread_once(&once, fill_all_samples);
    *nodes = (step_nodes){.model = model, .n = about->dae.stepper != NULL ? 8 : 3};
    nodes->requested = arena_calloc(arena, (size_t)about->n_outputs, sizeof(int));
    nodes->before = arena_calloc(arena, (size_t)about->n_outputs, sizeof(int));
    nodes->y = arena_calloc(arena, (size_t)nodes->n * (size_t)about->dae.n, sizeof(double));
    nodes->one = arena_calloc(arena, (size_t)about->dae.n, sizeof(double));
    nodes->values = arena_calloc(arena, (size_t)nodes->n * (size_t)about->n_values, sizeof(double));
}

void step_nodes_clear(step_nodes *nodes)
{
    model_sampler_delete(&nodes->sampler);
}

int step_nodes_want(step_nodes *nodes, const char *output)
{
    const model_output *found = model_output_named(nodes->model, output);
    if (found == NULL || found->count == 0) {
        return -1;
    }
    const int index = (int)(found - model_about(nodes->model)->outputs);
    for (int i = 0; i < nodes->n_requested; i++) {
        if (nodes->requested[i] == index) {
            return nodes->before[i];
        }
    }
    const int before = nodes->n_values;
    nodes->before[nodes->n_requested] = before;
    nodes->requested[nodes->n_requested++] = index;
    nodes->n_values += found->count;
    return before;
}

double step_nodes_reach(const step_nodes *nodes)
{
    return nodes->n == 8 ? 1.0 : 0.05;
}

/** The states at the nodes. */
static bool find_states(step_nodes *nodes, const integrate_step *step)
{
    const int n_states = model_about(nodes->model)->dae.n;
    if (nodes->n == DAE_LANES && step->interpolate_lanes != NULL) {
        step->interpolate_lanes(step->with, nodes->t, nodes->y);
        return true;
    }
    bool good = true;
    for (int k = 0; k < nodes->n && good; k++) {
        good = step->interpolate(step->with, nodes->t[k], nodes->one);
        for (int i = 0; i < n_states; i++) {
            nodes->y[(size_t)i * (size_t)nodes->n + (size_t)k] = nodes->one[i];
        }
    }
    return good;
}

bool step_nodes_look(step_nodes *nodes, const integrate_step *step, double from, double to)
{
    char message[DAE_MESSAGE_LENGTH];
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    const node_rule *rule = rule_of(nodes);
    for (int k = 0; k < nodes->n; k++) {
        nodes->t[k] = middle + half * rule->abscissae[k];
        nodes->weight[k] = half * rule->weights[k];
    }
    if (nodes->sampler == NULL) {
        nodes->sampler = model_sampler_create(nodes->model, nodes->n_requested, nodes->requested);
    }
    return find_states(nodes, step) && model_sampler_ask(nodes->sampler, nodes->n, nodes->t, nodes->y, step->state,
                                                         nodes->values, message) == DAE_OK;
}

/** Interpolation polynomial at x in -1..1. */
static double value_at(const node_rule *rule, const double *values, double x)
{
    double value = 0;
    for (int k = 0; k < rule->n; k++) {
        value += lagrange(rule->n, rule->abscissae, k, x) * values[k];
    }
    return value;
}

double step_nodes_end(const step_nodes *nodes, const double *values)
{
    const node_rule *rule = rule_of(nodes);
    double end = 0;
    for (int k = 0; k < rule->n; k++) {
        end += rule->samples[k * PADDED_SAMPLES + last_sample(rule)] * values[k];
    }
    return end;
}

double step_nodes_peak(const step_nodes *nodes, const double *values, int sense)
{
    double at[PADDED_SAMPLES] = {0};
    const node_rule *rule = rule_of(nodes);
    const int last = last_sample(rule);
    int i_max = 0;
    sample(rule->n, rule->samples, sense, values, at);
    for (int i = 1; i <= last; i++) {
        i_max = at[i] > at[i_max] ? i : i_max;
    }
    /* the maximum may lie between the first two, or the last two points */
    const int middle = i_max == 0 ? 1 : i_max == last ? last - 1 : i_max;
    const double bend = at[middle - 1] - 2 * at[middle] + at[middle + 1];
    if (!(bend < 0)) {
        return at[i_max];
    }
    const double step = 2.0 / last;
    const double top = sample_abscissa(rule, middle) + 0.5 * step * (at[middle - 1] - at[middle + 1]) / bend;
    return top > -1 && top < 1 ? fmax(at[i_max], sense * value_at(rule, values, top)) : at[i_max];
}
