/** Kinds of load and of support as a model may offer them, for the tests of the case file. */
#ifndef EVOLVENT_TESTS_LOAD_KINDS_H
#define EVOLVENT_TESTS_LOAD_KINDS_H

#include "case/description.h"

#include <math.h>

enum { LOAD_TORQUE, LOAD_VISCOUS, LOAD_TABLE, LOAD_SPEED, LOAD_KINDS };

/* clang-format off */
#define ANY .minimum = -HUGE_VAL, .maximum = HUGE_VAL
static const kind_info load_kinds[LOAD_KINDS] = {
    {.name = "torque", .text = "constant", .n_parameters = 1,
     .parameters = {{.name = "value", .units = "N m", .text = "M", .required = true, ANY}}},
    {.name = "viscous", .text = "against the speed", .n_parameters = 1,
     .parameters = {{.name = "coefficient", .units = "N m s/rad", .text = "d", .required = true, .maximum = HUGE_VAL}}},
    {.name = "table", .text = "over time", .n_parameters = 2,
     .parameters = {{.name = "time", .units = "s", .text = "t", .shape = SHAPE_KNOTS, .required = true, ANY},
                    {.name = "torque", .units = "N m", .text = "M", .shape = SHAPE_AT_KNOTS, .required = true, ANY}}},
    {.name = "speed", .text = "prescribed", .n_parameters = 3,
     .parameters = {{.name = "value", .units = "rad/s", .text = "w", .default_value = NAN, ANY},
                    {.name = "time", .units = "s", .text = "t", .shape = SHAPE_KNOTS, .default_value = NAN, ANY},
                    {.name = "speed", .units = "rad/s", .text = "w", .shape = SHAPE_AT_KNOTS, .default_value = NAN, ANY}}},
};
enum { SUPPORT_FIXED, SUPPORT_SLIDER, SUPPORT_BEARING, SUPPORT_KINDS };
#define NOT_NEGATIVE .maximum = HUGE_VAL
static const kind_info support_kinds[SUPPORT_KINDS] = {
    {.name = "fixed", .text = "at rest"},
    {.name = "slider", .text = "in one direction", .n_parameters = 4,
     .parameters = {{.name = "direction", .units = "deg", .text = "a", .minimum = -360, .maximum = 360},
                    {.name = "mass", .units = "kg", .text = "m", NOT_NEGATIVE},
                    {.name = "stiffness", .units = "N/m", .text = "k", .required = true, NOT_NEGATIVE},
                    {.name = "damping", .units = "N s/m", .text = "d", NOT_NEGATIVE}}},
    {.name = "bearing", .text = "in two", .n_parameters = 3,
     .parameters = {{.name = "mass", .units = "kg", .text = "m", NOT_NEGATIVE},
                    {.name = "stiffness", .units = "N/m", .text = "k", .shape = SHAPE_PAIR, .required = true, NOT_NEGATIVE},
                    {.name = "damping", .units = "N s/m", .text = "d", .shape = SHAPE_PAIR, NOT_NEGATIVE}}},
};
#undef NOT_NEGATIVE
#undef ANY
/* clang-format on */

#endif
