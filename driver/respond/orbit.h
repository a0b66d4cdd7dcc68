/** The motion that a gearbox comes to from a state: until it repeats on the section, or for so long, and its numbers. */
#pragma once

#include "respond/carried.h"
#include "respond/section.h"
#include "respond/settling.h"
#include "simulate/prepare.h"

#include <signal.h>

enum { ORBIT_WINDOW = 64 };

typedef struct {
    int period; /**< common periods after which it repeats, 1 to 16; 0: it does not; RESPONSE_SETTLING: it still settles */
    int periods; /**< how many common periods it was followed */
    int pitches; /**< of the first mesh in a common period */
    double
        distance; /**< largest difference of a state to that of one orbit before, in its unit; of one that does not repeat the least
                          of all orbits that were tried */
    double time;          /**< of one orbit [s]; 0: it does not repeat */
    double common_time;   /**< of a common period [s] */
    double time_constant; /**< of the slowest damped mode [s]; NAN: not known */
} orbit_result;

typedef enum { ORBIT_FOUND, ORBIT_FAILED, ORBIT_INTERRUPTED } orbit_end;

/** Follow the motion.
 *  @param state    from where, of this gearbox; becomes the last one on the section
 *  @param most     common periods; 0: the usual number
 *  @param interrupt  ends it when it is not 0; NULL: the number of a signal to the process
 *  @param values   numbers, as number_rows_place places them
 *  @param message  why it failed */
orbit_end orbit_find(const prepared_case *prepared, const model_period *period, carried *state, int most,
                     const volatile sig_atomic_t *interrupt, orbit_result *result, double *values,
                     char message[DAE_MESSAGE_LENGTH]);
/** The numbers of an orbit that is known.
 *  @param state   on it, at any place
 *  @param periods common periods after which it repeats
 *  @param time    of a common period [s]
 *  @param is_stable  a run stays near it: a usual tolerance will do
 *  @param interrupt  as of orbit_find
 *  @param round   becomes the state after these periods without y', at its time, taken back to where it began; may be `state`; NULL: not
 *  wanted */
orbit_end orbit_tell(const prepared_case *prepared, const model_period *period, const dae_state *state, int periods,
                     double time, bool is_stable, const volatile sig_atomic_t *interrupt, dae_state *round,
                     double *values, char message[DAE_MESSAGE_LENGTH]);
