/* What the kernel derives of the deviations of a wheel's flanks as rows for `evolvent show`. */
#include "model/model_kernel.h"

#include <stddef.h>

static void add(model_quantity rows[MODEL_MOST_ROWS], int *n, const char *name, const char *units, const char *symbol,
                const char *long_name, double value)
{
    if (value != 0) {
        rows[(*n)++] = (model_quantity){name, units, symbol, long_name, 1, {value, 0.0}, units[0] == 'r'};
    }
}

int model_deviation(const model *model, int wheel, model_quantity rows[MODEL_MOST_ROWS])
{
    evl_deviation_geometry g;
    int n = 0;
    if (!evl_gearbox_deviation(model->gearbox, wheel, &g, NULL)) {
        return 0;
    }
    add(rows, &n, "profile_start_diameter", "m", "d_Nf", "start of the active profile that deviates",
        2 * g.profile_start_radius);
    add(rows, &n, "profile_tip_diameter", "m", "d_a", "its end", 2 * g.profile_tip_radius);
    add(rows, &n, "tip_relief_diameter", "m", "", "start of tip relief", 2 * g.tip_relief_radius);
    add(rows, &n, "tip_relief_roll_angle", "rad", "", "its roll angle", g.tip_relief_roll_angle);
    add(rows, &n, "root_relief_diameter", "m", "", "start of root relief", 2 * g.root_relief_radius);
    add(rows, &n, "root_relief_roll_angle", "rad", "", "its roll angle", g.root_relief_roll_angle);
    add(rows, &n, "single_pitch_deviation", "m", "f_p", "largest single pitch deviation", g.single_pitch);
    add(rows, &n, "total_pitch_deviation", "m", "F_p", "total cumulative pitch deviation", g.total_pitch);
    return n;
}

bool model_pitch_errors(const model *model, int wheel, double *errors)
{
    evl_deviation_geometry g;
    return evl_gearbox_deviation(model->gearbox, wheel, &g, errors) && g.total_pitch > 0;
}
