/** Check of reported rates against the changes of the integrated quantities, in some steps of a run: docs/theory/theory.md,
 *  "Rates".
 *
 *  A rate has two formulas: that of the integrator, and that of the outputs. Checks in a step:
 *  - the evaluations of the outputs for eight states at once and for one agree, and so do both formulas of every load;
 *  - the integral of every rate over the step agrees with the change of its quantity.
 *  A difference is a defect of the program: the run fails. */
#pragma once

#include "base/archive.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stdbool.h>

typedef struct rate_monitor rate_monitor;

/** @param tolerance  of the case: the permitted error is a multiple of it */
rate_monitor *rate_monitor_create(const model *model, double tolerance);
void rate_monitor_delete(rate_monitor **monitor);
/** Serialise the monitor. */
void rate_monitor_serialize(rate_monitor *monitor, archive *archive);
/** Process a step, in order of time. */
void rate_monitor_step(rate_monitor *monitor, const integrate_step *step);
/** Process an event: the next step has other formulas. */
void rate_monitor_event(rate_monitor *monitor);
/** Conflict of two formulas in a checked step. @return a sentence that describes it; NULL: none */
const char *rate_monitor_conflict(const rate_monitor *monitor);
/** Compare the integrals of the whole run with the largest changes. @return as rate_monitor_conflict */
const char *rate_monitor_conclude(rate_monitor *monitor);
