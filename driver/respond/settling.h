/** How long a motion takes to settle, by the modes at the mean mesh stiffness, and whether it does. docs/response.md. */
#pragma once

#include "model/model.h"

#include <stdbool.h>

/** Common periods: of an orbit at most; that a motion is followed at most if nothing is said, in pitches and at least. */
enum { ORBIT_LONGEST = 16, ORBIT_USUAL_PERIODS = 600, ORBIT_LEAST_PERIODS = 100 };

typedef struct {
    double slowest;   /**< largest time constant of the damped modes [s]; 0: not known */
    double half_turn; /**< longest half period of a damped oscillation [s]; 0: there is none */
} settling_times;

/** Times of a gearbox; both are 0 if it has no steady state. */
settling_times settling_of(const model *model);
/** Common periods that a motion is followed at most: time constants of the slowest mode, or the usual number if that is more.
 *  @param pitches, time  of a common period, in pitches of the first mesh and in s */
int settling_most(const settling_times *times, int pitches, double time);

/** The distances on the section, as the motion goes on. */
typedef struct {
    settling_times times;
    double repeats;   /**< distance below which states are the same */
    bool is_open;     /**< the number of common periods follows from the time constants */
    bool is_on_orbit; /**< the motion began on an orbit: nothing has to settle */
    int pitches;      /**< of the first mesh in a common period */
    int window;       /**< common periods at the end that numbers may need */
    int last;         /**< common periods after which the motion is judged */
    int turn;         /**< common periods in the longest half period of an oscillation */
    int calm[ORBIT_LONGEST +
             1]; /**< [orbit] sections one after the other with distances that the slowest mode allows */
    double largest[2][ORBIT_LONGEST + 1]; /**< [quarter][orbit] largest distances in the last two quarters */
} settling;

/** @param most     common periods; 0: as many as settling_most says
 *  @param pitches  of the first mesh in a common period
 *  @param time     of a common period [s]; the real ones follow
 *  @param window   common periods at the end that numbers may need */
void settling_begin(settling *settling, const settling_times *times, double repeats, int most, int pitches, double time,
                    int window);
/** The section has moved: distances begin anew. */
void settling_restart(settling *settling);
/** A section was passed.
 *  @param periods   common periods so far
 *  @param time      of a common period [s]
 *  @param distances [ORBIT_LONGEST + 1] to so many common periods before; NAN: not known */
void settling_pass(settling *settling, int periods, double time, const double *distances);
/** Whether the time constant of the slowest mode is many common periods. @param time  of one [s] */
bool settling_is_slow(const settling *settling, double time);
/** Whether nothing of the slowest mode is left, of the motion as an orbit of so many common periods. */
bool settling_is_calm(const settling *settling, int orbit);
/** Whether a motion that does not repeat still settles. @param time  that it was followed [s] */
bool settling_goes_on(const settling *settling, double time);
