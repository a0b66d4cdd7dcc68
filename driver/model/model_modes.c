#include "model/model_modes.h"

#include "model/model_kernel.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Amplitudes are equal below this relative difference, so that the choice of the largest does not depend on rounding. */
static const double equal_amplitudes = 1e-9;

static void shape_part(const model *model, const dae_state *state, const double *change, double complex unit,
                       natural_mode *mode)
{
    const size_t n_wheels = (size_t)model->sizes.n_wheels, n_meshes = (size_t)model->sizes.n_meshes;
    const size_t n = 3 * n_wheels + 2 * n_meshes;
    CLEANUP_FREE double *values = xcalloc(n, sizeof *values);
    double *displacements = values + n_wheels, *penetrations = values + 3 * n_wheels;
    evl_gearbox_shape(model->gearbox, state->y, change, values, displacements, penetrations, penetrations + n_meshes);
    for (size_t i = 0; i < n; i++) {
        mode->arcs[i] += unit * values[i]; /* the other parts follow the arcs */
    }
}

/** Value for the normalisation: of the wheel or axle with the largest motion, with the phase of its larger coordinate. */
static double complex largest_motion(const model *model, const natural_mode *mode)
{
    double complex unit = 0.0;
    for (int i = 0; i < model->sizes.n_wheels; i++) {
        const double complex arc = mode->arcs[i], x = mode->displacements[i][0], y = mode->displacements[i][1];
        const double complex larger = cabs(y) > (1.0 + equal_amplitudes) * cabs(x) ? y : x;
        const double amplitude = hypot(cabs(x), cabs(y));
        if (cabs(arc) > (1.0 + equal_amplitudes) * cabs(unit)) {
            unit = arc;
        }
        if (amplitude > (1.0 + equal_amplitudes) * cabs(unit)) {
            unit = larger * (amplitude / cabs(larger));
        }
    }
    return unit;
}

static void normalise(const model *model, natural_mode *mode)
{
    const double complex unit = largest_motion(model, mode);
    const int n = 3 * model->sizes.n_wheels + 2 * model->sizes.n_meshes;
    for (int i = 0; i < n && cabs(unit) > 0.0; i++) {
        mode->arcs[i] = mode->arcs[i] == unit ? 1.0 : mode->arcs[i] / unit;
    }
}

/** @param vector  [2 n_states] a change of the state, real and imaginary parts alternating */
static natural_mode create_mode(memory_arena *arena, const model *model, const dae_state *state,
                                const double eigenvalue[2], const double *vector)
{
    const size_t n_wheels = (size_t)model->sizes.n_wheels, n_meshes = (size_t)model->sizes.n_meshes;
    double complex *values = arena_calloc(arena, 3 * n_wheels + 2 * n_meshes, sizeof *values);
    natural_mode mode = {.eigenvalue = eigenvalue[0] + eigenvalue[1] * I,
                         .arcs = values,
                         .displacements = (double complex(*)[2])(values + n_wheels),
                         .penetrations = values + 3 * n_wheels,
                         .transmission_errors = values + 3 * n_wheels + n_meshes};
    CLEANUP_FREE double *change = xcalloc((size_t)model->sizes.n_states, sizeof *change);
    for (int part = 0; part < 2; part++) {
        for (int i = 0; i < model->sizes.n_states; i++) {
            change[i] = vector[2 * i + part];
        }
        shape_part(model, state, change, part == 0 ? 1.0 : I, &mode);
    }
    normalise(model, &mode);
    return mode;
}

/** Find the modes at a state, or, with an array for mean outputs, of the mean over steady states: then the state is an
 *  output. */
static bool find_modes(const model *model, const dae_state *state, double *means, int n_positions, natural_modes *modes,
                       evl_status *status)
{
    const size_t n = (size_t)model->sizes.n_states;
    CLEANUP_FREE double *eigenvalues = xcalloc(2 * n, sizeof *eigenvalues),
                        *vectors = xcalloc(2 * n * n, sizeof *vectors);
    int n_found = 0;
    *modes = (natural_modes){.n = 0};
    *status = (evl_status){.index = -1};
    const int code = evl_gearbox_modes(model->gearbox, state->t, state->y, state->integers, state->reals, &n_found,
                                       &modes->n_rigid, eigenvalues, vectors, means, n_positions, status);
    if (code != EVL_OK) {
        return false;
    }
    modes->modes = arena_calloc(&modes->arena, n, sizeof *modes->modes);
    for (int k = 0; k < n_found; k++) {
        const double *eigenvalue = &eigenvalues[2 * k];
        if (eigenvalue[1] > 0.0 || (eigenvalue[1] == 0.0 && eigenvalue[0] != 0.0)) {
            modes->modes[modes->n++] =
                create_mode(&modes->arena, model, state, eigenvalue, &vectors[2 * n * (size_t)k]);
        }
    }
    return true;
}

bool model_modes(const model *model, const dae_state *state, natural_modes *modes, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const bool good = find_modes(model, state, NULL, 0, modes, &status);
    if (!good) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", status.message);
    }
    return good;
}

bool model_mean_modes(const model *model, int n_positions, dae_state *state, double *values, natural_modes *modes,
                      model_message *error)
{
    evl_status status;
    *state = dae_state_create(&model->about.dae, NULL);
    const bool good = find_modes(model, state, values, n_positions, modes, &status);
    if (!good) {
        model_explain_start(model, &status, error);
        dae_state_free(state);
    }
    return good;
}

evl_mesh_mode model_mesh_mode(const model *model, const dae_state *state, int mesh)
{
    evl_mesh_mode mode;
    evl_gearbox_mesh_mode(model->gearbox, mesh, state->y, state->integers, state->reals, &mode);
    return mode;
}
