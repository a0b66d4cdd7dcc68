/** The outputs of an integration that are still to come, on a grid of times or of positions. Private to integrate/. */
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
    output_mark mark; /**< if it goes by position */
} output_due;

void output_grid_begin(output_grid *grid, const dae *model, const integrate_options *options, const dae_state *start);
bool output_grid_goes_by_position(const output_grid *grid);
/** By time: when the next one is due; the last one is the end itself. */
double output_grid_next(const output_grid *grid);
/** The next output that lies in a step, but for the end itself. Of outputs by position the steps are all told, in order of time; those
 *  made anew from an earlier time give again no output that was given.
 *  @param room  a state with the integers of the step, and room for its y
 *  @return false if there is none */
bool output_grid_due(output_grid *grid, const integrate_step *step, dae_state *room, output_due *due);
/** How many outputs by time are due in a step, and when; what is left of t has the last of these times.
 *  @param most  no more are told, DAE_LANES or fewer */
int output_grid_ahead(const output_grid *grid, const integrate_step *step, int most, double t[DAE_LANES]);
/** Keep how far it is. */
void output_grid_keep(output_grid *grid, archive *archive);
/** That output was given: go on behind it. */
void output_grid_given(output_grid *grid, const output_due *due);
