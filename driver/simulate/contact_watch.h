/** Whether the flanks of each mesh meet: a run that ends apart for good deserves a word. Teeth that rattle end many a run in
 *  flight; they are taken to be apart for good once this flight has lasted longer than each before it. */
#pragma once

#include "integrate/integrate_types.h"
#include "simulate/wanted.h"

#include <stddef.h>

typedef struct {
    int n_meshes;
    int opened, closed, impact; /**< event kinds; after an impact the flanks part again */
    int place;                  /**< of in_contact among the outputs */
    struct contact_watch_mesh {
        bool had_contact, is_open; /**< is_open: in the last outputs */
        double t_opened;           /**< of the last opening, 0 before the first [s] */
        double longest;            /**< from an opening to the next closing [s] */
    } *meshes;
} contact_watch;

/** Wants what it looks at. */
void contact_watch_init(contact_watch *watch, wanted_outputs *wanted, int n_meshes);
/** Keep what was seen. */
void contact_watch_keep(contact_watch *watch, archive *archive);
void contact_watch_outputs(contact_watch *watch, const output_block *block);
void contact_watch_event(contact_watch *watch, const event_record *record);
/** Say of the first mesh that is apart for good at t_end how that came; mesh_names [n_meshes].
 *  @return false, with an empty text, if every mesh regained contact, never lost it or rattles */
bool contact_watch_lost(const contact_watch *watch, double t_end, const char *const *mesh_names, char *text,
                        size_t size);
void contact_watch_free(contact_watch *watch);
