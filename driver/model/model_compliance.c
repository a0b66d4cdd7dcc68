/* How the wheels of a mesh give way as rows for `evolvent show`. */
#include "model/model_kernel.h"

#include <stddef.h>

static void add(model_quantity rows[MODEL_MOST_ROWS], int *n, const char *name, const char *units, const char *symbol,
                const char *long_name, double value)
{
    if (value != 0) {
        rows[(*n)++] = (model_quantity){name, units, symbol, long_name, 1, {value, 0.0}, false};
    }
}

int model_mesh_stiffness(const model *model, int mesh, model_quantity rows[MODEL_MOST_ROWS])
{
    evl_mesh_stiffness s;
    int n = 0;
    if (!evl_gearbox_mesh_stiffness(model->gearbox, mesh, &s)) {
        return 0;
    }
    add(rows, &n, "driving_at_start", "1/Pa", "c_A", "driving wheel, flank at the start of the path", s.driving[0]);
    add(rows, &n, "driving_at_pitch_point", "1/Pa", "c_A", "at the pitch point", s.driving[1]);
    add(rows, &n, "driving_at_end", "1/Pa", "c_A", "at the end", s.driving[2]);
    add(rows, &n, "driving_next", "1/Pa", "c_A1", "the next flank by a load there", s.next_driving);
    add(rows, &n, "driven_at_start", "1/Pa", "c_B", "driven wheel, flank at the start of the path", s.driven[0]);
    add(rows, &n, "driven_at_pitch_point", "1/Pa", "c_B", "at the pitch point", s.driven[1]);
    add(rows, &n, "driven_at_end", "1/Pa", "c_B", "at the end", s.driven[2]);
    add(rows, &n, "driven_next", "1/Pa", "c_B1", "the next flank by a load there", s.next_driven);
    add(rows, &n, "line_load", "N/m", "w", "line load of the stiffnesses", s.line_load);
    add(rows, &n, "single_pair", "Pa", "", "stiffness of one tooth pair, at the pitch point", s.single_pair);
    add(rows, &n, "double_pair", "Pa", "", "of two, half a base pitch before and behind it", s.double_pair);
    add(rows, &n, "iso_6336", "Pa", "c'", "ISO 6336-1, measured pairs without body: not the same", s.iso);
    return n;
}
