/** Range of the root stress of each wheel over a window: the greatest difference between the largest and the least stress at
 *  one point of a fillet, over all teeth. Equation RS9. */
#pragma once

#include "simulate/step_nodes.h"

typedef struct {
    int n_wheels; /**< 0: not requested */
    int most;     /**< teeth with space in `values` */
    const model *model;
    double *values;         /**< [most * 2 fillets * points * nodes] of a wheel */
    double *period, *total; /**< [n_wheels * 2 fillets * points * 2] largest and least stress of each point */
} root_ranges;

/** @param n_wheels  with outputs of the root stress at the nodes. @param arena  owns the arrays */
void root_ranges_init(root_ranges *ranges, const model *model, bool is_requested, int n_wheels, memory_arena *arena);
void root_ranges_serialize(root_ranges *ranges, archive *archive);
/** Add the part of a step whose nodes were evaluated. */
void root_ranges_add(root_ranges *ranges, const step_nodes *nodes);
/** Add the present period to the total. */
void root_ranges_complete(root_ranges *ranges);
/** Range of a wheel [Pa]; NaN if there is none. */
double root_ranges_of(const root_ranges *ranges, int wheel);
