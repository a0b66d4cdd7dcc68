#include "simulate/separation_monitor.h"

#include "base/memory.h"
#include "base/words.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/** Index of a name in a table of the kernel; aborts without it, since the monitor would silently be ineffective. */
static int required(int index, const char *name)
{
    if (index < 0) {
        (void)fprintf(stderr, "evolvent: the kernel has no '%s', which is required to detect lost contact\n", name);
        abort();
    }
    return index;
}

static int find_event(const char *name)
{
    return required(words_index(name, model_tables()->n_event_kinds, model_tables()->event_kinds), name);
}

void separation_monitor_init(separation_monitor *monitor, requested_outputs *requested, int n_meshes)
{
    *monitor = (separation_monitor){.n_meshes = n_meshes,
                                    .opened = find_event("contact_opened"),
                                    .closed = find_event("contact_closed"),
                                    .impact = find_event("impact"),
                                    .index = required(requested_outputs_add(requested, "in_contact"), "in_contact"),
                                    .meshes = xcalloc((size_t)n_meshes, sizeof *monitor->meshes)};
}

void separation_monitor_serialize(separation_monitor *monitor, archive *archive)
{
    SERIALIZE_ARRAY(archive, monitor->meshes, monitor->n_meshes);
}

void separation_monitor_outputs(separation_monitor *monitor, const output_block *block)
{
    for (int i = 0; i < monitor->n_meshes; i++) {
        const double *touching = output_values(block, monitor->index + i);
        struct separation_monitor_mesh *mesh = &monitor->meshes[i];
        mesh->is_open = !(touching[block->n - 1] > 0.0);
        for (int k = 0; k < block->n && !mesh->had_contact; k++) {
            mesh->had_contact = touching[k] > 0.0;
        }
    }
}

void separation_monitor_event(separation_monitor *monitor, const event_record *record)
{
    const int mesh = record->what.subject, kind = record->what.kind;
    if (mesh < 0 || mesh >= monitor->n_meshes ||
        (kind != monitor->opened && kind != monitor->closed && kind != monitor->impact)) {
        return;
    }
    struct separation_monitor_mesh *state = &monitor->meshes[mesh];
    if (kind != monitor->opened && state->t_opened > 0.0) {
        state->longest = fmax(state->longest, record->t - state->t_opened);
    }
    state->had_contact = true;
    if (kind != monitor->closed) {
        state->t_opened = record->t;
    }
}

static bool is_lost(const struct separation_monitor_mesh *mesh, double t_end)
{
    return !mesh->had_contact || (mesh->is_open && t_end - mesh->t_opened > mesh->longest);
}

bool separation_monitor_lost(const separation_monitor *monitor, double t_end, const char *const *mesh_names, char *text,
                             size_t size)
{
    int others = -1;
    text[0] = '\0';
    for (int i = 0; i < monitor->n_meshes; i++) {
        const struct separation_monitor_mesh *mesh = &monitor->meshes[i];
        if (!is_lost(mesh, t_end)) {
            continue;
        }
        others++;
        if (others > 0) {
            continue;
        }
        if (mesh->had_contact) {
            (void)snprintf(text, size, "mesh '%s' lost contact at t = %.9g s and did not regain it", mesh_names[i],
                           mesh->t_opened);
        } else {
            (void)snprintf(text, size, "the flanks of mesh '%s' never touched", mesh_names[i]);
        }
    }
    if (others > 0) {
        const size_t length = strlen(text);
        (void)snprintf(text + length, size - length, "; so did %d other mesh%s", others, others > 1 ? "es" : "");
    }
    return others >= 0;
}

void separation_monitor_free(separation_monitor *monitor)
{
    free(monitor->meshes);
    monitor->meshes = NULL;
}
