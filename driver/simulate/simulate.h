/** Integration of a planned case; outputs are passed to consumers such as a history or statistics. */
#pragma once

#include "simulate/case_plan.h"
#include "simulate/extremes.h"
#include "simulate/requested_outputs.h"

#include <signal.h>

/** Continuation after a checkpoint was written: SIMULATE_STOPS ends with SIMULATE_INTERRUPTED, SIMULATE_FAILS with
 *  SIMULATE_SINK_FAILED. */
typedef enum { SIMULATE_GOES_ON, SIMULATE_STOPS, SIMULATE_FAILS } simulate_checkpoint_outcome;

/** Consumer of the outputs of a simulation. A procedure that returns false ends the simulation with
 *  SIMULATE_SINK_FAILED. */
typedef struct {
    void *self;
    requested_outputs *requested; /**< requested outputs; the simulation adds those of its own monitors */
    bool waits;                   /**< outputs may be delayed, and the simulation may end with SIMULATE_MISSED */
    bool (*outputs)(void *self, const output_block *block); /**< in order of time, interleaved with events */
    bool (*event)(void *self, const event_record *record);
    void (*step)(void *self, double t); /**< called occasionally between steps, for progress; NULL: not called */
    const volatile sig_atomic_t
        *interrupt;     /**< ends it when it is not 0; NULL: the number of a signal to the process */
    extremes *extremes; /**< extremes to search between the outputs; NULL: none */
    metrics *metrics;   /**< metrics to compute; NULL: none. They require extremes */
    /** As in integrate_observer: checkpoints of a simulation that can be resumed. NULL: none. With them a signal does
     *  not end the simulation but makes a checkpoint due */
    bool (*is_due)(void *self, double t);
    void (*serialize)(void *self, archive *archive);
    simulate_checkpoint_outcome (*write_checkpoint)(void *self, double t, const archive *archive);
    bool checkpoint_at_limit; /**< with these: also at the step limit */
    archive *resume;
} simulate_sink;

typedef enum {
    SIMULATE_DONE,
    SIMULATE_FAILED,      /**< the integration, the model, or a window without a whole period; see `message` */
    SIMULATE_INTERRUPTED, /**< by a signal, or by a sink after a checkpoint */
    SIMULATE_MISSED,      /**< a delayed output shows that an event was missed: repeat the simulation without delay */
    SIMULATE_SINK_FAILED
} simulate_end;

typedef struct {
    simulate_end end;
    double t; /**< time of the end [s] */
    integrate_counts counts;
    char message[DAE_MESSAGE_LENGTH]; /**< of SIMULATE_FAILED */
    bool can_go_on;                   /**< of SIMULATE_FAILED: a checkpoint was written at the step limit */
    /** Warning at the end: contact permanently lost, a self-excited vibration, a motion too short for its outputs by
     *  position; "" if there is none. */
    char remark[DAE_MESSAGE_LENGTH];
    /** Error of the energy balance, relative to the energy put in or stored; NaN if that is zero. */
    double energy_residual;
    bool held;                           /**< whether the invariants hold at all outputs */
    char invariants[DAE_MESSAGE_LENGTH]; /**< "held", or "broken: " and the broken invariants with their errors */
} simulate_result;

/** Integrate from a start. A simulation that ends early also passes on its last valid state if its outputs exist. */
void simulate(const case_plan *plan, const simulate_sink *sink, const dae_state *start, simulate_result *result);
