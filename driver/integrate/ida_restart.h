/** How long the first step after an event may be. IDA begins anew with order 1, makes a step that fails a quarter of what it was,
 *  and goes up in order and step each time only until one has failed. Private to integrate/. */
#pragma once

#include <sundials/sundials_nvector.h>

typedef struct {
    double
        could; /**< what the first step after the last restart could have been, by its error; INFINITY: not known [s] */
} ida_restart;

ida_restart ida_restart_create(void);
/** Look at the first step that IDA has made since the last restart, if it has made one and not two.
 *  @param weights  with which it was accepted
 *  @param errors   [n] to work in */
void ida_restart_note(ida_restart *restart, void *ida, N_Vector weights, N_Vector errors);
/** The first step of the next one, at most `longest`. */
double ida_restart_step(const ida_restart *restart, double longest);
