/** Serialisation of a state to a byte array, so that another process can resume a computation. One function of a struct
 *  lists its members once:
 *
 *      void thing_serialize(thing *thing, archive *archive)
 *      {
 *          SERIALIZE(archive, thing->count);
 *          SERIALIZE_ARRAY(archive, thing->values, thing->n);
 *      }
 *
 *  The archive decides whether they are written or read: reader and writer cannot diverge. Leaf module. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct archive {
    bool is_reading;
    bool has_failed; /**< reading: the content does not match; everything read from it is invalid */
    unsigned char *bytes;
    size_t n;        /**< bytes in the archive */
    size_t at;       /**< reading: offset of the next bytes */
    size_t capacity; /**< writing: capacity in bytes */
} archive;

/** Write or read `count` elements of `size` bytes; for reading, an array of the same length must exist. */
void archive_serialize(archive *archive, void *things, size_t count, size_t size);
/** Pointer to the next `size` bytes, aligned as by malloc, for writing or reading; NULL if fewer bytes are left. Valid
 *  until the next call. */
void *archive_take(archive *archive, size_t size);
/** Whether an archive was read completely and its content was valid. */
bool archive_is_read(const archive *archive);
void archive_free(archive *archive);

/** Serialise a number, or a struct without pointers. */
#define SERIALIZE(archive, member) archive_serialize((archive), &(member), 1, sizeof(member))
/** Serialise n elements of an allocated array. */
#define SERIALIZE_ARRAY(archive, member, n) archive_serialize((archive), (member), (size_t)(n), sizeof *(member))
