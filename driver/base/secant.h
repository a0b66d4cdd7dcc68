/** Zero of a function of one variable. */
#pragma once

/** Zero between two abscissae at which the signs differ, by bracketing secants (Illinois; M. Dowell and P. Jarratt, BIT
 *  11, 1971).
 *  @param f        function of `self` and an abscissa; a NaN ends the search there
 *  @param f_a,f_b  its values at t_a and t_b
 *  @param close    magnitude that counts as zero */
double secant_zero(double (*f)(void *self, double t), void *self, double t_a, double f_a, double t_b, double f_b,
                   double close);
