#include "base/archive.h"

#include "base/memory.h"

#include <string.h>

void *archive_take(archive *archive, size_t size)
{
    enum { LEAST = 4096, WORD = 8 };
    size += (WORD - size % WORD) % WORD;
    if (archive->is_reading) {
        archive->has_failed = archive->has_failed || archive->bytes == NULL || size > archive->n - archive->at;
        unsigned char *from = archive->has_failed ? NULL : archive->bytes + archive->at;
        archive->at += archive->has_failed ? 0 : size;
        return from;
    }
    if (size > archive->capacity - archive->n) {
        archive->capacity = 2 * archive->capacity + size + LEAST;
        archive->bytes = xrealloc(archive->bytes, archive->capacity, 1);
    }
    archive->n += size;
    if (size > 0) {
        memset(archive->bytes + archive->n - WORD, 0, WORD); /* padding of the last word */
    }
    return archive->bytes + archive->n - size;
}

void archive_serialize(archive *archive, void *things, size_t count, size_t size)
{
    const size_t length = count * size;
    size_t there = length;
    void *buffer = archive_take(archive, sizeof length);
    if (buffer != NULL) {
        memcpy(archive->is_reading ? (void *)&there : buffer, archive->is_reading ? buffer : &length, sizeof length);
    }
    archive->has_failed = archive->has_failed || there != length;
    buffer = archive->has_failed ? NULL : archive_take(archive, length);
    if (buffer != NULL && length > 0) {
        memcpy(archive->is_reading ? things : buffer, archive->is_reading ? buffer : things, length);
    }
}

bool archive_is_read(const archive *archive)
{
    return !archive->has_failed && archive->at == archive->n;
}

void archive_free(archive *archive)
{
    free(archive->bytes);
    *archive = (struct archive){0};
}
