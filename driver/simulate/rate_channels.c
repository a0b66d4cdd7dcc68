#include "simulate/rate_channels.h"

#include <stdio.h>
#include <string.h>

static int count_of(const model *model, const char *name)
{
    const model_output *output = model_output_named(model, name);
    return output == NULL ? 0 : output->count;
}

/** Whether an output is a rate in this run. The pose of a housing with prescribed motion is not a state and is not
 *  integrated. */
static bool is_rate(const model *model, const model_output *output)
{
    static const char prefix[] = "housing_";
    if (output->rate_of == NULL || output->count == 0 || count_of(model, output->rate_of) == 0) {
        return false;
    }
    return strncmp(output->name, prefix, strlen(prefix)) != 0 || count_of(model, "mount_damping_loss") > 0;
}

/** The channel of a value; a new one if there is none yet. */
static int channel_at(rate_channels *these, const model_output *of, int element)
{
    const int index = these->values.offsets[of - model_about(these->values.model)->outputs] + element;
    for (int i = 0; i < these->n; i++) {
        if (these->channels[i].index == index) {
            return i;
        }
    }
    these->channels[these->n] = (rate_channel){.index = index};
    return these->n++;
}

static void open_rate(rate_channels *these, const model_output *rate)
{
    const model_output *of = model_output_named(these->values.model, rate->rate_of);
    const bool adds_up = of->count != rate->count;
    const int first = these->values.offsets[rate - model_about(these->values.model)->outputs];
    for (int i = 0; i < rate->count; i++) {
        const int channel = channel_at(these, of, adds_up ? 0 : i);
        these->channel_of[first + i] = channel;
        these->channels[channel].rate = of->dims[0] == '\0' && strcmp(of->units, "J") == 0 ? NULL : rate;
    }
}

rate_channels rate_channels_open(const model *model, memory_arena *arena)
{
    const model_facts *about = model_about(model);
    rate_channels these = {0};
    requested_outputs_init(&these.values, model, arena);
    for (int i = 0; i < about->n_outputs; i++) {
        if (is_rate(model, &about->outputs[i])) {
            (void)requested_outputs_add(&these.values, about->outputs[i].name);
            (void)requested_outputs_add(&these.values, about->outputs[i].rate_of);
        }
    }
    these.torque = requested_outputs_add(&these.values, "load_torque");
    these.speed = requested_outputs_add(&these.values, "angular_velocity");
    these.loss = requested_outputs_add(&these.values, "load_loss");
    const int work = requested_outputs_add(&these.values, "load_work");
    these.channels = arena_calloc(arena, (size_t)these.values.n_values, sizeof *these.channels);
    these.channel_of = arena_calloc(arena, (size_t)these.values.n_values, sizeof *these.channel_of);
    for (int i = 0; i < these.values.n_values; i++) {
        these.channel_of[i] = -1;
    }
    for (int i = 0; i < about->n_outputs; i++) {
        if (is_rate(model, &about->outputs[i])) {
            open_rate(&these, &about->outputs[i]);
        }
    }
    these.sampler = model_sampler_create(model, these.values.n, these.values.outputs);
    these.in_lanes = model_sampler_in_lanes(these.sampler);
    if (these.in_lanes && work >= 0) { /* else a moving housing, or gravity, may contribute */
        const int channel = channel_at(&these, model_output_named(model, "load_work"), 0);
        these.channels[channel].is_power = true;
    }
    return these;
}

void rate_channels_close(rate_channels *these)
{
    model_sampler_delete(&these->sampler);
}

void rate_channels_rates(const rate_channels *these, const double *values, int lane, double *rates)
{
    const int n_wheels = model_about(these->values.model)->names.wheels.n;
    for (int c = 0; c < these->n; c++) {
        rates[c] = 0;
        for (int i = 0; i < n_wheels && these->channels[c].is_power; i++) {
            rates[c] += values[(size_t)(these->torque + i) * DAE_LANES + (size_t)lane] *
                        values[(size_t)(these->speed + i) * DAE_LANES + (size_t)lane];
            if (these->loss >= 0) {
                rates[c] += values[(size_t)(these->loss + i) * DAE_LANES + (size_t)lane];
            }
        }
    }
    for (int v = 0; v < these->values.n_values; v++) {
        if (these->channel_of[v] >= 0) {
            rates[these->channel_of[v]] += values[(size_t)v * DAE_LANES + (size_t)lane];
        }
    }
}

static void write_element(const model *model, const model_output *output, int element, char text[96])
{
    const model_names *names = &model_about(model)->names;
    const struct {
        const char *dim;
        const name_list *of;
    } lists[] = {{"wheel", &names->wheels}, {"mesh", &names->meshes}, {"shaft", &names->shafts}};
    text[0] = '\0';
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        const size_t length = strlen(lists[i].dim);
        if (strncmp(output->dims, lists[i].dim, length) == 0 && lists[i].of->n > 0) {
            const int each = output->count / lists[i].of->n;
            (void)snprintf(text, 96, " of %s '%.60s'%s", lists[i].dim, lists[i].of->names[element / each],
                           each != 2            ? ""
                           : element % each > 0 ? ", y"
                                                : ", x");
        }
    }
}

const model_output *rate_channels_output(const rate_channels *these, int index, char element[96])
{
    int i = 0;
    while (i + 1 < these->values.n && these->values.offsets[these->values.outputs[i + 1]] <= index) {
        i++;
    }
    const model_output *output = &model_about(these->values.model)->outputs[these->values.outputs[i]];
    write_element(these->values.model, output, index - these->values.offsets[these->values.outputs[i]], element);
    return output;
}
