/** The extremes of the watched outputs over a run, or over a window of it: found between the outputs, from every step of the
 *  integration, on both sides of every event. The kernel's table says which there are. */
#pragma once

#include "integrate/integrate_types.h"
#include "model/model.h"

typedef struct extremes extremes;

/** @param from, to  the window [s], both ends included; infinite for the whole run */
extremes *extremes_create(const model *model, int n_meshes, double from, double to);
void extremes_delete(extremes **extremes);

/** What observer.watch hears. */
void extremes_watch(extremes *extremes, const integrate_step *step);

/** Keep what was found. */
void extremes_keep(extremes *extremes, archive *archive);

/** What observer.highest is: [n_watched] the largest of each channel so far; infinite where nobody asks. */
const double *extremes_highest(const extremes *extremes);

/** An extreme of a mesh, and when it was first reached [s]; NaN if nothing was seen. */
typedef struct {
    double value, time;
} extreme_found;
/** @param index  in the table of extremes */
extreme_found extremes_found(extremes *extremes, int index, int mesh);
/** Place of an extreme in the table; -1 if there is none. */
int extremes_find(const char *output, bool is_largest);
