/** Which positions of a grid a motion passes, and when. Private to integrate/.
 *
 *  The position is a polynomial in each step. Its coefficients in Bernstein's form bound it from both sides: a part of the step in
 *  which they rise or fall all the way has no turning point, others are halved. So a turn within a step is not missed. A short step
 *  that goes on from one before is searched only if the grid is within several times the reach of both. */
#pragma once

#include "integrate/integrate_types.h"

typedef struct {
    const dae *model;
    int per_unit, position_of;
    double t_end;
    double t;     /**< up to here it is known what was passed */
    double place; /**< there, in steps of the grid: whole on it */
    double speed; /**< mean one of the step before, either way */
} position_grid;

void position_grid_begin(position_grid *grid, const dae *model, const integrate_options *options,
                         const dae_state *start);
/** The next position on the grid that a step passes before t_end, as of output_grid_due. */
bool position_grid_next(position_grid *grid, const integrate_step *step, dae_state *room, double *t, output_mark *mark);
/** Keep how far it is. */
void position_grid_keep(position_grid *grid, archive *archive);
/** It was given. */
void position_grid_given(position_grid *grid, double t, const output_mark *mark);
