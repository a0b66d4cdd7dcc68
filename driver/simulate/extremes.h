/** Extremes of the watched outputs over a run or a window of it. They are searched between the outputs, in every step
 *  of the integration, on both sides of every event. The kernel's table lists them. */
#pragma once

#include "integrate/integrate_types.h"
#include "model/model.h"

typedef struct extremes extremes;

/** @param from, to  the window [s], both ends included; infinite for the whole run */
extremes *extremes_create(const model *model, int n_meshes, double from, double to);
void extremes_delete(extremes **extremes);

/** Implementation of observer.monitor. */
void extremes_monitor(extremes *extremes, const integrate_step *step);

/** Serialise the results. */
void extremes_serialize(extremes *extremes, archive *archive);

/** Implementation of observer.highest: [n_monitored] largest value of each channel so far; infinite if not requested. */
const double *extremes_highest(const extremes *extremes);

/** An extreme of a mesh, and the time of its first occurrence [s]; NaN if no state was evaluated. */
typedef struct {
    double value, time;
} extreme_found;
/** @param index  in the table of extremes */
extreme_found extremes_found(extremes *extremes, int index, int mesh);
/** Index of an extreme in the table; -1 if there is none. */
int extremes_find(const char *output, bool is_largest);
