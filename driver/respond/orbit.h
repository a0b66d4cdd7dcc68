/** The motion that a gearbox comes to from a state: until it repeats on the section, or for so long, and its numbers. */
#pragma once

#include "respond/section.h"
#include "simulate/prepare.h"

#include <signal.h>

enum { ORBIT_LONGEST = 16, ORBIT_USUAL_PERIODS = 600, ORBIT_WINDOW = 64, ORBIT_LEAST_PERIODS = 100 };

/** A state that goes from one gearbox to the next: it lies within one common period of the start. */
typedef struct {
    bool exists;
    dae sizes;       /**< of the gearbox that it was of: only numbers of states, integers and reals count */
    dae_state state; /**< its arrays belong to it */
    double pitches;  /**< of the first mesh to its time, where a speed is prescribed */
    double phase;    /**< of the section */
} carried;

void carried_free(carried *carried);
/** Make one that of another. */
void carried_copy(carried *to, const carried *from);
/** Keep it; of one that is read the sizes are those that were kept. */
void carried_keep(carried *carried, archive *archive);

typedef struct {
    int period;  /**< common periods after which it repeats, 1 to 16; 0: it does not */
    int periods; /**< how many common periods it was followed */
    int pitches; /**< of the first mesh in a common period */
    double
        distance; /**< largest difference of a state to that of one orbit before, in its unit; of one that does not repeat the least
                          of all orbits that were tried */
    double time; /**< of one orbit [s]; 0: it does not repeat */
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
