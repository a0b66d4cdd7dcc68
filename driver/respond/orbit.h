/** Settled motion of a gearbox from a state: followed until it repeats on the section, or for a limited time, with its
 *  metrics. */
#pragma once

#include "respond/section.h"
#include "respond/settling.h"
#include "respond/state_transfer.h"
#include "simulate/case_plan.h"

#include <signal.h>

enum { ORBIT_WINDOW = 64 };

typedef struct {
    int period; /**< common periods after which it repeats, 1 to 16; 0: it does not; RESPONSE_SETTLING: not yet settled */
    int periods;     /**< number of common periods that it was followed */
    int pitches;     /**< of the first mesh in a common period */
    double distance; /**< largest difference of a state after one orbit, in its unit; aperiodic: least of all lengths */
    double time;     /**< of one orbit [s]; 0: it does not repeat */
    double common_time;   /**< of a common period [s] */
    double time_constant; /**< of the slowest damped mode [s]; NAN: unknown */
} orbit_result;

typedef enum { ORBIT_FOUND, ORBIT_FAILED, ORBIT_INTERRUPTED } orbit_end;

/** Follow the motion.
 *  @param state    initial state of this gearbox; becomes the last one on the section
 *  @param most     common periods; 0: the default
 *  @param interrupt  ends it when it is not 0; NULL: the number of a signal to the process
 *  @param values   metrics, as metric_rows_lay_out assigns them
 *  @param message  reason of a failure */
orbit_end orbit_find(const case_plan *plan, const model_period *period, state_transfer *state, int most,
                     const volatile sig_atomic_t *interrupt, orbit_result *result, double *values,
                     char message[DAE_MESSAGE_LENGTH]);
/** Metrics of a known orbit.
 *  @param state   any state on it
 *  @param periods common periods after which it repeats
 *  @param time    of a common period [s]
 *  @param is_stable  a run remains near it: the default tolerance is sufficient
 *  @param interrupt  as in orbit_find
 *  @param round   becomes the state after these periods without y', at its time, shifted back to the start; may be
 *                 `state`; NULL: not requested */
orbit_end orbit_record(const case_plan *plan, const model_period *period, const dae_state *state, int periods,
                       double time, bool is_stable, const volatile sig_atomic_t *interrupt, dae_state *round,
                       double *values, char message[DAE_MESSAGE_LENGTH]);
