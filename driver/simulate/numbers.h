/** The numbers of a case over a window of whole pitches or turns, found while it runs: integrals between the events by quadrature of
 *  the dense output, so that they depend on no output. number_rows.h says which there are. */
#pragma once

#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/number_rows.h"
#include "simulate/settled.h"

/** The window begins where a period does for the first time after `from`, and ends where the last one does before `to`. */
typedef struct {
    double from, to; /**< [s] */
    int mesh;  /**< a period is a pitch of this mesh, counted from where its tooth pair 0 is at the start of contact */
    int wheel; /**< or, if it is not -1, a turn of this wheel from its start */
    double begins; /**< where in it a period begins, in 0 .. 1 */
} number_window;

typedef struct numbers numbers;

/** @param taken  [N_NUMBER_ROWS] which rows are wanted: the others may be NaN */
numbers *numbers_create(const model *model, const number_window *window, const bool *taken);
void numbers_delete(numbers **numbers);
/** Every step of the integration, in order of time, as observer.watch hears it. */
void numbers_watch(numbers *numbers, const integrate_step *step);
/** Keep what was found so far. */
void numbers_keep(numbers *numbers, archive *archive);
void numbers_event(numbers *numbers, const event_record *record);

/** Remember where the run starts, before its first step. @param is_periodic  it starts on its periodic orbit */
void numbers_start(numbers *numbers, const dae_state *start, bool is_periodic);
/** Judge whether the motion has settled before the window, when the run has ended. */
void numbers_judge(numbers *numbers);

const number_settled *numbers_settled(const numbers *numbers);

/** What the window came to. */
typedef struct {
    double from, to; /**< [s] */
    long periods;    /**< complete ones; 0: there is no number */
    double begun;    /**< how much of a period there was */
} number_span;
number_span numbers_span(const numbers *numbers);
/** [as number_rows_place places them] NaN where there is none. */
void numbers_conclude(const numbers *numbers, double *values);
/** Why there are none, one sentence; "" if there are. `names` of the model. */
void numbers_explain(const numbers *numbers, char *text, size_t size);
