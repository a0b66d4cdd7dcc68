/* What the kernel derives of real gears as rows for `evolvent show`. */
#include "model/model_kernel.h"

static model_quantity row(const char *name, const char *units, const char *symbol, const char *long_name, double value)
{
    const bool is_angle = units[0] == 'r';
    return (model_quantity){name, units, symbol, long_name, 1, {value, 0.0}, is_angle};
}

int model_gear(const model *model, int wheel, model_quantity rows[MODEL_MOST_ROWS])
{
    evl_gear_geometry g;
    if (!evl_gearbox_gear(model->gearbox, wheel, &g)) {
        return 0;
    }
    int n = 0;
    rows[n++] = row("teeth", "1", "z", "number of teeth", g.teeth);
    rows[n++] = row("normal_module", "m", "m_n", "normal module", g.normal_module);
    rows[n++] = row("pressure_angle", "rad", "alpha_n", "normal pressure angle", g.pressure_angle);
    rows[n++] = row("profile_shift", "1", "x", "profile shift coefficient", g.profile_shift);
    rows[n++] = row("generating_shift", "1", "x_E", "generating profile shift coefficient", g.generating_shift);
    rows[n++] = row("undercut_shift", "1", "x_Emin", "undercut begins below x_E =", g.undercut_shift);
    rows[n++] = row("tip_alteration", "1", "k", "tip alteration coefficient", g.tip_alteration);
    rows[n++] = row("reference_diameter", "m", "d", "reference diameter", 2 * g.reference_radius);
    rows[n++] = row("base_diameter", "m", "d_b", "base diameter", 2 * g.base_radius);
    rows[n++] = row("tip_diameter", "m", "d_a", "tip diameter", 2 * g.tip_radius);
    rows[n++] = row("root_diameter", "m", "d_f", "root diameter", 2 * g.root_radius);
    rows[n++] = row("form_diameter", "m", "d_Ff", "root form diameter", 2 * g.form_radius);
    rows[n++] = row("bore", "m", "", "bore", 2 * g.bore_radius);
    rows[n++] = row("tooth_depth", "m", "h", "tooth depth", g.tooth_depth);
    rows[n++] = row("pitch", "m", "p_n", "normal pitch", g.pitch);
    rows[n++] = row("base_pitch", "m", "p_bt", "transverse base pitch", g.base_pitch);
    rows[n++] = row("thickness", "m", "s_n", "tooth thickness, reference circle", g.thickness);
    rows[n++] = row("thickness_allowance", "m", "A_sn", "its allowance", g.thickness_allowance);
    rows[n++] = row("tip_thickness", "m", "s_an", "tooth thickness, tip circle", g.tip_thickness);
    rows[n++] = row("tooth_angle", "rad", "psi_b", "angle of a tooth, base circle", g.tooth_angle);
    return n;
}

int model_gear_mesh(const model *model, int mesh, model_quantity rows[MODEL_MOST_ROWS])
{
    evl_gear_mesh g;
    if (!evl_gearbox_gear_mesh(model->gearbox, mesh, &g)) {
        return 0;
    }
    int n = 0;
    rows[n++] = row("centre_distance", "m", "a_w", "centre distance", g.centre_distance);
    rows[n++] = row("reference_centre_distance", "m", "a", "reference centre distance", g.reference_distance);
    rows[n++] =
        row("tight_centre_distance", "m", "", "centre distance of full teeth without backlash", g.tight_distance);
    rows[n++] = row("working_pressure_angle", "rad", "alpha_wt", "working pressure angle", g.working_pressure_angle);
    rows[n++] = row("pitch_diameter_driving", "m", "d_w1", "working pitch diameter, driving", 2 * g.pitch_radius_a);
    rows[n++] = row("pitch_diameter_driven", "m", "d_w2", "working pitch diameter, driven", 2 * g.pitch_radius_b);
    rows[n++] = row("active_diameter_driving", "m", "d_Nf1", "start of active profile, driving", 2 * g.active_radius_a);
    rows[n++] = row("active_diameter_driven", "m", "d_Nf2", "start of active profile, driven", 2 * g.active_radius_b);
    rows[n++] = row("line_of_action", "m", "T1T2", "line of action", g.line_of_action);
    rows[n++] = row("path_of_contact", "m", "g_alpha", "length of path of contact", g.path_of_contact);
    rows[n++] = row("approach", "m", "g_f", "length of approach path", g.approach);
    rows[n++] = row("recess", "m", "g_a", "length of recess path", g.recess);
    rows[n++] = row("base_pitch", "m", "p_bt", "transverse base pitch", g.base_pitch);
    rows[n++] = row("contact_ratio", "1", "eps_alpha", "transverse contact ratio", g.contact_ratio);
    rows[n++] = row("tip_clearance_driving", "m", "c_1", "tip clearance at the root, driving", g.clearance_a);
    rows[n++] = row("tip_clearance_driven", "m", "c_2", "tip clearance at the root, driven", g.clearance_b);
    rows[n++] = row("backlash", "m", "j_bn", "normal backlash", g.backlash);
    rows[n++] = row("circumferential_backlash", "m", "j_wt", "circumferential backlash", g.circumferential_backlash);
    rows[n++] = row("radial_backlash", "m", "j_r", "radial backlash", g.radial_backlash);
    return n;
}
