#include "case/case_deviation.h"

#include "base/memory.h"

static const double RADIANS_PER_DEGREE = 0.017453292519943295769;

static bool resolve_relief(checker *checker, const case_node *wheel, const char *key, relief_description *relief)
{
    const case_node *block = node_get(wheel, key);
    if (block == NULL) {
        return true;
    }
    const case_node *diameter = node_get(block, "diameter"), *roll_angle = node_get(block, "roll_angle");
    if ((diameter == NULL) == (roll_angle == NULL)) {
        (void)checker_enter(checker, key);
        return checker_refuse(checker, block->place, "needs either 'diameter' or 'roll_angle', where it starts%s",
                              diameter == NULL ? "" : "; it has both");
    }
    relief->amount = node_get_number(block, "amount");
    relief->by_roll_angle = roll_angle != NULL;
    relief->start = roll_angle != NULL ? node_number(roll_angle) * RADIANS_PER_DEGREE : node_number(diameter);
    relief->is_parabolic = node_get_is(block, "shape", "parabolic");
    return true;
}

bool case_resolve_deviation(checker *checker, const case_node *wheel, deviation_description *deviation)
{
    if (!resolve_relief(checker, wheel, "tip_relief", &deviation->tip_relief) ||
        !resolve_relief(checker, wheel, "root_relief", &deviation->root_relief)) {
        return false;
    }
    const case_node *crowning = node_get(wheel, "profile_crowning"), *errors = node_get(wheel, "pitch_errors");
    const case_node *accuracy = node_get(wheel, "accuracy"), *runout = node_get(wheel, "runout");
    deviation->profile_crowning = crowning == NULL ? 0 : node_number(crowning);
    if (errors != NULL) {
        deviation->n_pitch_errors = errors->n;
        deviation->pitch_errors = xcalloc((size_t)errors->n, sizeof *deviation->pitch_errors);
        for (int i = 0; i < errors->n; i++) {
            deviation->pitch_errors[i] = node_number(errors->entries[i].value);
        }
    }
    if (accuracy != NULL) {
        deviation->accuracy_class = (int)node_get_number(accuracy, "class");
        deviation->seed = (int)node_get_number(accuracy, "seed");
    }
    if (runout != NULL) {
        deviation->runout_amount = node_get_number(runout, "amount");
        deviation->runout_phase = node_get_number(runout, "phase") * RADIANS_PER_DEGREE;
    }
    return true;
}
