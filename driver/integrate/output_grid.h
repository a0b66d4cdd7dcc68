/** Remaining outputs of an integration, on a grid of times or of positions. Private to integrate/. */
#pragma once

#include "integrate/position_grid.h"

typedef struct {
    const integrate_options *options;
    double t_start;
    long next;               /**< by time: index of the next one */
    position_grid positions; /**< by position */
} output_grid;

/** An output in a step. */
typedef struct {
    double t;
    bool has_mark;
    output_mark mark; /**< if by position */
} output_due;

void output_grid_begin(output_grid *grid, const dae *model, const integrate_options *options, const dae_state *start);
bool output_grid_goes_by_position(const output_grid *grid);
/** By time: time of the next output; the last one is the end. */
double output_grid_next(const output_grid *grid);
/** The next output in a step, except the end. For outputs by position, pass all steps in order of time; repeated steps
 *  from an earlier time do not return earlier outputs again.
 *  @param scratch  a state with the integers of the step, and space for its y
 *  @return false if there is none */
bool output_grid_due(output_grid *grid, const integrate_step *step, dae_state *scratch, output_due *due);
/** Number and times of the outputs by time in a step; unused elements of t repeat the last of these times.
 *  @param most  largest number to return, at most DAE_LANES */
int output_grid_ahead(const output_grid *grid, const integrate_step *step, int most, double t[DAE_LANES]);
/** Serialise the position in the grid. */
void output_grid_serialize(output_grid *grid, archive *archive);
/** Mark that output as done and advance to the next one. */
void output_grid_advance(output_grid *grid, const output_due *due);
