#include "model/model.h"

#include "model/model_kernel.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void model_explain(const model *model, const evl_status *status, model_message *error)
{
    error->field[0] = '\0';
    if (model->description != NULL) {
        evl_description_path(model->description, status, error->field);
    }
    (void)snprintf(error->message, sizeof error->message, "%s", status->message);
}

/** Names of the tooth pairs in the outputs: those of the drive flank come first. */
static name_list name_pairs(model *model)
{
    const int n = model->sizes.n_pair_slots, n_drive = model->sizes.n_drive_slots;
    const char **pairs = arena_calloc(&model->arena, (size_t)n, sizeof *pairs);
    for (int i = 0; i < n; i++) {
        pairs[i] = arena_printf(&model->arena, i < n_drive ? "drive_%d" : "coast_%d", i < n_drive ? i : i - n_drive);
    }
    return (name_list){n, pairs};
}

/** The kernel's description; taken from an earlier model if that differs only in numbers. */
static evl_description *describe(const description *description, model *before, evl_status *status)
{
    evl_description *known = before == NULL ? NULL : before->description;
    if (known != NULL) {
        before->description = NULL;
        if (evl_description_renew(known, description->n_entries, description->entries)) {
            return known;
        }
        evl_description_delete(&known);
    }
    return evl_description_create(description->n_entries, description->entries, status);
}

model *model_create(const description *description, const evl_wheel_store *wheels, model *before, model_message *error)
{
    evl_status status = {.index = -1};
    model *model = xcalloc(1, sizeof *model);
    model->initial = description->simulation.initial;
    model->description = describe(description, before, &status);
    model->gearbox = model->description == NULL ? NULL : evl_gearbox_create(model->description, wheels, &status);
    if (model->gearbox == NULL) {
        model_explain(model, &status, error);
        model_delete(&model);
        return NULL;
    }
    evl_gearbox_sizes(model->gearbox, &model->sizes);
    model->about.names = (model_names){.wheels = {description->n_wheels, description->wheels},
                                       .meshes = {description->n_meshes, description->meshes},
                                       .shafts = {description->n_shafts, description->shafts},
                                       .accelerometers = {description->n_accelerometers, description->accelerometers},
                                       .pairs = name_pairs(model)};
    model_describe_dae(model, description->simulation.duration);
    model_describe_outputs(model);
    return model;
}

bool model_add_root_stress(model *model, const evl_wheel_store *wheels, model_message *error)
{
    static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER; /* threads may share a model */
    evl_status status = {.index = -1};
    (void)pthread_mutex_lock(&mutex);
    const bool good = evl_gearbox_add_root_stress(model->gearbox, model->description, wheels, &status) == EVL_OK;
    (void)pthread_mutex_unlock(&mutex);
    if (!good) {
        model_explain(model, &status, error);
    }
    return good;
}

bool model_add_root_outputs(model *model)
{
    const bool good = evl_gearbox_add_root_outputs(model->gearbox);
    if (good) {
        evl_gearbox_sizes(model->gearbox, &model->sizes);
        model_describe_outputs(model);
    }
    return good;
}

bool model_add_temperatures(model *model, model_message *error)
{
    evl_status status = {.index = -1};
    const bool good = evl_gearbox_add_temperatures(model->gearbox, model->description, &status) == EVL_OK;
    if (good) {
        evl_gearbox_sizes(model->gearbox, &model->sizes);
        model_describe_outputs(model);
    } else {
        model_explain(model, &status, error);
    }
    return good;
}

_Static_assert(+MODEL_ROOT_ARCS == +EVL_ROOT_ARCS, "as in the kernel");

bool model_root_influence(const model *model, int wheel, int n, const int *flanks, const double *rho, const int *teeth,
                          double *arcs, double *stress)
{
    if (evl_gearbox_root_arcs(model->gearbox, wheel, arcs) == 0) {
        return false;
    }
    evl_gearbox_root_influence(model->gearbox, wheel, n, flanks, rho, teeth, stress);
    return true;
}

int model_support_directions(const model *model, int wheel, double directions[2][2])
{
    return evl_gearbox_support_directions(model->gearbox, wheel, directions[0]);
}

model *model_sketch(const description *description)
{
    evl_status ignored = {.index = -1};
    model *model = xcalloc(1, sizeof *model);
    model->description = describe(description, NULL, &ignored);
    if (model->description == NULL) {
        model_delete(&model);
    }
    return model;
}

int model_geometry(const model *model, evl_of of, int index, evl_output quantities[EVL_MOST_QUANTITIES])
{
    return model->gearbox == NULL ? evl_description_geometry(model->description, (int)of, index, quantities)
                                  : evl_gearbox_geometry(model->gearbox, (int)of, index, quantities);
}

double model_quantity(const model *model, evl_of of, int index, const char *name)
{
    evl_output quantities[EVL_MOST_QUANTITIES];
    int i = model_geometry(model, of, index, quantities) - 1;
    while (i >= 0 && strcmp(quantities[i].name, name) != 0) {
        i--;
    }
    return i < 0 ? NAN : quantities[i].value[0];
}

int model_pitch_errors(const model *model, int wheel, int most, double *errors)
{
    return model->gearbox == NULL ? 0 : evl_gearbox_pitch_errors(model->gearbox, wheel, most, errors);
}

evl_sheet_row *model_datasheet(const model *model, int mesh, int *n)
{
    *n = evl_gearbox_datasheet(model->gearbox, mesh, 0, NULL);
    evl_sheet_row *rows = xcalloc((size_t)*n, sizeof *rows);
    (void)evl_gearbox_datasheet(model->gearbox, mesh, *n, rows);
    return rows;
}

bool model_has_friction_limits(const model *model)
{
    return model->gearbox != NULL && evl_gearbox_has_local_friction(model->gearbox);
}

bool model_check_friction_limits(const model *model, const dae_state *state, model_message *found)
{
    evl_status status = {.index = -1};
    if (evl_gearbox_friction_limits(model->gearbox, state->y, state->integers, state->reals, &status) == EVL_OK) {
        return true;
    }
    model_explain(model, &status, found);
    return false;
}

double model_iso_dynamic_factor(const model *model, int mesh, bool of_class)
{
    const char *key = of_class ? "dynamic_factor_of_class" : "dynamic_factor";
    int n;
    CLEANUP_FREE evl_sheet_row *rows = model_datasheet(model, mesh, &n);
    double factor = NAN;
    for (int i = 0; i < n && model->about.names.meshes.n == 1; i++) {
        factor = strcmp(rows[i].key, key) == 0 ? rows[i].value[0] : factor;
    }
    return factor;
}

void model_mesh_picture(const model *model, int mesh, evl_mesh_picture *picture)
{
    evl_gearbox_mesh_picture(model->gearbox, mesh, picture);
}

double *model_mesh_outline(const model *model, int mesh, int driven, int teeth, int *n)
{
    *n = evl_gearbox_mesh_outline(model->gearbox, mesh, driven, teeth, 0, NULL);
    double *points = xcalloc((size_t)*n, 2 * sizeof *points);
    (void)evl_gearbox_mesh_outline(model->gearbox, mesh, driven, teeth, *n, points);
    return points;
}

void model_damping(const model *model, int mesh, double parameters[MODEL_MOST_PARAMETERS])
{
    evl_gearbox_damping(model->gearbox, mesh, parameters);
}

void model_delete(model **pointer)
{
    model *model = *pointer;
    *pointer = NULL;
    if (model == NULL) {
        return;
    }
    evl_gearbox_delete(&model->gearbox);
    evl_description_delete(&model->description);
    arena_free(&model->arena);
    free(model);
}

const model_facts *model_about(const model *model)
{
    return &model->about;
}

void model_explain_no_stepper(const model *model, model_message *error)
{
    evl_status status;
    (void)evl_radau_serves(model->gearbox, &status);
    model_explain(model, &status, error);
}

void model_explain_start(const model *model, const evl_status *status, model_message *error)
{
    model_explain(model, status, error);
    if (error->field[0] == '\0') {
        (void)snprintf(error->field, sizeof error->field, "%s", MODEL_START);
    }
}

int model_n_warnings(const model *model)
{
    evl_status status;
    const int n = model->sizes.n_warnings; /* of the gearbox; then those of speeds */
    return n + evl_gearbox_warning(model->gearbox, &model->initial, n, &status);
}

void model_warning(const model *model, int index, model_message *warning)
{
    evl_status status;
    (void)evl_gearbox_warning(model->gearbox, &model->initial, index, &status);
    model_explain(model, &status, warning);
}
