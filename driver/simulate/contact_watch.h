/** Monitor of the contact of each mesh, for a warning if a run ends without contact. Rattling gears often end a run
 *  separated; contact counts as permanently lost if the last separation lasts longer than every earlier one. */
#pragma once

#include "integrate/integrate_types.h"
#include "simulate/wanted.h"

#include <stddef.h>

typedef struct {
    int n_meshes;
    int opened, closed, impact; /**< event kinds; after an impact the flanks separate again */
    int place;                  /**< index of in_contact among the outputs */
    struct contact_watch_mesh {
        bool had_contact, is_open; /**< is_open: separated in the last outputs */
        double t_opened;           /**< time of the last separation, 0 before the first [s] */
        double longest;            /**< longest separation until the next contact [s] */
    } *meshes;
} contact_watch;

/** Initialise the monitor and request its outputs. */
void contact_watch_init(contact_watch *watch, wanted_outputs *wanted, int n_meshes);
/** Serialise the monitor. */
void contact_watch_keep(contact_watch *watch, archive *archive);
void contact_watch_outputs(contact_watch *watch, const output_block *block);
void contact_watch_event(contact_watch *watch, const event_record *record);
/** Describe how the first mesh permanently separated at t_end lost contact; mesh_names [n_meshes].
 *  @return false, with an empty text, if every mesh regained contact, never lost it or rattles */
bool contact_watch_lost(const contact_watch *watch, double t_end, const char *const *mesh_names, char *text,
                        size_t size);
void contact_watch_free(contact_watch *watch);
