#include "simulate/simulate.h"

#include "base/interrupt.h"
#include "base/memory.h"
#include "integrate/integrate.h"
#include "simulate/invariant_monitor.h"
#include "simulate/limit_monitor.h"
#include "simulate/output_buffer.h"
#include "simulate/positions.h"
#include "simulate/rate_monitor.h"
#include "simulate/separation_monitor.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double two_pi = 6.283185307179586;

/** Why the observer ended an integration. */
typedef enum {
    STOP_NONE,
    STOP_INTERRUPTED,
    STOP_CHECKPOINT,
    STOP_SPENT,
    STOP_MODEL,
    STOP_MISSED,
    STOP_SINK,
    STOP_RATES
} stop_reason;

typedef struct {
    const case_plan *plan;
    const simulate_sink *sink;
    separation_monitor contact;
    invariant_monitor *invariants;
    rate_monitor *rates;
    limit_monitor limits;
    positions_counts positions;
    output_buffer outputs; /**< buffer of due outputs */
    char *reason;          /**< [DAE_MESSAGE_LENGTH] reason of the end, part of the result */
    double t_delivered;    /**< model time of the last outputs passed to the sink */
    stop_reason stop;
    bool is_cut; /**< it was interrupted, and states after the last outputs are not reliable */
} simulation;

/** Pass outputs to the consumers. @return whether the sink accepted them */
static bool give(simulation *s, const output_block *block)
{
    for (int k = 0; k < block->n && block->marks != NULL; k++) {
        positions_take(&s->positions, &block->marks[k]);
    }
    separation_monitor_outputs(&s->contact, block);
    invariant_monitor_outputs(s->invariants, block);
    const bool good = s->sink->outputs(s->sink->self, block);
    s->stop = good ? s->stop : STOP_SINK;
    s->t_delivered = block->t[block->n - 1];
    return good;
}

/** Pass outputs on after their evaluation. @return as integrate_observer.output */
static int give_found(simulation *s, int code, const output_block *block)
{
    if (code == DAE_RECOVERABLE && s->outputs.capacity == 1) {
        return INTEGRATE_ANEW;
    }
    if (code != DAE_OK) {
        s->stop = s->outputs.capacity > 1 ? STOP_MISSED : STOP_MODEL; /* repeated one by one, the run shows which output
                                                                       * it is */
        return 1;
    }
    return give(s, block) ? 0 : 1;
}

/** Evaluate the buffered outputs and pass them on. @return as integrate_observer.output */
static int deliver_buffered(simulation *s, char reason[DAE_MESSAGE_LENGTH])
{
    output_block block;
    return s->outputs.n == 0 ? 0 : give_found(s, output_buffer_evaluate(&s->outputs, true, &block, reason), &block);
}

static int on_output(void *self, const dae_state *state, const output_mark *mark, char reason[DAE_MESSAGE_LENGTH])
{
    simulation *s = self;
    output_buffer_add(&s->outputs, state, mark);
    return s->outputs.n == s->outputs.capacity ? deliver_buffered(s, reason) : 0;
}

static int capacity(const void *self)
{
    const simulation *s = self;
    return s->outputs.capacity - s->outputs.n;
}

static int on_several(void *self, int n, const double *t, const double *y, const dae_state *discrete,
                      char reason[DAE_MESSAGE_LENGTH])
{
    simulation *s = self;
    output_block block;
    if (n == DAE_LANES) {
        return give_found(s, output_buffer_evaluate_at(&s->outputs, t, y, discrete, &block, reason), &block);
    }
    output_buffer_add_several(&s->outputs, n, t, y, discrete);
    return s->outputs.n == s->outputs.capacity ? deliver_buffered(s, reason) : 0;
}

static int on_change(void *self)
{
    simulation *s = self;
    return deliver_buffered(s, s->reason);
}

static int on_event(void *self, const event_record *record)
{
    simulation *s = self;
    separation_monitor_event(&s->contact, record);
    rate_monitor_event(s->rates);
    if (s->sink->metrics != NULL) {
        metrics_event(s->sink->metrics, record);
    }
    if (!s->sink->event(s->sink->self, record)) {
        s->stop = STOP_SINK;
        return 1;
    }
    return 0;
}

static void on_monitor(void *self, const integrate_step *step)
{
    simulation *s = self;
    extremes_monitor(s->sink->extremes, step);
    if (s->sink->metrics != NULL) {
        metrics_monitor(s->sink->metrics, step);
    }
    rate_monitor_step(s->rates, step);
    limit_monitor_step(&s->limits, step);
}

static int on_step(void *self, double t)
{
    simulation *s = self;
    if (s->sink->step != NULL) {
        s->sink->step(s->sink->self, t);
    }
    if (*(s->sink->interrupt != NULL ? s->sink->interrupt : &interrupt_signal) != 0 && s->sink->is_due == NULL) {
        s->stop = STOP_INTERRUPTED;
        return 1;
    }
    if (rate_monitor_conflict(s->rates) != NULL) {
        s->stop = STOP_RATES;
        return 1;
    }
    return 0;
}

static bool is_due(void *self, double t)
{
    const simulation *s = self;
    return s->sink->is_due(s->sink->self, t);
}

/** Serialise the simulation; the buffer of outputs is emptied before. */
static void serialize(void *self, archive *archive)
{
    simulation *s = self;
    if (!archive->is_reading) {
        archive->has_failed = archive->has_failed || deliver_buffered(s, s->reason) != 0;
    }
    SERIALIZE(archive, s->t_delivered);
    separation_monitor_serialize(&s->contact, archive);
    invariant_monitor_serialize(s->invariants, archive);
    rate_monitor_serialize(s->rates, archive);
    limit_monitor_serialize(&s->limits, archive);
    positions_serialize(&s->positions, archive);
    if (s->sink->extremes != NULL) {
        extremes_serialize(s->sink->extremes, archive);
    }
    if (s->sink->metrics != NULL) {
        metrics_serialize(s->sink->metrics, archive);
    }
    s->sink->serialize(s->sink->self, archive);
}

static int write_checkpoint(void *self, double t, const archive *archive)
{
    static const stop_reason reasons[] = {
        [SIMULATE_GOES_ON] = STOP_NONE, [SIMULATE_STOPS] = STOP_CHECKPOINT, [SIMULATE_FAILS] = STOP_SINK};
    simulation *s = self;
    s->stop = reasons[s->sink->write_checkpoint(s->sink->self, t, archive)];
    return s->stop != STOP_NONE;
}

/** Pass on the last valid state of a run that ends early, if its outputs exist and were not passed on yet. */
static void give_last(simulation *s, const dae_state *state)
{
    const integrate_options *options = &s->plan->integration;
    char message[DAE_MESSAGE_LENGTH];
    output_block block;
    if ((s->stop == STOP_NONE || s->stop == STOP_INTERRUPTED) && !s->is_cut && state->t > s->t_delivered) {
        const dae *model = &model_about(s->plan->model)->dae;
        output_mark mark = {0};
        if (options->per_unit > 0) {
            mark = output_grid_mark(model, options, state);
        }
        output_buffer_add(&s->outputs, state, options->per_unit > 0 ? &mark : NULL);
        if (output_buffer_evaluate(&s->outputs, false, &block, message) == DAE_OK) {
            (void)give(s, &block);
        }
    }
}

/** Pass on the remaining outputs at the end of the integration. @return how it ended */
static integrate_code give_rest(simulation *s, integrate_code code, char message[DAE_MESSAGE_LENGTH])
{
    char reason[DAE_MESSAGE_LENGTH];
    if (s->stop != STOP_NONE && s->stop != STOP_INTERRUPTED) {
        return code;
    }
    const bool was_interrupted = s->stop == STOP_INTERRUPTED;
    const int failed = deliver_buffered(s, code == INTEGRATE_DONE ? message : reason);
    if (was_interrupted && s->stop == STOP_MISSED) { /* an interrupted simulation is not repeated */
        s->stop = STOP_INTERRUPTED;
        s->is_cut = true;
    }
    return failed != 0 && code == INTEGRATE_DONE ? INTEGRATE_STOPPED : code;
}

/** Fail a run in which rates conflict with the reported quantities, also at its end. @return how it ends */
static integrate_code judge_rates(simulation *s, integrate_code code)
{
    const char *conflict = code == INTEGRATE_DONE ? rate_monitor_conclude(s->rates) : rate_monitor_conflict(s->rates);
    if (conflict == NULL || (code != INTEGRATE_DONE && s->stop != STOP_RATES)) {
        return code;
    }
    s->stop = STOP_RATES;
    (void)snprintf(s->reason, DAE_MESSAGE_LENGTH, "%s", conflict);
    return INTEGRATE_STOPPED;
}

/** Permanent loss of contact is reported only for a complete run. */
static void remark_contact(const simulation *s, simulate_result *result)
{
    (void)separation_monitor_lost(&s->contact, s->t_delivered, s->plan->description->meshes, result->remark,
                                  sizeof result->remark);
}

static void add_remark(const char *text, simulate_result *result)
{
    const size_t length = strlen(result->remark);
    if (text[0] != '\0') {
        (void)snprintf(result->remark + length, sizeof result->remark - length, "%s%s", length > 0 ? "; " : "", text);
    }
}

/** Warn of a self-excited vibration: it starts from an amplitude determined by the tolerance. */
static void remark_growth(const dae_growth *growth, simulate_result *result)
{
    const double size = hypot(growth->rate, growth->frequency);
    char how[80], text[DAE_MESSAGE_LENGTH];
    if (!(growth->rate > 0.0)) {
        return;
    }
    if (growth->frequency > 0.0) {
        (void)snprintf(how, sizeof how, "a self-excited vibration: %.4g Hz, damping ratio %.2g", size / two_pi,
                       -growth->rate / size);
    } else {
        (void)snprintf(how, sizeof how, "a self-excited motion: it grows by %.4g 1/s", growth->rate);
    }
    (void)snprintf(text, sizeof text,
                   "%s at t = %.4g s; steps were shortened for it, but it grows from below the tolerance, so the time "
                   "of its growth is uncertain",
                   how, growth->t);
    add_remark(text, result);
}

/** Warn if a run covered less than a period of its outputs by position. */
static void remark_positions(const positions_counts *positions, simulate_result *result)
{
    char text[DAE_MESSAGE_LENGTH];
    positions_remark(positions, text, sizeof text);
    add_remark(text, result);
}

/** Judge the window of the metrics. A run without a whole period in it did not deliver what the case requests. */
static void check_window(const simulate_sink *sink, simulate_result *result)
{
    if (sink->metrics != NULL && result->end == SIMULATE_DONE) {
        metrics_judge(sink->metrics);
        metrics_explain(sink->metrics, result->message, DAE_MESSAGE_LENGTH);
        result->end = result->message[0] != '\0' ? SIMULATE_FAILED : SIMULATE_DONE;
    }
}

static simulate_end end_of(const simulation *s, integrate_code code)
{
    static const simulate_end ends[] = {[STOP_NONE] = SIMULATE_FAILED,
                                        [STOP_INTERRUPTED] = SIMULATE_INTERRUPTED,
                                        [STOP_CHECKPOINT] = SIMULATE_INTERRUPTED,
                                        [STOP_SPENT] = SIMULATE_FAILED,
                                        [STOP_MODEL] = SIMULATE_FAILED,
                                        [STOP_MISSED] = SIMULATE_MISSED,
                                        [STOP_SINK] = SIMULATE_SINK_FAILED,
                                        [STOP_RATES] = SIMULATE_FAILED};
    return code == INTEGRATE_DONE ? SIMULATE_DONE : ends[s->stop];
}

void simulate(const case_plan *plan, const simulate_sink *sink, const dae_state *start, simulate_result *result)
{
    const dae *dae = &model_about(plan->model)->dae;
    ARENA_SCOPE memory_arena arena = {NULL};
    dae_state state = dae_state_create(dae, &arena);
    dae_state_copy(dae, &state, start);
    *result = (simulate_result){.end = SIMULATE_DONE, .t = start->t};
    simulation s = {.plan = plan,
                    .sink = sink,
                    .positions = {.rule = plan->positions},
                    .t_delivered = -1.0,
                    .reason = result->message};
    const integrate_options *options = &plan->integration;
    const description *description = plan->description;
    if (sink->metrics != NULL) {
        metrics_start(sink->metrics, start, description->simulation.initial.kind == EVL_INITIAL_PERIODIC);
    }
    separation_monitor_init(&s.contact, sink->requested, description->n_meshes);
    s.invariants =
        invariant_monitor_create(sink->requested, description->n_wheels, description->n_meshes, options->tolerance);
    s.rates = rate_monitor_create(plan->model, options->tolerance);
    limit_monitor_init(&s.limits, plan->model);
    output_buffer_init(&s.outputs, sink->requested, sink->waits);
    const integrate_observer observer = {.self = &s,
                                         .output = on_output,
                                         .several = s.outputs.capacity > 1 ? on_several : NULL,
                                         .capacity = capacity,
                                         .change = on_change,
                                         .event = on_event,
                                         .step = on_step,
                                         .monitor = sink->extremes == NULL ? NULL : on_monitor,
                                         .highest = sink->extremes == NULL ? NULL : extremes_highest(sink->extremes),
                                         .is_due = sink->is_due == NULL ? NULL : is_due,
                                         .serialize = sink->serialize == NULL ? NULL : serialize,
                                         .write_checkpoint = write_checkpoint,
                                         .checkpoint_at_limit = sink->checkpoint_at_limit,
                                         .resume = sink->resume};
    integrate_code code = integrate(dae, options, &observer, &state, &result->counts, result->message);
    result->can_go_on = code == INTEGRATE_SPENT && sink->checkpoint_at_limit;
    s.stop = result->can_go_on ? STOP_SPENT : s.stop; /* its outputs were already passed on */
    code = give_rest(&s, code, result->message);
    code = judge_rates(&s, code);
    result->end = end_of(&s, code);
    if (code == INTEGRATE_DONE) {
        remark_contact(&s, result);
        remark_growth(&result->counts.growth, result);
        remark_positions(&s.positions, result);
        add_remark(s.limits.text, result);
        check_window(sink, result);
    } else {
        give_last(&s, &state);
    }
    result->t = s.is_cut ? fmax(s.t_delivered, result->t) : state.t;
    result->held = invariant_monitor_report(s.invariants, result->invariants, sizeof result->invariants);
    result->energy_residual = invariant_monitor_energy(s.invariants);
    invariant_monitor_delete(&s.invariants);
    rate_monitor_delete(&s.rates);
    limit_monitor_free(&s.limits);
    separation_monitor_free(&s.contact);
    output_buffer_free(&s.outputs);
}
