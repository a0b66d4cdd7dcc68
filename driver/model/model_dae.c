#include "model/model.h"

#include "base/memory.h"
#include "model/model_kernel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int model_check_status(const model *model, int code, const evl_status *status, char message[DAE_MESSAGE_LENGTH])
{
    if (code == EVL_OK) {
        return DAE_OK;
    }
    if (status->subject == EVL_SUBJECT_MESH && status->index >= 0) {
        CLEANUP_FREE char *named =
            xasprintf("mesh '%s': %s", model->about.names.meshes.names[status->index], status->message);
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", named);
    } else {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "%s", status->message);
    }
    return code == EVL_OUT_OF_DOMAIN ? DAE_RECOVERABLE : DAE_FATAL;
}

static int residual(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code = evl_gearbox_residual(model->gearbox, state->t, state->y, state->yp, state->integers, state->reals,
                                          values, &status);
    return model_check_status(model, code, &status, message);
}

static int jacobian(const void *self, const dae_state *state, double cj, double *matrix,
                    char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code = evl_gearbox_jacobian(model->gearbox, state->t, cj, state->y, state->yp, state->integers,
                                          state->reals, matrix, &status);
    return model_check_status(model, code, &status, message);
}

static int roots(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code = evl_gearbox_roots(model->gearbox, state->y, state->integers, state->reals, values, &status);
    return model_check_status(model, code, &status, message);
}

static int monitored(const void *self, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code = evl_gearbox_monitored(model->gearbox, state->y, state->integers, state->reals, values, &status);
    return model_check_status(model, code, &status, message);
}

static int monitored_of_group(const void *self, int group, const dae_state *state, double *values,
                              char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code =
        evl_gearbox_monitored_mesh(model->gearbox, group, state->y, state->integers, state->reals, values, &status);
    return model_check_status(model, code, &status, message);
}

static int states_of_group(const void *self, int group, int *states)
{
    const model *model = self;
    return evl_gearbox_mesh_states(model->gearbox, group, states);
}

static int roots_and_monitored(const void *self, const dae_state *state, const double *highest, double *cached,
                               double *roots, double *values, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    const int code = evl_gearbox_roots_and_monitored(model->gearbox, state->y, state->integers, state->reals, DAE_NEAR,
                                                     highest, cached, roots, values, &status);
    return model_check_status(model, code, &status, message);
}

static void root_directions(const void *self, const int *integers, int *directions)
{
    const model *model = self;
    evl_gearbox_root_directions(model->gearbox, integers, directions);
}

static double next_time_event(const void *self, const dae_state *state)
{
    const model *model = self;
    return evl_gearbox_next_time_event(model->gearbox, state->integers);
}

static int apply_event(const void *self, dae_state *state, const int *fired, bool time_event, dae_event *events,
                       int *n_events, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    evl_status status;
    CLEANUP_FREE evl_event *happened =
        xrealloc(NULL, (size_t)model->sizes.n_events, sizeof *happened); /* filled up to *n_events */
    *n_events = 0;
    const int code = evl_gearbox_apply_event(model->gearbox, state->t, fired, time_event, state->y, state->yp,
                                             state->integers, state->reals, happened, n_events, &status);
    for (int i = 0; i < *n_events; i++) {
        events[i] = (dae_event){happened[i].kind, happened[i].mesh, happened[i].flank, happened[i].tooth_pair};
    }
    return model_check_status(model, code, &status, message);
}

static bool endless(const void *self, const dae_event *what, const char *how, char message[DAE_MESSAGE_LENGTH])
{
    const model *model = self;
    if (what->subject < 0) {
        return false;
    }
    const char *mesh = model->about.names.meshes.names[what->subject], *kind = model_tables()->event_kinds[what->kind];
    if (strcmp(kind, "impact") == 0) {
        (void)snprintf(message, DAE_MESSAGE_LENGTH,
                       "mesh '%s': endless impacts, %s; increase rest_velocity or reduce restitution", mesh, how);
    } else {
        (void)snprintf(message, DAE_MESSAGE_LENGTH, "mesh '%s': endless %s, %s: the model chatters", mesh, kind, how);
    }
    return true;
}

int model_position_of(const model *model, int wheel, int mesh)
{
    return mesh < 0 ? wheel : model->sizes.n_wheels + mesh;
}

bool model_can_pass(const model *model, int position_of, const dae_state *start)
{
    const int mesh = position_of - model->sizes.n_wheels;
    const int wheel = mesh < 0 ? position_of : evl_gearbox_driving_wheel(model->gearbox, mesh);
    return evl_gearbox_can_turn(model->gearbox, wheel, start->y, start->yp);
}

static double position(const void *self, int which, const dae_state *state)
{
    const model *model = self;
    const int mesh = which - model->sizes.n_wheels;
    return mesh < 0 ? evl_gearbox_turns(model->gearbox, which, state->y, state->integers)
                    : evl_gearbox_pitches(model->gearbox, mesh, state->y, state->integers);
}

/* ---- sparsity pattern of the Jacobian ---- */

typedef struct {
    const model *model;
    evl_pattern *pattern;
} model_entries;

static void *pattern_create(const void *self, int *n_entries)
{
    const model *model = self;
    evl_pattern *pattern = evl_pattern_create(model->gearbox, n_entries);
    if (pattern == NULL) {
        return NULL;
    }
    model_entries *entries = xcalloc(1, sizeof *entries);
    *entries = (model_entries){model, pattern};
    return entries;
}

static void pattern_destroy(void *pattern)
{
    model_entries *entries = pattern;
    evl_pattern_delete(&entries->pattern);
    free(entries);
}

static void pattern_indices(const void *pattern, int *rows, int *columns)
{
    const model_entries *entries = pattern;
    evl_pattern_indices(entries->pattern, rows, columns);
}

static int pattern_jacobian(const void *pattern, const dae_state *state, double cj, double *values,
                            char message[DAE_MESSAGE_LENGTH])
{
    const model_entries *entries = pattern;
    evl_status status;
    const int code = evl_pattern_jacobian(entries->pattern, state->t, cj, state->y, state->yp, state->integers,
                                          state->reals, values, &status);
    return model_check_status(entries->model, code, &status, message);
}

/** Sparsity pattern of the Jacobian of the model's dae. */
static const dae_pattern *model_pattern(void)
{
    static const dae_pattern pattern = {
        .create = pattern_create, .destroy = pattern_destroy, .indices = pattern_indices, .jacobian = pattern_jacobian};
    return &pattern;
}

void model_describe_dae(model *model, double duration)
{
    const evl_sizes *sizes = &model->sizes;
    const size_t n = (size_t)sizes->n_states;
    double *scale = arena_calloc(&model->arena, n, sizeof *scale),
           *row_scale = arena_calloc(&model->arena, n, sizeof *scale);
    evl_gearbox_scales(model->gearbox, &model->initial, duration, scale, row_scale);
    model->about.dae = (dae){
        .self = model,
        .n = sizes->n_states,
        .n_integers = sizes->n_integers,
        .n_reals = sizes->n_reals,
        .n_roots = sizes->n_roots,
        .n_events = sizes->n_events,
        .scale = scale,
        .row_scale = row_scale,
        .residual = residual,
        .jacobian = jacobian,
        .roots = roots,
        .root_directions = root_directions,
        .next_time_event = next_time_event,
        .apply_event = apply_event,
        .endless = endless,
        .monitored = monitored,
        .roots_and_monitored = roots_and_monitored,
        .position = position,
        .n_monitored = model_tables()->n_monitored * sizes->n_meshes,
        .n_cached = sizes->n_cached,
        .n_groups = sizes->n_meshes,
        .monitored_of_group = monitored_of_group,
        .states_of_group = states_of_group,
        .pattern = model_pattern(),
        .stepper = model_radau(model),
    };
}

int model_outputs(const model *model, const dae_state *state, double *values, char message[DAE_MESSAGE_LENGTH])
{
    evl_status status;
    const int code =
        evl_gearbox_outputs(model->gearbox, state->t, state->y, state->integers, state->reals, false, values, &status);
    return model_check_status(model, code, &status, message);
}
