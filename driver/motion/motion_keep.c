/* Serialisation of a motion. */
#include "motion/motion.h"

#include "motion/motion_parts.h"

#include <string.h>

/** Serialise the parameters; after reading different ones the model is created again. */
static bool keep_parameters(motion *m, archive *archive)
{
    bool differs = false;
    for (int i = 0; i < m->about.n_parameters; i++) {
        motion_parameter *own = &m->about.parameters[i];
        const size_t size = (size_t)own->of.n * sizeof *own->numbers;
        OWNED double *before = memcpy(xcalloc((size_t)own->of.n, sizeof *before), own->numbers, size);
        const bool was_given = own->is_given;
        KEEP(archive, own->is_given);
        KEEP_ARRAY(archive, own->numbers, own->of.n);
        differs = differs || was_given != own->is_given || memcmp(before, own->numbers, size) != 0;
    }
    return !archive->is_reading || !differs || (!archive->has_failed && motion_renew(m));
}

static void keep_state(motion *m, archive *archive, dae_state *state)
{
    KEEP(archive, state->t);
    KEEP_ARRAY(archive, state->y, m->dae->n);
    KEEP_ARRAY(archive, state->yp, m->dae->n);
    KEEP_ARRAY(archive, state->integers, m->dae->n_integers);
    KEEP_ARRAY(archive, state->reals, m->dae->n_reals);
}

bool motion_keep(motion *m, archive *archive)
{
    m->error = (evl_error){EVL_EXIT_OK, "", ""};
    if (!keep_parameters(m, archive)) {
        return false;
    }
    for (int i = 0; i < m->about.n_inputs; i++) {
        motion_input *input = &m->about.inputs[i];
        KEEP(archive, input->value);
        KEEP(archive, input->rate);
        KEEP(archive, input->is_new);
        KEEP(archive, input->used);
        model_feed(m->prepared.model, input->of.load, input->value, input->used);
    }
    keep_state(m, archive, &m->now);
    keep_state(m, archive, &m->reach);
    KEEP(archive, m->at_event);
    KEEP(archive, m->at_time_event);
    KEEP(archive, m->t_end);
    KEEP_ARRAY(archive, m->fired, m->dae->n_roots);
    pace_keep(&m->pace, archive);
    bool has_stepper = m->stepper != NULL;
    KEEP(archive, has_stepper);
    m->has_outputs = false;
    if (archive->is_reading && !archive->has_failed) {
        if (has_stepper && !motion_make_stepper(m)) {
            return false;
        }
        if (!has_stepper) {
            motion_stop_stepper(m);
        }
    }
    if (has_stepper && !archive->has_failed) {
        m->dae->stepper->keep(m->stepper, archive);
    }
    return !archive->has_failed || motion_fail(m, "the stored state does not belong to this case and program");
}
