/** A state in a row of bytes, so that a computation can go on in another process. One function of a struct names its members once:
 *
 *      void thing_keep(thing *thing, archive *archive)
 *      {
 *          KEEP(archive, thing->count);
 *          KEEP_ARRAY(archive, thing->values, thing->n);
 *      }
 *
 *  and whether they are written or read is the archive's business: what is kept cannot drift apart. A leaf. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct archive {
    bool is_reading;
    bool has_failed; /**< of one that is read: it holds something else; what was read is of no use */
    unsigned char *bytes;
    size_t n;    /**< bytes that there are */
    size_t at;   /**< of one that is read: where it goes on */
    size_t room; /**< of one that is written */
} archive;

/** Keep `size` bytes; an array of the same length has to be there when they are read. */
void archive_keep(archive *archive, void *things, size_t count, size_t size);
/** The place of the next `size` bytes, as malloc aligns numbers: to be written, or to be read; NULL if there are not so many. It lasts
 *  until the next call. */
void *archive_take(archive *archive, size_t size);
/** Whether an archive was read to its end, and all of it was what it should be. */
bool archive_is_read(const archive *archive);
void archive_free(archive *archive);

/** Keep a number, or a struct without pointers. */
#define KEEP(archive, member) archive_keep((archive), &(member), 1, sizeof(member))
/** Keep n elements of an array that is there. */
#define KEEP_ARRAY(archive, member, n) archive_keep((archive), (member), (size_t)(n), sizeof *(member))
