/** What is counted of the contact of a mesh over a window of whole pitches: shares of time, energy, impacts, the largest force of a
 *  tooth pair. Sums are taken over the present period and count when it is complete. */
#pragma once

#include "simulate/number_channel.h"
#include "simulate/number_rows.h"
#include "simulate/step_nodes.h"

/** Values at the nodes of what meshes are asked for. */
typedef enum { AT_ANGLE, AT_SPEED, AT_PAIRS, AT_COAST, AT_TORQUE, AT_PAIR_FORCE, N_AT_MESH } at_mesh;
typedef struct {
    int at[N_AT_MESH]; /**< index of the first; -1: it is not asked for */
} mesh_places;

/** Sums, and largest values. */
typedef struct {
    double time, pitches, torque, energy, impact_energy;
    double shares[NUMBER_COAST + 1]; /**< times [s] */
    long impacts;
    double impact_speed, pair_force;
    double first, last; /**< positions between which the mesh was [pitches], if time is not 0 */
} mesh_sums;

typedef struct {
    int wheel;       /**< that drives it */
    double xi_0;     /**< position where angles are 0 [pitches] */
    double per_turn; /**< pitches a radian of that wheel, with the sign of its nominal sense */
    double mass;     /**< of both wheels along the line of action [kg] */
    double t_impact; /**< of the last one [s]: pairs that meet at once are one */
    mesh_sums period, total;
} mesh_numbers;

/** Name of the output that a place is of. */
const char *mesh_output(at_mesh what);
/** Ask the nodes for what the rows need. @param taken  [N_NUMBER_ROWS] rows that are wanted */
void mesh_numbers_want(const bool *taken, step_nodes *nodes, mesh_places *places);
/** Add what is known at the nodes, and find the waves of the mesh order there.
 *  @param m, n_pairs  index of the mesh; places of tooth pairs that a mesh has */
void mesh_numbers_add(mesh_numbers *mesh, int m, int n_pairs, const mesh_places *places, const step_nodes *nodes,
                      number_waves *waves);
/** Flanks meet, at a speed [m/s], where no pair touched. */
void mesh_numbers_impact(mesh_numbers *mesh, double t, double speed);
void mesh_numbers_complete(mesh_numbers *mesh);
/** @param values  as number_rows_offsets has the rows */
void mesh_numbers_conclude(const mesh_numbers *mesh, int m, const mesh_places *places, const model *model,
                           const bool *taken, const int *offsets, double *values);
