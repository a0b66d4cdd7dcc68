/** Settling time of a motion, from the modes at the mean mesh stiffness, and check whether it settles.
 *  docs/guides/response.md. */
#pragma once

#include "model/model.h"

#include <stdbool.h>

/** Common periods: longest orbit; default limit of a motion, in pitches, and its minimum. */
enum { ORBIT_LONGEST = 16, ORBIT_USUAL_PERIODS = 600, ORBIT_LEAST_PERIODS = 100 };

typedef struct {
    double slowest;   /**< largest time constant of the damped modes [s]; 0: unknown */
    double half_turn; /**< longest half period of a damped oscillation [s]; 0: there is none */
} settling_times;

/** Settling times of a gearbox; both are 0 if it has no steady state. */
settling_times settling_of(const model *model);
/** Limit of common periods of a motion: a multiple of the slowest time constant, or the default if that is larger.
 *  @param pitches, time  of a common period, in pitches of the first mesh and in s */
int settling_most(const settling_times *times, int pitches, double time);

/** Distances on the section during a motion. */
typedef struct {
    settling_times times;
    double repeats;              /**< distance below which states are regarded as equal */
    bool is_open;                /**< the number of common periods follows from the time constants */
    bool is_on_orbit;            /**< the motion started on an orbit: there is no transient */
    int pitches;                 /**< of the first mesh in a common period */
    int window;                  /**< common periods at the end that metrics may need */
    int last;                    /**< common periods after which the motion is judged */
    int turn;                    /**< common periods in the longest half period of an oscillation */
    int calm[ORBIT_LONGEST + 1]; /**< [orbit] consecutive sections with distances that the slowest mode allows */
    double largest[2][ORBIT_LONGEST + 1]; /**< [quarter][orbit] largest distances in the last two quarters */
} settling;

/** @param most     common periods; 0: as settling_most returns
 *  @param pitches  of the first mesh in a common period
 *  @param time     of a common period [s]; the actual ones follow
 *  @param window   common periods at the end that metrics may need */
void settling_begin(settling *settling, const settling_times *times, double repeats, int most, int pitches, double time,
                    int window);
/** Reset the distances after a move of the section. */
void settling_restart(settling *settling);
/** Process a section.
 *  @param periods   common periods so far
 *  @param time      of a common period [s]
 *  @param distances [ORBIT_LONGEST + 1] to the states 1, 2, ... common periods before; NAN: unknown */
void settling_pass(settling *settling, int periods, double time, const double *distances);
/** Whether the time constant of the slowest mode is many common periods. @param time  of one [s] */
bool settling_is_slow(const settling *settling, double time);
/** Whether the slowest mode has decayed, for the motion as an orbit of this number of common periods. */
bool settling_is_calm(const settling *settling, int orbit);
/** Whether a motion that does not repeat is still settling. @param time  that it was followed [s] */
bool settling_goes_on(const settling *settling, double time);
