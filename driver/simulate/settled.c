#include "simulate/settled.h"

#include "model/model_start_modes.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>

static const double two_pi = 6.283185307179586;

static const double of_mean =
    0.01; /* permitted remainder in a mean, and difference of the halves' means, relative to the root mean square */
static const double of_range = 0.05; /* permitted remainder of the transient, relative to the peak to peak */
static const double least = 1e-4;    /* negligible, relative to the quantity's largest root mean square */
static const double of_start = 1e-6; /* rounding, relative to the distance of the start */
static const double undamped = 1e-6; /* damping ratio below which a mode does not decay */
static const double of_scatter = 2;  /* permitted difference of the halves' means, in standard deviations of blocks */

/** Worst result so far: above 1 is not settled. */
typedef struct {
    double excess; /**< relative to the permitted value */
    metric_statistics of;
    const start_mode *mode; /**< the one with the largest contribution; NULL: the halves of the window differ */
    double left;            /**< relative to the mean or the peak to peak */
    bool is_of_mean;
} worst_case;

typedef struct {
    const metric_sums *sums;
    const start_modes *modes;
    double age, span; /**< from the start to the window, of the window [s] */
} judgement;

/** Remainder of a mode in a mean over the window, relative to its amplitude at the start of the window.
 *  Equation N4. */
static double left_in_mean(const start_mode *mode, double span)
{
    const double complex turn = (-mode->rate + mode->frequency * I) * span;
    return cabs(turn) > 0 ? cabs((cexp(turn) - 1) / turn) : 1;
}

static void note(worst_case *worst, double left, double allowed, bool is_of_mean, const metric_statistics *of,
                 const start_mode *mode, double size)
{
    if (left > allowed * fmax(worst->excess, 1)) {
        *worst = (worst_case){
            .excess = left / allowed, .of = *of, .mode = mode, .left = left / size, .is_of_mean = is_of_mean};
    }
}

/** Check the remainder of the start's distance in a quantity. Equation N4.
 *  @param size  largest root mean square of the quantity, of all wheels or meshes */
static void judge_start(const judgement *j, const metric_statistics *of, double size, worst_case *worst)
{
    const model_output *output = model_output_named(j->sums->model, metric_quantities[of->quantity].name);
    const channel_window *window = &of->window;
    const int index = output->offset + of->element;
    double begun = 0, left = 0, in_mean = 0, largest[2] = {0};
    const start_mode *most[2] = {NULL};
    for (int k = 0; k < j->modes->n; k++) {
        const start_mode *mode = &j->modes->modes[k];
        const double part = mode->left[index] * exp(-mode->rate * j->age);
        const double parts[] = {part, part * left_in_mean(mode, j->span)};
        begun += mode->left[index];
        left += parts[0];
        in_mean += parts[1];
        for (int i = 0; i < 2; i++) {
            most[i] = parts[i] > largest[i] ? mode : most[i];
            largest[i] = fmax(largest[i], parts[i]);
        }
    }
    const double lower_limit = fmax(least * size, of_start * begun), range = window->high - window->low;
    note(worst, left, fmax(of_range * range, lower_limit), false, of, most[0], range);
    note(worst, in_mean, fmax(of_mean * window->rms, lower_limit), true, of, most[1], window->rms);
}

/** Check the means of both halves. @param size  as above */
static void judge_halves(const metric_statistics *of, double size, worst_case *worst)
{
    const double apart = fabs(of->halves.second - of->halves.first), rms = of->window.rms;
    if (of->has_halves && apart > of_scatter * of->halves.scatter) {
        note(worst, apart, fmax(of_mean * rms, least * size), true, of, NULL, rms);
    }
}

/** "transmission_error of mesh 'pinion-gear'". */
static void name_quantity(const model *model, const metric_statistics *of, char *text, size_t size)
{
    const model_names *names = &model_about(model)->names;
    const metric_quantity *quantity = &metric_quantities[of->quantity];
    const name_list *elements = metric_elements(quantity->dims, names);
    const int each = metric_count(quantity->dims, names) / elements->n;
    const char *kind = elements == &names->wheels ? "wheel" : elements == &names->meshes ? "mesh" : "accelerometer";
    (void)snprintf(text, size, "%s of %s '%s'", quantity->name, kind, elements->names[of->element / each]);
}

/** "mode of 812 Hz, time constant 0.02 s". */
static void name_mode(const start_mode *mode, char *text, size_t size)
{
    const double whole = hypot(mode->rate, mode->frequency), frequency = whole / two_pi;
    if (mode->rate < 0) {
        (void)snprintf(text, size, "a growing mode of %.4g Hz", frequency);
    } else if (mode->rate <= undamped * whole) {
        (void)snprintf(text, size, "an undamped mode of %.4g Hz, which does not settle", frequency);
    } else if (mode->frequency > 0) {
        (void)snprintf(text, size, "the mode of %.4g Hz with the time constant %.3g s", frequency, 1 / mode->rate);
    } else {
        (void)snprintf(text, size, "a motion with the time constant %.3g s", 1 / mode->rate);
    }
}

static void explain(const judgement *j, const worst_case *worst, double from, settled_result *settled)
{
    char quantity[256], mode[128], remedy[64] = "";
    name_quantity(j->sums->model, &worst->of, quantity, sizeof quantity);
    settled->is_settled = 0;
    if (worst->mode == NULL) {
        (void)snprintf(settled->reason, sizeof settled->reason,
                       "the means of %s over both halves of the window differ by %.3g %%", quantity, 100 * worst->left);
        return;
    }
    name_mode(worst->mode, mode, sizeof mode);
    if (worst->mode->rate > undamped * hypot(worst->mode->rate, worst->mode->frequency)) {
        (void)snprintf(remedy, sizeof remedy, "; start the window at %.2g s",
                       from + 1.1 * log(worst->excess) / worst->mode->rate);
    }
    (void)snprintf(settled->reason, sizeof settled->reason,
                   "the initial transient contributes about %.3g %% of the %s of %s in %s%s", 100 * worst->left,
                   worst->is_of_mean ? "root mean square" : "peak to peak", quantity, mode, remedy);
}

void settled_judge(const metric_sums *sums, const dae_state *start, bool starts_periodic, double from, double to,
                   settled_result *settled)
{
    start_modes modes = {.n = 0};
    model_message error = {.message = ""};
    worst_case worst = {.excess = 0};
    double sizes[N_METRIC_QUANTITIES] = {0};
    metric_statistics of;
    const bool has_modes = starts_periodic || model_start_modes(sums->model, start, &modes, &error);
    const judgement j = {.sums = sums, .modes = &modes, .age = from - start->t, .span = to - from};
    for (int i = 0; i < sums->n_channels; i++) {
        metric_sums_statistics(sums, i, &of);
        sizes[of.quantity] = fmax(sizes[of.quantity], of.window.rms);
    }
    for (int i = 0; i < sums->n_channels; i++) {
        metric_sums_statistics(sums, i, &of);
        judge_start(&j, &of, sizes[of.quantity], &worst);
        judge_halves(&of, sizes[of.quantity], &worst);
    }
    *settled = (settled_result){.is_settled = has_modes ? 1 : NAN};
    if (worst.excess > 0) {
        explain(&j, &worst, from, settled);
    } else if (!has_modes) {
        (void)snprintf(settled->reason, sizeof settled->reason, "the initial transient cannot be estimated: %s",
                       error.message);
    }
    arena_free(&modes.arena);
}
