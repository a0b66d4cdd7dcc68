#include "model/model_start_modes.h"

#include "model/model_kernel.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct {
    const model *model;
    dae_state at;        /**< linearisation point of the outputs */
    double *moved;       /**< [n_states] */
    double *plus, *less; /**< [n_values] */
} linearisation;

/** Derivative of the outputs with respect to a change of the state, whose entries are at most the scales of the states.
 *  @param part  0 or 1: selects real or imaginary parts of `change`, which alternate. @return a dae_code */
static int differentiate(linearisation *l, const double *change, int part, double *slopes,
                         char message[DAE_MESSAGE_LENGTH])
{
    static const double step = 1e-4; /* central differences: accurate to about 1e-8 */
    const model_facts *about = model_about(l->model);
    dae_state state = l->at;
    state.y = l->moved;
    for (int side = 0; side < 2; side++) {
        for (int i = 0; i < about->dae.n; i++) {
            l->moved[i] = l->at.y[i] + (side == 0 ? step : -step) * change[2 * i + part];
        }
        const int code = model_outputs(l->model, &state, side == 0 ? l->plus : l->less, message);
        if (code != DAE_OK) {
            return code;
        }
    }
    for (int i = 0; i < about->n_values; i++) {
        slopes[i] = (l->plus[i] - l->less[i]) / (2 * step);
    }
    return DAE_OK;
}

/** @return false with the reason in `message` */
static bool add_mode(linearisation *l, const double *eigenvalue, const double *vector, const double *amplitude,
                     start_modes *modes, char message[DAE_MESSAGE_LENGTH])
{
    const int n_values = model_about(l->model)->n_values;
    const double size = (eigenvalue[1] > 0 ? 2 : 1) * hypot(amplitude[0], amplitude[1]);
    start_mode *mode = &modes->modes[modes->n++];
    *mode = (start_mode){.rate = -eigenvalue[0],
                         .frequency = eigenvalue[1],
                         .left = arena_calloc(&modes->arena, (size_t)n_values, sizeof(double))};
    CLEANUP_FREE double *real = xcalloc((size_t)n_values, sizeof *real),
                        *imaginary = xcalloc((size_t)n_values, sizeof *real);
    if (differentiate(l, vector, 0, real, message) != DAE_OK ||
        (eigenvalue[1] > 0 && differentiate(l, vector, 1, imaginary, message) != DAE_OK)) {
        return false;
    }
    for (int i = 0; i < n_values; i++) {
        mode->left[i] = size * hypot(real[i], imaginary[i]);
    }
    return true;
}

bool model_start_modes(const model *model, const dae_state *start, start_modes *modes, model_message *error)
{
    const model_facts *about = model_about(model);
    const size_t n = (size_t)about->dae.n, n_values = (size_t)about->n_values;
    ARENA_SCOPE memory_arena arena = {NULL};
    linearisation l = {.model = model,
                       .at = dae_state_create(&about->dae, &arena),
                       .moved = arena_calloc(&arena, n, sizeof(double)),
                       .plus = arena_calloc(&arena, n_values, sizeof(double)),
                       .less = arena_calloc(&arena, n_values, sizeof(double))};
    double *eigenvalues = arena_calloc(&arena, 2 * n, sizeof(double)),
           *amplitudes = arena_calloc(&arena, 2 * n, sizeof(double));
    double *vectors = arena_calloc(&arena, 2 * n * n, sizeof(double));
    evl_status status = {.index = -1};
    int n_found = 0;
    l.at.t = start->t;
    *modes = (start_modes){.n = 0};
    if (evl_gearbox_start_distance(model->gearbox, start->t, start->y, start->integers, l.at.y, l.at.integers,
                                   l.at.reals, &n_found, eigenvalues, vectors, amplitudes, &status) != EVL_OK) {
        model_explain_start(model, &status, error);
        return false;
    }
    bool good = true;
    modes->modes = arena_calloc(&modes->arena, n, sizeof *modes->modes);
    for (int k = 0; k < n_found && good; k++) {
        const double *eigenvalue = &eigenvalues[2 * k];
        if (eigenvalue[1] > 0 || (!(eigenvalue[1] < 0) && fabs(eigenvalue[0]) > 0)) {
            good = add_mode(&l, eigenvalue, &vectors[2 * n * (size_t)k], &amplitudes[2 * k], modes, error->message);
        }
    }
    if (!good) {
        arena_free(&modes->arena);
    }
    return good;
}
