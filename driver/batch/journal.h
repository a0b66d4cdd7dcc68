/** Journal of a shard: results of its cases, one JSON object a line, appended as they finish. Leaf module.
 *
 *  The first line, the head, identifies the others. A line is valid only if it is complete and has the checksum
 *  described in journal_line.h. However the program ends, at most the last line is truncated; it is closed by a newline
 *  before the next one. A damaged head is written again behind the other lines, which then become valid again. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { JOURNAL_MISSING, JOURNAL_DONE, JOURNAL_FAILED, JOURNAL_REFUSED } journal_status;

/** "done", "failed", "refused" */
const char *journal_status_name(journal_status status);

/** Content of a line. */
typedef struct {
    long index;            /**< of the case; it may not exist in the design */
    journal_status status; /**< JOURNAL_MISSING if it is unknown */
    double at;             /**< Unix time [s] */
    const char *word;      /**< the status and the following text */
    const char *end;       /**< of the line, starting at its time */
    size_t length;         /**< of the line without its checksum; closed by a } */
} journal_row;

/** Read a line without its newline.
 *  @param head  checksum of the journal's head
 *  @return false if it is truncated or damaged: then it is invalid */
bool journal_read_row(const char *line, size_t length, uint32_t head, journal_row *row);
/** Start of the metrics of a case, behind its message. */
const char *journal_numbers(const journal_row *row);

/** Record of a case. */
typedef struct {
    journal_status status;
    long row; /**< line of the record, from 1; 0 if there is none */
} journal_case;

typedef struct journal {
    char *path;
    int descriptor;
    uint32_t head; /**< its checksum */
    bool is_dirty; /**< something was written since the last journal_sync */
} journal;

/** Open the journal, creating it with the line `head` (without checksum and newline) if it does not exist or has no
 *  complete line.
 *  @param cases  [n_cases] records of each; the later of two lines is valid
 *  @param n_recorded  number of recorded cases
 *  @return false with the reason in `error`: EVL_EXIT_CASE if it has another head, EVL_EXIT_IO */
bool journal_open(journal *journal, const char *path, const char *head, long n_cases, journal_case *cases,
                  long *n_recorded, evl_error *error);
/** Append a line and its checksum, with one write. A line that does not fit on the disk leaves no remainder. */
bool journal_append(journal *journal, const char *line, size_t length, evl_error *error);
/** Synchronise the journal to the disk. */
bool journal_sync(journal *journal, evl_error *error);
/** Close without a sync. */
void journal_close(journal *journal);
