/** The section on which a motion is looked at: once a common period, at one place in it that lies away from events.
 *
 *  The place is counted in pitches of the first mesh: by time where a speed is prescribed, 0 at t = 0; else by the angle of its driving
 *  wheel, as of model_position_of. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model_period.h"

typedef struct {
    const model *model;
    model_period period;
    int position_of; /**< the pitches of the first mesh */
    double phase;    /**< place of the section, from 0 to period.pitches [pitches] */
    double target;   /**< of the next section, a place that grows from period to period */
    double here;     /**< of the last one; NAN: none yet */
    double event;    /**< place of the last event; NAN: none yet */
    bool is_crossed; /**< an event came too near */
    int n_moves;     /**< how often it went out of the way */
    memory_pool *pool;
    dae_state room;      /**< whose arrays belong to it */
    int n_now, n_before; /**< events of this period and of the one before, as many as there is room for */
    int n_room;
    double *now, *before; /**< [n_room] */
} section;

/** Where motions have to come from a start: a place in the period at which most cases have no event. */
#define SECTION_USUAL_PHASE 0.5

/** @param phase  where it is to be
 *  @param state  from which the motion starts: the next section lies behind */
void section_begin(section *section, memory_pool *pool, const model *model, const model_period *period, double phase,
                   const dae_state *state);
/** Place of a state. */
double section_place(const section *section, const dae_state *state);
/** How fast a motion by angle passes pitches [1/s]. */
double section_pitch_rate(const section *section, const dae_state *state);
/** Whether a step reaches the next section. @param state  with room for all arrays: becomes the state there */
bool section_reached(section *section, const integrate_step *step, dae_state *state);
/** The section was reached: go on to the next one. */
void section_passed(section *section);
/** Something happened. */
void section_event(section *section, const event_record *record);
/** If an event came within 1e-6 of a pitch, move to the middle of the longest way between two events: the next section is
 *  there. @return whether it has moved: what was seen on it before is of another place */
bool section_moves(section *section);
