#include "base/secant.h"

#include <math.h>

enum { MOST = 60 };

double secant_zero(double (*f)(void *self, double t), void *self, double t_a, double f_a, double t_b, double f_b,
                   double close)
{
    double t = t_b;
    for (int i = 0; i < MOST; i++) {
        t = t_b - f_b * (t_b - t_a) / (f_b - f_a);
        const double value = f(self, t);
        if (!(fabs(value) > close)) {
            break;
        }
        if ((value > 0) == (f_b > 0)) {
            f_a *= 0.5;
        } else {
            t_a = t_b;
            f_a = f_b;
        }
        t_b = t;
        f_b = value;
    }
    return t;
}
