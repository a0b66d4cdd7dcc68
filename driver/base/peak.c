#include "base/peak.h"

#include <math.h>
#include <stdbool.h>

double peak_of_parabola(const double t[3], const double f[3])
{
    const double slope_1 = (f[1] - f[0]) / (t[1] - t[0]), slope_2 = (f[2] - f[1]) / (t[2] - t[1]);
    const double bend = (slope_2 - slope_1) / (t[2] - t[0]);
    return bend < 0 ? 0.5 * (t[0] + t[1]) - 0.5 * slope_1 / bend : NAN;
}

/** Three ordered abscissae around x, x among them, inside the bracket. @return false if they do not differ */
static bool surround(const peak_bracket *bracket, double x, double max_width, double t[3])
{
    /* three widths fit into the bracket: x is at most one from its end, and two are beyond x */
    const double width = fmin(max_width, (bracket->right - bracket->left) / 3);
    double middle = x;
    if (x - width < bracket->left) {
        middle = x + width;
    } else if (x + width > bracket->right) {
        middle = x - width;
    }
    t[0] = middle > x ? x : fmax(middle - width, bracket->left);
    t[1] = middle;
    t[2] = middle < x ? x : fmin(middle + width, bracket->right);
    return t[0] < t[1] && t[1] < t[2];
}

void peak_climb(peak_function function, void *with, const peak_bracket *bracket)
{
    enum { MOST_TURNS = 6 };
    static const double small = 1e-12; /* relative to the value: gains of another iteration below it are negligible */
    static const double nearly =
        1e-3; /* relative to the value: how far below a peak the start may be without an expected value */
    double x = bracket->start, width = bracket->width, top = function(with, x);
    const double doubt = isnan(bracket->expected) ? nearly * fabs(top) : 3 * fabs(bracket->expected - top);
    if (!(bracket->right > bracket->left) || !(top + doubt + nearly * fabs(top) >= bracket->threshold)) {
        return;
    }
    for (int turn = 0; turn < MOST_TURNS; turn++) {
        double t[3], f[3];
        if (!surround(bracket, x, width, t)) {
            return;
        }
        for (int i = 0; i < 3; i++) {
            f[i] = t[i] < x || t[i] > x ? function(with, t[i]) : top;
        }
        const double peak = peak_of_parabola(t, f);
        if (isnan(peak)) {
            return;
        }
        const double to = fmin(fmax(peak, bracket->left), bracket->right);
        const double reached = function(with, to), moved = fabs(to - x);
        const bool gains = reached - top > small * fabs(top);
        x = to;
        top = reached;
        if (!gains) {
            return;
        }
        width = moved > width ? moved : fmax(0.1 * moved, 1e-2 * width);
    }
}
