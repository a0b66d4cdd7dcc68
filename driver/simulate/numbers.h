/** Metrics of a case over a window of whole pitches or revolutions, computed during the run: integrals between the
 *  events by quadrature of the dense output, independent of the output grid. number_rows.h lists them. */
#pragma once

#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/number_rows.h"
#include "simulate/settled.h"

/** The window starts at the first start of a period after `from`, and ends at the last end of a period before `to`. */
typedef struct {
    double from, to; /**< [s] */
    int mesh;        /**< a period is a pitch of this mesh, counted from the start of contact of its tooth pair 0 */
    int wheel;       /**< if not -1, a period is a revolution of this wheel from its start instead */
    double begins;   /**< position within the pitch or revolution where a period starts, in 0 .. 1 */
} number_window;

typedef struct numbers numbers;

/** @param taken  [N_NUMBER_ROWS] requested rows; others may be NaN */
numbers *numbers_create(const model *model, const number_window *window, const bool *taken);
void numbers_delete(numbers **numbers);
/** Process a step of the integration; implementation of observer.watch, in order of time. */
void numbers_watch(numbers *numbers, const integrate_step *step);
/** Serialise the results so far. */
void numbers_keep(numbers *numbers, archive *archive);
void numbers_event(numbers *numbers, const event_record *record);

/** Record the start of the run, before its first step. @param is_periodic  it starts on its periodic orbit */
void numbers_start(numbers *numbers, const dae_state *start, bool is_periodic);
/** Judge at the end of the run whether the motion settled before the window. */
void numbers_judge(numbers *numbers);

const number_settled *numbers_settled(const numbers *numbers);

/** The evaluated window. */
typedef struct {
    double from, to; /**< [s] */
    long periods;    /**< complete ones; 0: no metrics */
    double begun;    /**< distance covered in the window [periods] */
} number_span;
number_span numbers_span(const numbers *numbers);
/** [as number_rows_place assigns them] NaN if not available. */
void numbers_conclude(const numbers *numbers, double *values);
/** The reason why there are no metrics, one sentence; "" if there are. The names are the model's. */
void numbers_explain(const numbers *numbers, char *text, size_t size);
