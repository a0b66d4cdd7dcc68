#include "simulate/positions.h"

#include <stdio.h>

positions_rule positions_of(const description *description, const model *model)
{
    const position_description *by = &description->simulation.output_by;
    const bool by_mesh = by->mesh >= 0;
    if (by->number == 0) {
        return (positions_rule){.per = NULL};
    }
    return (positions_rule){.per = by_mesh ? "pitch" : "turn",
                            .number = by->number,
                            .what = by_mesh ? "mesh" : "wheel",
                            .of = by_mesh ? description->meshes[by->mesh] : description->wheels[by->wheel],
                            .position_of = model_position_of(model, by->wheel, by->mesh)};
}

void positions_describe(const positions_rule *rule, int before, memory_arena *arena,
                        model_output outputs[POSITIONS_OUTPUTS])
{
    const bool by_mesh = rule->what[0] == 'm';
    const char *position =
        by_mesh ? arena_printf(arena, "pitches of the driving wheel of mesh '%s' since tooth pair 0's start of contact",
                               rule->of)
                : arena_printf(arena, "revolutions of wheel '%s' since its start position", rule->of);
    outputs[POSITIONS_VALUE] = (model_output){.name = "output_position",
                                              .units = "1",
                                              .symbol = by_mesh ? "xi" : "phi/(2 pi)",
                                              .long_name = position,
                                              .dims = "",
                                              .offset = before + POSITIONS_VALUE,
                                              .count = 1};
    outputs[POSITIONS_KIND] =
        (model_output){.name = "output_kind",
                       .units = "1",
                       .symbol = "",
                       .long_name = "0 a grid position reached in the nominal sense, 1 the start or end of the run off "
                                    "the grid, 2 a grid position passed in reverse",
                       .dims = "",
                       .is_integer = true,
                       .offset = before + POSITIONS_KIND,
                       .count = 1};
}

bool positions_check_start(const positions_rule *rule, const model *model, const dae_state *start,
                           model_message *refusal)
{
    if (rule->per == NULL || model_can_pass(model, rule->position_of, start)) {
        return true;
    }
    (void)snprintf(refusal->field, sizeof refusal->field, "simulation.output.%s", rule->what);
    (void)snprintf(refusal->message, sizeof refusal->message,
                   "nothing turns %s%s '%s': no speed at the start, no load and no prescribed speed; "
                   "give one, or outputs by time (output_interval)",
                   rule->what[0] == 'm' ? "the driving wheel of " : "", rule->what, rule->of);
    return false;
}

void positions_serialize(positions_counts *counts, archive *archive)
{
    SERIALIZE(archive, counts->forwards);
    SERIALIZE(archive, counts->backwards);
    SERIALIZE(archive, counts->first);
    SERIALIZE(archive, counts->last);
    SERIALIZE(archive, counts->has_started);
}

void positions_take(positions_counts *counts, const output_mark *mark)
{
    if (!counts->has_started) {
        counts->has_started = true;
        counts->first = mark->position;
    } else {
        counts->forwards += mark->kind == OUTPUT_FORWARDS;
        counts->backwards += mark->kind == OUTPUT_BACKWARDS;
    }
    counts->last = mark->position;
}

void positions_remark(const positions_counts *counts, char *text, size_t length)
{
    const positions_rule *rule = &counts->rule;
    if (rule->per == NULL || counts->forwards >= rule->number) {
        text[0] = '\0';
        return;
    }
    (void)snprintf(
        text, length,
        "output by %s: %s %s moved %.4g %s%s, from %.4g to %.4g, less than one: %ld position%s forwards, %ld backwards",
        rule->per, rule->what, rule->of, counts->last - counts->first, rule->per, rule->what[0] == 'm' ? "es" : "s",
        counts->first, counts->last, counts->forwards, counts->forwards == 1 ? "" : "s", counts->backwards);
}
