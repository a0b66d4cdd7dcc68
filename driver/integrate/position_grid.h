/** Grid positions passed by a motion, and their times. Private to integrate/.
 *
 *  The position is a polynomial in each step. Its Bernstein coefficients bound it from both sides: a part of the step
 *  with monotonic coefficients has no turning point, other parts are halved. So a turn within a step is not missed. A
 *  short step that continues the one before is searched only if the grid is within several times the reach of both. */
#pragma once

#include "integrate/integrate_types.h"

typedef struct {
    const dae *model;
    int per_unit, position_of;
    double t_end;
    double t;        /**< end of the part already searched */
    double position; /**< position there, in steps of the grid: an integer on the grid */
    double speed;    /**< mean absolute speed in the previous step */
} position_grid;

void position_grid_begin(position_grid *grid, const dae *model, const integrate_options *options,
                         const dae_state *start);
/** The next position on the grid that a step passes before t_end, as in output_grid_due. */
bool position_grid_next(position_grid *grid, const integrate_step *step, dae_state *scratch, double *t,
                        output_mark *mark);
/** Serialise the state. */
void position_grid_serialize(position_grid *grid, archive *archive);
/** Mark the output as done. */
void position_grid_advance(position_grid *grid, double t, const output_mark *mark);
