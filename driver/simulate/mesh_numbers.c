#include "simulate/mesh_numbers.h"

#include "model/model_static.h"

#include <math.h>

/* ---- what is asked ---- */

const char *mesh_output(at_mesh what)
{
    static const char *const names[N_AT_MESH] = {
        [AT_ANGLE] = "angle",       [AT_SPEED] = "angular_velocity",     [AT_PAIRS] = "pairs_in_contact",
        [AT_COAST] = "coast_force", [AT_TORQUE] = "mesh_torque_driving", [AT_PAIR_FORCE] = "pair_normal_force",
    };
    return names[what];
}

static bool takes(const bool *taken, number_of_contact first, number_of_contact last)
{
    bool any = false;
    for (int i = (int)first; i <= (int)last; i++) {
        any = any || taken[number_row_of_contact((number_of_contact)i)];
    }
    return any;
}

void mesh_numbers_want(const bool *taken, step_nodes *nodes, mesh_places *places)
{
    const bool is_wanted[N_AT_MESH] = {
        [AT_ANGLE] = true,
        [AT_SPEED] = true,
        [AT_PAIRS] = takes(taken, NUMBER_NO_CONTACT, NUMBER_MORE_PAIRS),
        [AT_COAST] = takes(taken, NUMBER_COAST, NUMBER_COAST),
        [AT_TORQUE] =
            takes(taken, NUMBER_ENERGY, NUMBER_RATTLE) || takes(taken, NUMBER_PAIR_DYNAMIC, NUMBER_PAIR_DYNAMIC),
        [AT_PAIR_FORCE] = takes(taken, NUMBER_PAIR_FORCE, NUMBER_PAIR_DYNAMIC),
    };
    for (int i = 0; i < N_AT_MESH; i++) {
        places->at[i] = is_wanted[i] ? step_nodes_want(nodes, mesh_output((at_mesh)i)) : -1;
    }
}

static bool is_asked(const mesh_places *places, at_mesh what)
{
    return places->at[what] >= 0;
}

static const double *at_nodes(const mesh_places *places, at_mesh what, int index, const step_nodes *nodes)
{
    return step_nodes_value(nodes, places->at[what] + index);
}

/* ---- sums ---- */

/** The mesh was between two positions. */
static void add_range(mesh_sums *sums, double first, double last)
{
    const bool is_new = !(sums->time > 0);
    sums->first = is_new ? first : fmin(sums->first, first);
    sums->last = is_new ? last : fmax(sums->last, last);
}

static void add_torque(mesh_sums *sums, const step_nodes *nodes, const double *torque, const double *speed)
{
    double work = 0, energy = 0;
    for (int k = 0; k < nodes->n; k++) {
        work += nodes->weight[k] * torque[k];
        energy += nodes->weight[k] * fabs(torque[k] * speed[k]);
    }
    sums->torque += work;
    sums->energy += energy;
}

static void add_pairs(mesh_sums *sums, const step_nodes *nodes, double time, const double *pairs)
{
    bool is_one = true; /* as always, but where pairs without an event of their own lose their force */
    for (int k = 1; k < nodes->n; k++) {
        is_one = is_one && !(fabs(pairs[k] - pairs[0]) > 0);
    }
    for (int k = 0; k < (is_one ? 1 : nodes->n); k++) {
        const int touching = (int)(pairs[k] + 0.5);
        sums->shares[touching > 3 ? 3 : touching] += is_one ? time : nodes->weight[k];
    }
}

static void add_coast(mesh_sums *sums, const step_nodes *nodes, const double *force)
{
    double time = 0;
    for (int k = 0; k < nodes->n; k++) {
        time += isnan(force[k]) ? NAN : force[k] > 0 ? nodes->weight[k] : 0; /* NaN: it has no coast flanks */
    }
    sums->shares[NUMBER_COAST] += time;
}

void mesh_numbers_add(mesh_numbers *mesh, int m, int n_pairs, const mesh_places *places, const step_nodes *nodes,
                      number_waves *waves)
{
    mesh_sums *sums = &mesh->period;
    const double *angle = at_nodes(places, AT_ANGLE, mesh->wheel, nodes);
    const double *speed = at_nodes(places, AT_SPEED, mesh->wheel, nodes);
    double xi[STEP_NODES_MOST], rate[STEP_NODES_MOST], time = 0, pitches = 0;
    double first = INFINITY, last = -INFINITY;
    for (int k = 0; k < nodes->n; k++) {
        xi[k] = mesh->xi_0 + mesh->per_turn * angle[k];
        rate[k] = mesh->per_turn * speed[k];
        first = xi[k] < first ? xi[k] : first;
        last = xi[k] > last ? xi[k] : last;
        time += nodes->weight[k];
        pitches += nodes->weight[k] * rate[k];
    }
    add_range(sums, first, last);
    sums->time += time;
    sums->pitches += pitches;
    if (is_asked(places, AT_TORQUE)) {
        add_torque(sums, nodes, at_nodes(places, AT_TORQUE, m, nodes), speed);
    }
    if (is_asked(places, AT_PAIRS)) {
        add_pairs(sums, nodes, time, at_nodes(places, AT_PAIRS, m, nodes));
    }
    if (is_asked(places, AT_COAST)) {
        add_coast(sums, nodes, at_nodes(places, AT_COAST, m, nodes));
    }
    for (int p = 0; p < n_pairs && is_asked(places, AT_PAIR_FORCE); p++) {
        const double *force = at_nodes(places, AT_PAIR_FORCE, m * n_pairs + p, nodes);
        if (step_nodes_range(nodes, force).may_reach > fmax(sums->pair_force, mesh->total.pair_force)) {
            sums->pair_force = fmax(sums->pair_force, step_nodes_peak(nodes, force, 1));
        }
    }
    number_waves_find(waves, nodes->n, xi, rate);
}

void mesh_numbers_impact(mesh_numbers *mesh, double t, double speed)
{
    if (mesh->period.impacts + mesh->total.impacts > 0 && !(t > mesh->t_impact)) {
        return;
    }
    mesh->t_impact = t;
    mesh->period.impacts++;
    mesh->period.impact_speed = fmax(mesh->period.impact_speed, speed);
    mesh->period.impact_energy += 0.5 * mesh->mass * speed * speed;
}

void mesh_numbers_complete(mesh_numbers *mesh)
{
    mesh_sums *total = &mesh->total;
    const mesh_sums *period = &mesh->period;
    add_range(total, period->first, period->last);
    total->time += period->time;
    total->pitches += period->pitches;
    total->torque += period->torque;
    total->energy += period->energy;
    total->impact_energy += period->impact_energy;
    total->impacts += period->impacts;
    for (int i = 0; i <= NUMBER_COAST; i++) {
        total->shares[i] += period->shares[i];
    }
    total->impact_speed = fmax(total->impact_speed, period->impact_speed);
    total->pair_force = fmax(total->pair_force, period->pair_force);
    mesh->period = (mesh_sums){0};
}

/* ---- results ---- */

static void put(const int *offsets, double *values, number_of_contact what, int mesh, double value)
{
    values[offsets[number_row_of_contact(what)] + mesh] = value;
}

void mesh_numbers_conclude(const mesh_numbers *mesh, int m, const mesh_places *places, const model *model,
                           const bool *taken, const int *offsets, double *values)
{
    const mesh_sums *sums = &mesh->total;
    for (int i = 0; i <= NUMBER_COAST; i++) {
        if (is_asked(places, i == NUMBER_COAST ? AT_COAST : AT_PAIRS)) {
            put(offsets, values, (number_of_contact)i, m, sums->shares[i] / sums->time);
        }
    }
    if (is_asked(places, AT_PAIR_FORCE)) {
        put(offsets, values, NUMBER_PAIR_FORCE, m, sums->pair_force);
    }
    if (takes(taken, NUMBER_PAIR_DYNAMIC, NUMBER_PAIR_DYNAMIC)) {
        const double mean = -sums->torque / sums->time * (mesh->per_turn > 0 ? 1 : -1);
        const double margin = 2; /* coast flanks have an own start of contact, and a loaded mesh lags */
        const double at_rest = model_static_pair_force(model, m, sums->first - margin, sums->last + margin, mean);
        put(offsets, values, NUMBER_PAIR_DYNAMIC, m, sums->pair_force / at_rest);
    }
    put(offsets, values, NUMBER_IMPACTS, m, (double)sums->impacts);
    put(offsets, values, NUMBER_IMPACT_SPEED, m, sums->impact_speed);
    const double impact_energy = isnan(mesh->mass) ? NAN : sums->impact_energy;
    put(offsets, values, NUMBER_IMPACT_ENERGY, m, impact_energy);
    if (is_asked(places, AT_TORQUE)) {
        put(offsets, values, NUMBER_ENERGY, m, sums->energy);
        put(offsets, values, NUMBER_RATTLE, m, sums->energy > 0 ? impact_energy / sums->energy : NAN);
    }
}
