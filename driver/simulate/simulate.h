/** The integration of a prepared case, its outputs handed to whoever wants them: a history, statistics. */
#pragma once

#include "integrate/integrate_types.h"
#include "simulate/extremes.h"
#include "simulate/numbers.h"
#include "simulate/prepare.h"
#include "simulate/wanted.h"

#include <signal.h>

/** What is to come after a simulation was kept: SIMULATE_INTERRUPTED, or SIMULATE_SINK_FAILED. */
typedef enum { SIMULATE_GOES_ON, SIMULATE_STOPS, SIMULATE_FAILS } simulate_kept;

/** Where the outputs of a simulation go. A procedure that returns false ends the simulation with SIMULATE_SINK_FAILED. */
typedef struct {
    void *self;
    wanted_outputs *wanted; /**< of those that are told; the simulation adds what it looks at itself */
    bool waits;             /**< outputs may come late, and the simulation may end with SIMULATE_MISSED */
    bool (*outputs)(void *self, const output_block *block); /**< in order of time; events come in between */
    bool (*event)(void *self, const event_record *record);
    void (*step)(void *self, double t); /**< now and then, between steps: how far it is; NULL: nobody asks */
    const volatile sig_atomic_t
        *interrupt;     /**< ends it when it is not 0; NULL: the number of a signal to the process */
    extremes *extremes; /**< to be found between the outputs; NULL: none */
    numbers *numbers;   /**< the same; NULL: none. With them there are extremes */
    /** As of integrate_observer: a simulation that can go on later. NULL: it cannot. Then a signal does not end it: it makes it due */
    bool (*is_due)(void *self, double t);
    void (*keep)(void *self, archive *archive);
    simulate_kept (*kept)(void *self, double t, const archive *archive);
    bool keeps_spent; /**< with these, also where its steps are over */
    archive *resume;
} simulate_sink;

typedef enum {
    SIMULATE_DONE,
    SIMULATE_FAILED,      /**< the integration, the model, or a window without a whole period; the message says why */
    SIMULATE_INTERRUPTED, /**< by a signal, or by a sink that kept it */
    SIMULATE_MISSED, /**< an output that came late shows that an event was missed: simulate again without waiting */
    SIMULATE_SINK_FAILED
} simulate_end;

typedef struct {
    simulate_end end;
    double t; /**< where it ended [s] */
    integrate_counts counts;
    char message[DAE_MESSAGE_LENGTH]; /**< of SIMULATE_FAILED */
    bool can_go_on;                   /**< of SIMULATE_FAILED: it was kept where its steps were over */
    /** What deserves a word at the end: contact lost for good, a vibration that feeds itself, a motion too short for its outputs
     *  by position; "" if nothing does. */
    char remark[DAE_MESSAGE_LENGTH];
    /** Energy that appeared or got lost, over what was put in or is there; NaN if that is nothing. */
    double energy_residual;
    bool held;                           /**< whether it kept its invariants at all its outputs */
    char invariants[DAE_MESSAGE_LENGTH]; /**< "held", or "broken: " and which ones by how much */
} simulate_result;

/** The integrator's options that a case asks for. */
integrate_options simulate_options(const prepared_case *prepared);

/** Integrate from `state`, which is that of the end afterwards. A simulation that ends early hands over its last good state too,
 *  if its outputs exist. */
void simulate(const prepared_case *prepared, const simulate_sink *sink, dae_state *state, simulate_result *result);
