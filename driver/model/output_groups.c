#include "model/output_groups.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"

#include <stdlib.h>
#include <string.h>

/** A group: all outputs with certain dimensions, or a list of names. */
static const struct {
    const char *name;
    const char *dims;    /**< separated by bars; NULL: list of names */
    const char *outputs; /**< separated by blanks */
} groups[] = {
    {"gearbox", "||", ""},
    {"wheels", "|wheel|wheel axis|", ""},
    {"meshes", "|mesh|mesh axis|", ""},
    {"pairs", "|mesh pair|", ""},
    {"shafts", "|shaft|", ""},
    {"bearings", "|wheel space|", ""},
    {"housing", "|space|quaternion|", ""},
    {"accelerometers", "|accelerometer|", ""},
    {"energies", NULL, "kinetic_energy potential_energy dissipated_energy load_work"},
    {"losses", NULL,
     "support_damping_loss shaft_damping_loss friction_loss contact_damping_loss curvature_loss mount_damping_loss "
     "load_loss"},
    {"forces", NULL,
     "normal_force friction_force coast_force mesh_torque_driving mesh_torque_driven load_torque shaft_torque"},
    {"tracking", NULL,
     "gradient_ratio tracking_residual_driving tracking_residual_driven line_distance_driving line_distance_driven "
     "contact_point_driving contact_point_driven"},
    {"check", NULL, /* outputs used by evolvent-post check */
     "kinetic_energy potential_energy dissipated_energy load_work load_torque angular_velocity angular_acceleration "
     "angle_deviation centre_displacement housing_angular_acceleration transmission_error gap gap_rate penetration "
     "flank_deviation separation_curvature contact_mode normal_force friction_force friction_arm_driving "
     "friction_arm_driven mesh_torque_driving mesh_torque_driven shaft_torque gradient_ratio tracking_residual_driving "
     "tracking_residual_driven line_distance_driving line_distance_driven pair_normal_force pair_contact_mode "
     "pair_penetration pair_on_path pair_number tooth_pair pairs_in_contact angle centre_velocity centre_acceleration "
     "housing_position housing_velocity "
     "housing_acceleration housing_angular_velocity mount_damping_loss friction_loss contact_damping_loss "
     "curvature_loss support_damping_loss shaft_damping_loss load_loss"},
};
enum { N_GROUPS = sizeof groups / sizeof *groups };

static bool is_in(int group, const model_output *output)
{
    CLEANUP_FREE char *dims = xasprintf("|%s|", output->dims);
    return groups[group].dims == NULL ? words_contain(groups[group].outputs, output->name)
                                      : strstr(groups[group].dims, dims) != NULL;
}

/** Whether a word is the name of an output or of a group that contains it, or "all". */
static bool means(const char *word, const model_output *output)
{
    if (strcmp(word, "all") == 0 || strcmp(word, output->name) == 0) {
        return true;
    }
    for (int group = 0; group < N_GROUPS; group++) {
        if (strcmp(word, groups[group].name) == 0) {
            return is_in(group, output);
        }
    }
    return false;
}

/** Whether a word is a known name. */
static bool is_known(const char *word, int n, const model_output *outputs)
{
    bool is_group = strcmp(word, "all") == 0;
    for (int group = 0; group < N_GROUPS && !is_group; group++) {
        is_group = strcmp(word, groups[group].name) == 0;
    }
    for (int i = 0; i < n && !is_group; i++) {
        is_group = strcmp(word, outputs[i].name) == 0;
    }
    return is_group;
}

static char *refuse(const char *word, int n, const model_output *outputs)
{
    CLEANUP_FREE const char **names = xcalloc((size_t)n + N_GROUPS + 1, sizeof *names);
    for (int i = 0; i < n; i++) {
        names[i] = outputs[i].name;
    }
    for (int group = 0; group < N_GROUPS; group++) {
        names[n + group] = groups[group].name;
    }
    names[n + N_GROUPS] = "all";
    CLEANUP_FREE char *hint = suggest_phrase(word, n + N_GROUPS + 1, names);
    return xasprintf("unknown output or group '%.64s'%s; groups are " OUTPUT_GROUPS
                     ", outputs are listed in docs/reference/result_format.md",
                     word, hint);
}

char *output_groups_choose(const char *words, int n, const model_output *outputs, bool *chosen)
{
    CLEANUP_FREE char *blanks = xstrdup(words);
    for (char *c = blanks; *c != '\0'; c++) {
        *c = strchr(",\t\n", *c) != NULL ? ' ' : *c;
    }
    CLEANUP_FREE char **list = NULL;
    const int n_words = words_split(blanks, &list);
    int n_named = 0;
    for (int w = 0; w < n_words; w++) {
        if (list[w][0] == '\0') {
            continue;
        }
        n_named++;
        if (!is_known(list[w], n, outputs)) {
            return refuse(list[w], n, outputs);
        }
        for (int i = 0; i < n; i++) {
            chosen[i] = chosen[i] || (!outputs[i].is_static && means(list[w], &outputs[i]));
        }
    }
    return n_named > 0 ? NULL : xstrdup("names no output; omit it, or give all");
}
