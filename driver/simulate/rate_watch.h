/** Reported rates, compared with the changes of what they are rates of, in some steps of a run: docs/theory.md, "Rates".
 *
 *  Two formulas state a rate: that of the integrator, and that of the outputs. In a step that is looked at
 *  - both evaluations of the outputs are compared, of eight states at once and of one, and both formulas of every load;
 *  - the integral of every rate over the step is compared with the change of the output that it is the rate of.
 *  A difference is a defect of the program: the run fails. */
#pragma once

#include "base/archive.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

#include <stdbool.h>

typedef struct rate_watch rate_watch;

/** @param tolerance  of the case: errors of the integrator allow a multiple of it */
rate_watch *rate_watch_create(const model *model, double tolerance);
void rate_watch_delete(rate_watch **watch);
/** Keep what was seen. */
void rate_watch_keep(rate_watch *watch, archive *archive);
/** A step, in order of time. */
void rate_watch_step(rate_watch *watch, const integrate_step *step);
/** An event: the next step has other formulas. */
void rate_watch_event(rate_watch *watch);
/** Two formulas gave different values in a step that was looked at. @return the sentence that says so; NULL: none did */
const char *rate_watch_conflict(const rate_watch *watch);
/** Compare the integrals of the whole run with the largest changes. @return as of rate_watch_conflict */
const char *rate_watch_conclude(rate_watch *watch);
