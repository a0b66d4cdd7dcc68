#include "simulate/mesh_metrics.h"

#include <math.h>

/** How a period is added to a total, or a part of a step to a period. */
#define SUM(a, b) ((a) + (b))
#define HIGHEST(a, b) fmax(a, b)
#define LOWER_END(a, b) (is_new ? (b) : fmin(a, b))
#define UPPER_END(a, b) (is_new ? (b) : fmax(a, b))

/** A part of a step. */
typedef struct {
    const step_nodes *nodes;
    const double *speed; /**< of the driving wheel of the mesh, at the nodes [rad/s] */
    double time;         /**< [s] */
} mesh_part;

/* ---- sums; `x` is an output at the nodes ---- */

static void add_torque(mesh_metrics *mesh, const mesh_part *part, const double *x)
{
    double work = 0, energy = 0;
    for (int k = 0; k < part->nodes->n; k++) {
        work += part->nodes->weight[k] * x[k];
        energy += part->nodes->weight[k] * fabs(x[k] * part->speed[k]);
    }
    mesh->period.torque += work;
    mesh->period.energy += energy;
}

static void add_pairs(mesh_metrics *mesh, const mesh_part *part, const double *x)
{
    mesh_sums *sums = &mesh->period;
    double *const shares[] = {&sums->no_contact, &sums->one_pair, &sums->two_pairs, &sums->more_pairs};
    bool is_one = true; /* the usual case, unless pairs lose their force without an event of their own */
    for (int k = 1; k < part->nodes->n; k++) {
        is_one = is_one && !(fabs(x[k] - x[0]) > 0);
    }
    for (int k = 0; k < (is_one ? 1 : part->nodes->n); k++) {
        const int touching = (int)(x[k] + 0.5);
        *shares[touching > 3 ? 3 : touching] += is_one ? part->time : part->nodes->weight[k];
    }
}

static void add_coast(mesh_metrics *mesh, const mesh_part *part, const double *x)
{
    double time = 0;
    for (int k = 0; k < part->nodes->n; k++) {
        time += isnan(x[k]) ? NAN : x[k] > 0 ? part->nodes->weight[k] : 0; /* NaN: no coast flanks */
    }
    mesh->period.coast += time;
}

static void add_friction(mesh_metrics *mesh, const mesh_part *part, const double *x)
{
    double energy = 0;
    for (int k = 0; k < part->nodes->n; k++) {
        energy += part->nodes->weight[k] * x[k];
    }
    mesh->period.friction += energy;
}

static void add_pair_force(mesh_metrics *mesh, const mesh_part *part, const double *x)
{
    double *largest = &mesh->period.pair_force;
    if (step_nodes_range(part->nodes, x).may_reach > fmax(*largest, mesh->total.pair_force)) {
        *largest = fmax(*largest, step_nodes_peak(part->nodes, x, 1));
    }
}

static const struct {
    const char *output;
    bool is_of_pairs;
    void (*add)(mesh_metrics *mesh, const mesh_part *part, const double *x);
} at_nodes[N_AT_MESH] = {
#define OUTPUT(key, ...) {__VA_ARGS__},
    MESH_OUTPUTS(OUTPUT)
#undef OUTPUT
};

void mesh_metrics_request(unsigned needs, step_nodes *nodes, mesh_indices *indices)
{
    for (int i = 0; i < N_AT_MESH; i++) {
        const bool is_requested = at_nodes[i].add == NULL || (needs >> i & 1) != 0;
        indices->at[i] = is_requested ? step_nodes_want(nodes, at_nodes[i].output) : -1;
    }
}

bool mesh_metrics_available(const mesh_indices *indices, unsigned needs)
{
    bool have = true;
    for (int i = 0; i < N_AT_MESH; i++) {
        have = have && ((needs >> i & 1) == 0 || indices->at[i] >= 0);
    }
    return have;
}

void mesh_metrics_add(mesh_metrics *mesh, int m, int n_pairs, const mesh_indices *indices, const step_nodes *nodes,
                      metric_waves *waves)
{
    mesh_sums *sums = &mesh->period;
    const double *angle = step_nodes_value(nodes, indices->at[AT_ANGLE] + mesh->wheel);
    mesh_part part = {.nodes = nodes, .speed = step_nodes_value(nodes, indices->at[AT_SPEED] + mesh->wheel)};
    double xi[STEP_NODES_MOST], rate[STEP_NODES_MOST], pitches = 0, first = INFINITY, last = -INFINITY;
    for (int k = 0; k < nodes->n; k++) {
        xi[k] = mesh->xi_0 + mesh->per_turn * angle[k];
        rate[k] = mesh->per_turn * part.speed[k];
        first = xi[k] < first ? xi[k] : first;
        last = xi[k] > last ? xi[k] : last;
        part.time += nodes->weight[k];
        pitches += nodes->weight[k] * rate[k];
    }
    const bool is_new = !(sums->time > 0);
    sums->first = LOWER_END(sums->first, first);
    sums->last = UPPER_END(sums->last, last);
    sums->time += part.time;
    sums->pitches += pitches;
    for (int i = 0; i < N_AT_MESH; i++) {
        const int n = at_nodes[i].add == NULL || indices->at[i] < 0 ? 0 : at_nodes[i].is_of_pairs ? n_pairs : 1;
        for (int k = 0; k < n; k++) {
            at_nodes[i].add(mesh, &part, step_nodes_value(nodes, indices->at[i] + m * n + k));
        }
    }
    metric_waves_find(waves, nodes->n, xi, rate);
}

void mesh_metrics_impact(mesh_metrics *mesh, double t, double speed)
{
    if (mesh->period.impacts + mesh->total.impacts > 0 && !(t > mesh->t_impact)) {
        return;
    }
    mesh->t_impact = t;
    mesh->period.impacts++;
    mesh->period.impact_speed = fmax(mesh->period.impact_speed, speed);
    mesh->period.impact_energy += 0.5 * mesh->mass * speed * speed;
}

void mesh_metrics_complete(mesh_metrics *mesh)
{
    mesh_sums *total = &mesh->total;
    const mesh_sums *period = &mesh->period;
    const bool is_new = !(total->time > 0);
#define ACCUMULATOR(type, name, join) total->name = join(total->name, period->name);
    MESH_ACCUMULATORS(ACCUMULATOR)
#undef ACCUMULATOR
    mesh->period = (mesh_sums){0};
}

static_span mesh_metrics_span(const mesh_metrics *mesh)
{
    static const double margin = 2; /* coast flanks have a separate start of contact, and a loaded mesh lags */
    const mesh_sums *sums = &mesh->total;
    return (static_span){sums->first - margin, sums->last + margin,
                         -sums->torque / sums->time * (mesh->per_turn > 0 ? 1 : -1)};
}
