/** Metrics of a case over a window of whole pitches or revolutions, computed during the run: integrals between the
 *  events by quadrature of the dense output, independent of the output grid. metric_rows.h lists them. */
#pragma once

#include "integrate/integrate_types.h"
#include "model/model.h"
#include "simulate/metric_rows.h"
#include "simulate/settled.h"

/** The window starts at the first start of a period after `from`, and ends at the last end of a period before `to`. */
typedef struct {
    double from, to; /**< [s] */
    int mesh;        /**< a period is a pitch of this mesh, counted from the start of contact of its tooth pair 0 */
    int wheel;       /**< if not -1, a period is a revolution of this wheel from its start instead */
    double begins;   /**< position within the pitch or revolution where a period starts, in 0 .. 1 */
} metric_window;

typedef struct metrics metrics;

/** @param taken  [N_METRIC_ROWS] requested rows; others may be NaN */
metrics *metrics_create(const model *model, const metric_window *window, const bool *taken);
void metrics_delete(metrics **metrics);
/** Process a step of the integration; implementation of observer.monitor, in order of time. */
void metrics_monitor(metrics *metrics, const integrate_step *step);
/** Serialise the results so far. */
void metrics_serialize(metrics *metrics, archive *archive);
void metrics_event(metrics *metrics, const event_record *record);

/** Record the start of the run, before its first step. @param is_periodic  it starts on its periodic orbit */
void metrics_start(metrics *metrics, const dae_state *start, bool is_periodic);
/** Judge at the end of the run whether the motion settled before the window. */
void metrics_judge(metrics *metrics);

const settled_result *metrics_settled(const metrics *metrics);

/** The evaluated window. */
typedef struct {
    double from, to; /**< [s] */
    long periods;    /**< complete ones; 0: no metrics */
    double begun;    /**< distance covered in the window [periods] */
} metric_span;
metric_span metrics_span(const metrics *metrics);
/** [as metric_rows_lay_out assigns them] NaN if not available. */
void metrics_conclude(const metrics *metrics, double *values);
/** The reason why there are no metrics, one sentence; "" if there are. The names are the model's. */
void metrics_explain(const metrics *metrics, char *text, size_t size);
