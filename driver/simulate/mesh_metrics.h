/** Contact metrics of a mesh over a window of whole pitches: shares of time, energy, impacts, the largest force of a
 *  tooth pair. Sums are taken over the present period and added to the total when it is complete. */
#pragma once

#include "model/model_static.h"
#include "simulate/metric_channel.h"
#include "simulate/step_nodes.h"

/** OUTPUT(key, output, whether there is one per tooth pair, accumulation function; NULL: always requested) */
#define MESH_OUTPUTS(OUTPUT)                                                                                           \
    OUTPUT(ANGLE, "angle", false, NULL)                                                                                \
    OUTPUT(SPEED, "angular_velocity", false, NULL)                                                                     \
    OUTPUT(PAIRS, "pairs_in_contact", false, add_pairs)                                                                \
    OUTPUT(COAST, "coast_force", false, add_coast)                                                                     \
    OUTPUT(TORQUE, "mesh_torque_driving", false, add_torque)                                                           \
    OUTPUT(PAIR_FORCE, "pair_normal_force", true, add_pair_force)                                                      \
    OUTPUT(FRICTION, "friction_loss", false, add_friction)

enum {
#define OUTPUT(key, ...) AT_##key,
    MESH_OUTPUTS(OUTPUT) N_AT_MESH,
#undef OUTPUT
/** Bits for the outputs that a metric needs. */
#define OUTPUT(key, ...) NEEDS_##key = 1 << AT_##key,
    MESH_OUTPUTS(OUTPUT) NEEDS_NOTHING = 0
#undef OUTPUT
};
typedef struct {
    int at[N_AT_MESH]; /**< index of the first value; -1: not requested */
} mesh_indices;

/** ACCUMULATOR(type, name, how a period is added to the total), in the order of checkpoints */
#define MESH_ACCUMULATORS(ACCUMULATOR)                                                                                 \
    ACCUMULATOR(double, time, SUM) /* [s], as for the shares */                                                        \
    ACCUMULATOR(double, pitches, SUM)                                                                                  \
    ACCUMULATOR(double, torque, SUM)                                                                                   \
    ACCUMULATOR(double, energy, SUM)                                                                                   \
    ACCUMULATOR(double, friction, SUM)                                                                                 \
    ACCUMULATOR(double, impact_energy, SUM)                                                                            \
    ACCUMULATOR(double, no_contact, SUM)                                                                               \
    ACCUMULATOR(double, one_pair, SUM)                                                                                 \
    ACCUMULATOR(double, two_pairs, SUM)                                                                                \
    ACCUMULATOR(double, more_pairs, SUM)                                                                               \
    ACCUMULATOR(double, coast, SUM)                                                                                    \
    ACCUMULATOR(long, impacts, SUM)                                                                                    \
    ACCUMULATOR(double, impact_speed, HIGHEST)                                                                         \
    ACCUMULATOR(double, pair_force, HIGHEST)                                                                           \
    ACCUMULATOR(double, first, LOWER_END) /* range of positions of the mesh [pitches], if time is not 0 */             \
    ACCUMULATOR(double, last, UPPER_END)

typedef struct {
#define ACCUMULATOR(type, name, join) type name;
    MESH_ACCUMULATORS(ACCUMULATOR)
#undef ACCUMULATOR
} mesh_sums;

typedef struct {
    int wheel;       /**< driving wheel */
    int driven;      /**< driven wheel */
    double xi_0;     /**< position at zero angles [pitches] */
    double per_turn; /**< pitches per radian of that wheel, with the sign of its nominal sense */
    double mass;     /**< reduced mass of both wheels along the line of action [kg] */
    double t_impact; /**< time of the last impact [s]; simultaneous contacts of several pairs are one impact */
    mesh_sums period, total;
} mesh_metrics;

/** Request the outputs at the nodes. @param needs  of all rows: NEEDS_PAIRS and so on */
void mesh_metrics_request(unsigned needs, step_nodes *nodes, mesh_indices *indices);
/** Whether the model has all of these outputs. */
bool mesh_metrics_available(const mesh_indices *indices, unsigned needs);
/** Accumulate the values at the nodes, and compute the harmonics of the mesh order there.
 *  @param m, n_pairs  index of the mesh; number of tooth pairs in the outputs of a mesh */
void mesh_metrics_add(mesh_metrics *mesh, int m, int n_pairs, const mesh_indices *indices, const step_nodes *nodes,
                      metric_waves *waves);
/** Count an impact: contact closes at a speed [m/s] while no tooth pair is in contact. */
void mesh_metrics_impact(mesh_metrics *mesh, double t, double speed);
void mesh_metrics_complete(mesh_metrics *mesh);
/** Positions of the window, with a margin, and its mean torque. */
static_span mesh_metrics_span(const mesh_metrics *mesh);
