/* Serialisation of a motion. */
#include "motion/motion.h"

#include "motion/motion_parts.h"

#include <string.h>

/** Serialise the parameters; after reading different ones the model is created again. */
static bool serialize_parameters(motion *m, archive *archive)
{
    bool differs = false;
    for (int i = 0; i < m->about.n_parameters; i++) {
        motion_parameter *own = &m->about.parameters[i];
        const size_t size = (size_t)own->of.n * sizeof *own->numbers;
        CLEANUP_FREE double *before = memcpy(xcalloc((size_t)own->of.n, sizeof *before), own->numbers, size);
        const bool was_set = own->is_set;
        SERIALIZE(archive, own->is_set);
        SERIALIZE_ARRAY(archive, own->numbers, own->of.n);
        differs = differs || was_set != own->is_set || memcmp(before, own->numbers, size) != 0;
    }
    return !archive->is_reading || !differs || (!archive->has_failed && motion_renew(m));
}

static void serialize_state(motion *m, archive *archive, dae_state *state)
{
    SERIALIZE(archive, state->t);
    SERIALIZE_ARRAY(archive, state->y, m->dae->n);
    SERIALIZE_ARRAY(archive, state->yp, m->dae->n);
    SERIALIZE_ARRAY(archive, state->integers, m->dae->n_integers);
    SERIALIZE_ARRAY(archive, state->reals, m->dae->n_reals);
}

bool motion_serialize(motion *m, archive *archive)
{
    m->error = (evl_error){EVL_EXIT_OK, "", ""};
    if (!serialize_parameters(m, archive)) {
        return false;
    }
    for (int i = 0; i < m->about.n_inputs; i++) {
        motion_input *input = &m->about.inputs[i];
        SERIALIZE(archive, input->value);
        SERIALIZE(archive, input->rate);
        SERIALIZE(archive, input->is_new);
        SERIALIZE(archive, input->used);
        model_feed(m->plan.model, input->of.load, input->value, input->used);
    }
    serialize_state(m, archive, &m->now);
    serialize_state(m, archive, &m->reach);
    SERIALIZE(archive, m->at_event);
    SERIALIZE(archive, m->at_time_event);
    SERIALIZE(archive, m->t_end);
    SERIALIZE_ARRAY(archive, m->fired, m->dae->n_roots);
    progress_rate_serialize(&m->progress_rate, archive);
    bool has_stepper = m->stepper != NULL;
    SERIALIZE(archive, has_stepper);
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
        m->dae->stepper->serialize(m->stepper, archive);
    }
    return !archive->has_failed || motion_fail(m, "the stored state does not belong to this case and program");
}
