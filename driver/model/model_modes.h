/** Natural modes of the gearbox at a state. */
#pragma once

#include "base/memory.h"
#include "model/model.h"

#include <complex.h>

/** One mode, or a conjugate pair: each coordinate is the real part of its value times exp(eigenvalue t). All values are
 *  lengths. The shape is normalised so that the largest motion of a wheel or axle is 1; that of an axle is sqrt(|x|^2 +
 *  |y|^2). */
typedef struct {
    double complex eigenvalue;           /**< [1/s], imaginary part >= 0, never 0 */
    double complex *arcs;                /**< [n_wheels] r_b phi, counterclockwise */
    double complex (*displacements)[2];  /**< [n_wheels] of the axles, x and y */
    double complex *penetrations;        /**< [n_meshes] h */
    double complex *transmission_errors; /**< [n_meshes] Delta */
} natural_mode;

typedef struct {
    memory_arena arena;
    int n_rigid; /**< independent motions without restoring force, such as rotation of the train; not among the modes */
    int n;
    natural_mode *modes; /**< [n] in ascending order of frequency */
} natural_modes;

/** Modes of the gearbox linearised at a state. @return false with the reason in `message`; then there is nothing to
 *  free */
bool model_modes(const model *model, const dae_state *state, natural_modes *modes, char message[DAE_MESSAGE_LENGTH]);
/** Modes of the gearbox linearised at the steady states at all positions of its meshes, with the mean of the matrices.
 *  @param n_positions  number of positions for the mean; 0: 997
 *  @param[out] state   steady state of the mode shapes; its arrays belong to the caller
 *  @param[out] values  [model_n_values] mean outputs
 *  @return false with the reason in `error`; then there is nothing to free */
bool model_mean_modes(const model *model, int n_positions, dae_state *state, double *values, natural_modes *modes,
                      model_message *error);

/** State of a mesh at a state of the gearbox. */
evl_mesh_mode model_mesh_mode(const model *model, const dae_state *state, int mesh);
