/** Monitor of the contact of each mesh, for a warning if a run ends without contact. Rattling gears often end a run
 *  separated; contact counts as permanently lost if the last separation lasts longer than every earlier one. */
#pragma once

#include "integrate/integrate_types.h"
#include "simulate/requested_outputs.h"

#include <stddef.h>

typedef struct {
    int n_meshes;
    int opened, closed, impact; /**< event kinds; after an impact the flanks separate again */
    int index;                  /**< index of in_contact among the outputs */
    struct separation_monitor_mesh {
        bool had_contact, is_open; /**< is_open: separated in the last outputs */
        double t_opened;           /**< time of the last separation, 0 before the first [s] */
        double longest;            /**< longest separation until the next contact [s] */
    } *meshes;
} separation_monitor;

/** Initialise the monitor and request its outputs. */
void separation_monitor_init(separation_monitor *monitor, requested_outputs *requested, int n_meshes);
/** Serialise the monitor. */
void separation_monitor_serialize(separation_monitor *monitor, archive *archive);
void separation_monitor_outputs(separation_monitor *monitor, const output_block *block);
void separation_monitor_event(separation_monitor *monitor, const event_record *record);
/** Describe how the first mesh permanently separated at t_end lost contact; mesh_names [n_meshes].
 *  @return false, with an empty text, if every mesh regained contact, never lost it or rattles */
bool separation_monitor_lost(const separation_monitor *monitor, double t_end, const char *const *mesh_names, char *text,
                             size_t size);
void separation_monitor_free(separation_monitor *monitor);
