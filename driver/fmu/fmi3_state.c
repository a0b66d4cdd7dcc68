/* Serialisation of the complete state of an instance. The importer receives an archive. */
#include "fmu/fmi3_instance.h"

#include "base/memory.h"

#include <string.h>

static const char *kind_of(bool by_steps)
{
    return by_steps ? "co-simulation" : "model exchange";
}

static bool serialize_state(instance *self, archive *archive)
{
    int mode = self->mode;
    bool by_steps = self->by_steps;
    SERIALIZE(archive, by_steps);
    if (by_steps != self->by_steps) {
        instance_refuse(self, fmi3Error, "the state is of an instance for %s, this one is for %s", kind_of(by_steps),
                        kind_of(self->by_steps));
        return false;
    }
    SERIALIZE(archive, mode);
    SERIALIZE(archive, self->is_begun);
    SERIALIZE(archive, self->t_end);
    if (!motion_serialize(self->motion, archive)) {
        instance_fail(self, DAE_FATAL);
        return false;
    }
    self->mode = (instance_mode)mode;
    return true;
}

/** Check that a handle from the importer is not NULL; else report it. */
static bool is_state(instance *self, const archive *state)
{
    if (state == NULL) {
        instance_refuse(self, fmi3Error, "there is no state at NULL");
    }
    return state != NULL;
}

static void get_state(instance *self, void *with)
{
    archive **state = with;
    if (*state == NULL) {
        *state = xcalloc(1, sizeof **state);
    }
    archive_free(*state);
    (void)serialize_state(self, *state);
}

fmi3Status fmi3GetFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return instance_call(handle, "fmi3GetFMUState", IN_ANY, get_state, state);
}

static void set_state(instance *self, void *with)
{
    if (is_state(self, with)) {
        archive from = *(const archive *)with;
        from.is_reading = true;
        from.at = 0;
        (void)serialize_state(self, &from);
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
    if (state != NULL && *state != NULL) {
        archive_free(*state);
        free(*state);
        *state = NULL;
    }
}

fmi3Status fmi3FreeFMUState(fmi3Instance handle, fmi3FMUState *state)
{
    return instance_call(handle, "fmi3FreeFMUState", IN_ANY, free_state, state);
}

/* ---- as bytes: identification, checksum of the rest, the rest ---- */

typedef struct {
    char token[SHA256_TEXT], sum[SHA256_TEXT];
} heading;

typedef struct {
    archive *state;
    fmi3Byte *to;
    const fmi3Byte *from;
    size_t size;
} bytes;

static heading heading_of(const instance *self, const void *rest, size_t n)
{
    heading heading;
    sha256 hash;
    memcpy(heading.token, self->token, sizeof heading.token);
    sha256_start(&hash);
    sha256_add(&hash, rest, n);
    sha256_finish(&hash, heading.sum);
    return heading;
}

static void measure(instance *self, void *with)
{
    bytes *b = with;
    b->size = is_state(self, b->state) ? sizeof(heading) + b->state->n : 0;
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
    if (!is_state(self, b->state)) {
        return;
    }
    if (b->size != sizeof(heading) + b->state->n) {
        instance_refuse(self, fmi3Error, "the state takes %zu bytes, not %zu", sizeof(heading) + b->state->n, b->size);
        return;
    }
    const heading heading = heading_of(self, b->state->bytes, b->state->n);
    memcpy(b->to, &heading, sizeof heading);
    memcpy(b->to + sizeof heading, b->state->bytes, b->state->n);
}

fmi3Status fmi3SerializeFMUState(fmi3Instance handle, fmi3FMUState state, fmi3Byte to[], size_t size)
{
    return instance_call(handle, "fmi3SerializeFMUState", IN_ANY, serialize,
                         &(bytes){.state = state, .to = to, .size = size});
}

static void deserialize(instance *self, void *with)
{
    bytes *b = with;
    heading stored = {"", ""};
    const size_t n = b->size > sizeof stored ? b->size - sizeof stored : 0;
    const fmi3Byte *rest = b->from + (n > 0 ? sizeof stored : 0);
    const heading expected = heading_of(self, rest, n);
    if (n > 0) {
        memcpy(&stored, b->from, sizeof stored);
    }
    if (memcmp(stored.token, expected.token, sizeof stored.token) != 0) {
        instance_refuse(self, fmi3Error, "these bytes are not a state of this FMU");
    } else if (memcmp(stored.sum, expected.sum, sizeof stored.sum) != 0) {
        instance_refuse(self, fmi3Error, "these bytes are a damaged state");
    } else {
        free_state(self, &b->state);
        b->state = xcalloc(1, sizeof *b->state);
        *b->state = (archive){.bytes = xcalloc(n, 1), .n = n};
        memcpy(b->state->bytes, rest, n);
    }
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance handle, const fmi3Byte from[], size_t size, fmi3FMUState *state)
{
    bytes b = {.state = *state, .from = from, .size = size};
    const fmi3Status status = instance_call(handle, "fmi3DeserializeFMUState", IN_ANY, deserialize, &b);
    *state = b.state;
    return status;
}
