#include "simulate/contact_watch.h"

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

void contact_watch_init(contact_watch *watch, wanted_outputs *wanted, int n_meshes)
{
    *watch = (contact_watch){.n_meshes = n_meshes,
                             .opened = find_event("contact_opened"),
                             .closed = find_event("contact_closed"),
                             .impact = find_event("impact"),
                             .place = required(wanted_add(wanted, "in_contact"), "in_contact"),
                             .meshes = xcalloc((size_t)n_meshes, sizeof *watch->meshes)};
}

void contact_watch_keep(contact_watch *watch, archive *archive)
{
    KEEP_ARRAY(archive, watch->meshes, watch->n_meshes);
}

void contact_watch_outputs(contact_watch *watch, const output_block *block)
{
    for (int i = 0; i < watch->n_meshes; i++) {
        const double *touching = output_values(block, watch->place + i);
        struct contact_watch_mesh *mesh = &watch->meshes[i];
        mesh->is_open = !(touching[block->n - 1] > 0.0);
        for (int k = 0; k < block->n && !mesh->had_contact; k++) {
            mesh->had_contact = touching[k] > 0.0;
        }
    }
}

void contact_watch_event(contact_watch *watch, const event_record *record)
{
    const int mesh = record->what.subject, kind = record->what.kind;
    if (mesh < 0 || mesh >= watch->n_meshes ||
        (kind != watch->opened && kind != watch->closed && kind != watch->impact)) {
        return;
    }
    struct contact_watch_mesh *state = &watch->meshes[mesh];
    if (kind != watch->opened && state->t_opened > 0.0) {
        state->longest = fmax(state->longest, record->t - state->t_opened);
    }
    state->had_contact = true;
    if (kind != watch->closed) {
        state->t_opened = record->t;
    }
}

static bool is_lost(const struct contact_watch_mesh *mesh, double t_end)
{
    return !mesh->had_contact || (mesh->is_open && t_end - mesh->t_opened > mesh->longest);
}

bool contact_watch_lost(const contact_watch *watch, double t_end, const char *const *mesh_names, char *text,
                        size_t size)
{
    int others = -1;
    text[0] = '\0';
    for (int i = 0; i < watch->n_meshes; i++) {
        const struct contact_watch_mesh *mesh = &watch->meshes[i];
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

void contact_watch_free(contact_watch *watch)
{
    free(watch->meshes);
    watch->meshes = NULL;
}
