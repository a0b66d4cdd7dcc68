/** Poincaré section of a motion: one position in each common period, away from events.
 *
 *  The position is counted in pitches of the first mesh: by time with a prescribed speed, 0 at t = 0; else by the angle
 *  of its driving wheel, as in model_position_of. */
#pragma once

#include "base/memory.h"
#include "integrate/integrate_types.h"
#include "model/model_period.h"

typedef struct {
    const model *model;
    model_period period;
    int position_of; /**< index of the position that counts the pitches of the first mesh */
    double phase;    /**< position of the section, from 0 to period.pitches [pitches] */
    double target;   /**< of the next section, a position that increases from period to period */
    double here;     /**< of the last section; NAN: none yet */
    double event;    /**< position of the last event; NAN: none yet */
    bool is_crossed; /**< an event is too close */
    int n_moves;     /**< number of moves away from events */
    memory_arena *arena;
    dae_state scratch;   /**< owns its arrays */
    int n_now, n_before; /**< events of this period and of the previous one, limited by capacity */
    int capacity;
    double *now, *before; /**< [capacity] */
} section;

/** Initial position of the section: in most cases there is no event at this phase. */
#define SECTION_USUAL_PHASE 0.5

/** @param phase  position of the section
 *  @param state  initial state of the motion: the next section is behind it */
void section_begin(section *section, memory_arena *arena, const model *model, const model_period *period, double phase,
                   const dae_state *state);
/** Position of a state. */
double section_position(const section *section, const dae_state *state);
/** Pitch rate of a motion by angle [1/s]. */
double section_pitch_rate(const section *section, const dae_state *state);
/** Whether a step reaches the next section. @param state  with space for all arrays: becomes the state there */
bool section_reached(section *section, const integrate_step *step, dae_state *state);
/** Advance to the next section after one was reached. */
void section_passed(section *section);
/** Process an event. */
void section_event(section *section, const event_record *record);
/** If an event is within 1e-6 pitches of the section, move the section to the middle of the longest interval between
 *  two events. @return whether it moved: earlier states belong to another position */
bool section_moves(section *section);
