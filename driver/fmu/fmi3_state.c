/* The whole state of an instance, put away and taken up again. What is handed to the importer is an archive. */
#include "fmu/fmi3_instance.h"

#include "base/memory.h"

#include <string.h>

static bool keep(instance *self, archive *archive)
{
    int mode = self->mode;
    KEEP(archive, mode);
    KEEP(archive, self->is_begun);
    KEEP(archive, self->t_end);
    const bool good = motion_keep(self->motion, archive);
    if (good && archive->is_reading) {
        self->mode = (instance_mode)mode;
    }
    return good;
}

static void get_state(instance *self, void *with)
{
    archive **state = with;
    if (*state == NULL) {
        *state = xcalloc(1, sizeof **state);
    }
    archive_free(*state);
    if (!keep(self, *state)) {
        instance_fail(self, DAE_FATAL);
    }
}

fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return instance_call(handle, "fmi3GetFMUState", IN_ANY, get_state, state);
}

static void set_state(instance *self, void *with)
{
    archive from = *(const archive *)with;
    from.is_reading = true;
    from.at = 0;
    if (!keep(self, &from)) {
        instance_fail(self, DAE_FATAL);
    }
}

fmi3Status fmi3SetFMUState(fmi3Instance handle, fmi3FMUState state)
{
    return instance_call(handle, "fmi3SetFMUState", IN_ANY, set_state, state);
}

static void free_state(instance *self, void *with)
{
    archive **state = with;
    (void)self;
    if (*state != NULL) {
        archive_free(*state);
        free(*state);
        *state = NULL;
    }
}

fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return instance_call(handle, "fmi3FreeFMUState", IN_ANY, free_state, state);
}

typedef struct {
    archive *state;
    fmi3Byte *to;
    const fmi3Byte *from;
    size_t size;
} bytes;

static void measure(instance *self, void *with)
{
    bytes *b = with;
    (void)self;
    b->size = b->state->n;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance handle, fmi3FMUState state, size_t *size)
{
    bytes b = {.state = state};
    const fmi3Status status = instance_call(handle, "fmi3SerializedFMUStateSize", IN_ANY, measure, &b);
    *size = b.size;
    return status;
}

static void serialize(instance *self, void *with)
{
    const bytes *b = with;
    if (b->size != b->state->n) {
        instance_refuse(self, fmi3Error, "the state takes %zu bytes, not %zu", b->state->n, b->size);
        return;
    }
    memcpy(b->to, b->state->bytes, b->size);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte to[], size_t size)
{
    return instance_call(handle, "fmi3SerializeFMUState", IN_ANY, serialize,
                         &(bytes){.state = state, .to = to, .size = size});
}

static void deserialize(instance *self, void *with)
{
    bytes *b = with;
    free_state(self, &b->state);
    b->state = xcalloc(1, sizeof *b->state);
    *b->state = (archive){.bytes = xcalloc(b->size + 1, 1), .n = b->size};
    memcpy(b->state->bytes, b->from, b->size);
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte from[], size_t size, fmi3FMUState *state)
{
    bytes b = {.state = *state, .from = from, .size = size};
    const fmi3Status status = instance_call(handle, "fmi3DeserializeFMUState", IN_ANY, deserialize, &b);
    *state = b.state;
    return status;
}
