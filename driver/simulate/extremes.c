#include "simulate/extremes.h"

#include "base/memory.h"
#include "simulate/extremes_by_ends.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct extremes {
    memory_arena arena;
    extreme_channels channels;
    channel_past past; /**< for an integrator without candidates */
    double from, to;   /**< window */
    dae_state end;     /**< of the last step */
    bool rises_on;     /**< a possible extreme at the end was not evaluated: irrelevant while the channel rises */
};

static int channel_of(int index, int mesh)
{
    return model_tables()->n_monitored * mesh + model_tables()->extremes[index].monitored;
}

extremes *extremes_create(const model *model, int n_meshes, double from, double to)
{
    extremes *extremes = xcalloc(1, sizeof *extremes);
    *extremes = (struct extremes){.from = from, .to = to};
    extreme_channels_init(&extremes->channels, &model_about(model)->dae, &extremes->arena);
    channel_past_init(&extremes->past, &extremes->channels);
    extremes->end = dae_state_create(&model_about(model)->dae, &extremes->arena);
    for (int k = 0; k < model_tables()->n_extremes; k++) {
        for (int mesh = 0; mesh < n_meshes; mesh++) {
            const int channel = channel_of(k, mesh);
            if (model_tables()->extremes[k].is_largest) {
                extremes->channels.high[channel] = -INFINITY;
            } else {
                extremes->channels.low[channel] = INFINITY;
            }
        }
    }
    return extremes;
}

void extremes_delete(extremes **pointer)
{
    extremes *extremes = *pointer;
    *pointer = NULL;
    if (extremes == NULL) {
        return;
    }
    arena_free(&extremes->arena);
    free(extremes);
}

void extremes_serialize(extremes *extremes, archive *archive)
{
    const dae *dae = extremes->channels.dae;
    extreme_channels_serialize(&extremes->channels, archive);
    channel_past_serialize(&extremes->past, &extremes->channels, archive);
    SERIALIZE(archive, extremes->end.t);
    SERIALIZE_ARRAY(archive, extremes->end.y, dae->n);
    SERIALIZE_ARRAY(archive, extremes->end.integers, dae->n_integers);
    SERIALIZE_ARRAY(archive, extremes->end.reals, dae->n_reals);
    SERIALIZE(archive, extremes->rises_on);
}

/** Evaluate the end of the last step if that was deferred. */
static void see_end(extremes *extremes, int channel)
{
    if (extremes->rises_on) {
        (void)extreme_channels_see_state(&extremes->channels, &extremes->end, channel);
    }
}

const double *extremes_highest(const extremes *extremes)
{
    return extremes->channels.high;
}

extreme_found extremes_found(extremes *extremes, int index, int mesh)
{
    const extreme_channels *channels = &extremes->channels;
    see_end(extremes, -1);
    extremes->rises_on = false;
    const int channel = channel_of(index, mesh);
    if (!channels->has_begun) {
        return (extreme_found){NAN, NAN};
    }
    return model_tables()->extremes[index].is_largest
               ? (extreme_found){channels->high[channel], channels->high_time[channel]}
               : (extreme_found){channels->low[channel], channels->low_time[channel]};
}

int extremes_find(const char *output, bool is_largest)
{
    for (int k = 0; k < model_tables()->n_extremes; k++) {
        if (strcmp(model_tables()->extremes[k].output, output) == 0 &&
            model_tables()->extremes[k].is_largest == is_largest) {
            return k;
        }
    }
    return -1;
}

static double within(double t, double from, double to)
{
    return fmin(fmax(t, from), to);
}

/** Search a step of an integrator with candidates. A candidate at the end is deferred if the next step continues from
 *  there: that step has a candidate at its start, unless the channel continues to rise. */
static void take_candidates(extremes *extremes, const integrate_step *step, double from, double to)
{
    static const double first_width = 0.02; /* of the bracket: a candidate is near the maximum */
    static const double same = 1e-12;       /* fraction of the step within which times are equal */
    extreme_channels *channels = &extremes->channels;
    const double a_while = same * (step->t_to - step->t_from);
    const int n = step->look(step->with, channels->high, channels->low);
    bool rises_on = false;
    for (int i = 0; i < n; i++) {
        dae_candidate one;
        step->candidate(step->with, i, &one);
        if (one.left > to || one.right < from) {
            continue;
        }
        if (step->goes_on && one.left >= step->t_to - a_while) {
            rises_on = true;
            continue;
        }
        if (one.right <= step->t_from + a_while) {
            see_end(extremes, one.channel);
        }
        const extreme_bracket extreme = {.channel = one.channel,
                                         .sense = one.sense,
                                         .left = within(one.left, from, to),
                                         .right = within(one.right, from, to),
                                         .start = within(one.t, from, to),
                                         .width = first_width * (one.right - one.left),
                                         .expected = one.sense * one.value};
        extreme_channels_climb(channels, step, &extreme);
    }
    extremes->rises_on = rises_on;
    if (rises_on) {
        dae_state_copy(channels->dae, &extremes->end, step->state);
    }
}

void extremes_monitor(extremes *extremes, const integrate_step *step)
{
    extreme_channels *channels = &extremes->channels;
    channels->t_values = NAN;
    if (step->t_to < extremes->from || step->t_from > extremes->to) {
        extremes->past.n_known = 0;
        return;
    }
    const double from = step->t_from > extremes->from ? step->t_from : extremes->from;
    const double to = step->t_to < extremes->to ? step->t_to : extremes->to;
    if (step->look == NULL) {
        extremes_by_ends(channels, &extremes->past, step, from, to);
        return;
    }
    if (!channels->has_begun || from > step->t_from || to < step->t_to) {
        (void)extreme_channels_see(channels, step, from);
        (void)extreme_channels_see(channels, step, to);
    }
    if (from < to) {
        take_candidates(extremes, step, from, to);
    }
}
