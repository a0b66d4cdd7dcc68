/** Where a function passes zero. */
#pragma once

/** Between two places, at which its signs differ: by secants that keep the bracket (Illinois; M. Dowell and P. Jarratt, BIT 11, 1971).
 *  @param f        of `self` and a place; what is no number ends the search there
 *  @param f_a,f_b  its values at t_a and t_b
 *  @param close    what is as good as zero */
double secant_zero(double (*f)(void *self, double t), void *self, double t_a, double f_a, double t_b, double f_b,
                   double close);
