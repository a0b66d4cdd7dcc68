/** The journal of a shard: what became of its cases, one JSON object a line, appended as they finish. A leaf.
 *
 *  The first line, the head, tells what the others are about. A line counts only when it is complete and has the check that
 *  journal_line.h tells of: whatever ends the program, at most the last line is torn, and that is closed by a newline before the
 *  next one. A head that was damaged is written once more, behind the other lines, which count again then. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { JOURNAL_MISSING, JOURNAL_DONE, JOURNAL_FAILED, JOURNAL_REFUSED } journal_status;

/** "done", "failed", "refused" */
const char *journal_status_name(journal_status status);

/** What is read of a line. */
typedef struct {
    long index;            /**< of the case; it may be none of the design */
    journal_status status; /**< JOURNAL_MISSING if it is none that is known */
    double at;             /**< Unix time [s] */
    const char *word;      /**< the status and what follows */
    const char *end;       /**< of the line, from its time on */
    size_t length;         /**< of the line without its check, which a } would end */
} journal_row;

/** Read a line without its newline.
 *  @param head  check of the journal's head
 *  @return false if it is torn or damaged: it does not count */
bool journal_read_row(const char *line, size_t length, uint32_t head, journal_row *row);
/** Where the numbers of a case begin, behind its message. */
const char *journal_numbers(const journal_row *row);

/** What is recorded of a case. */
typedef struct {
    journal_status status;
    long row; /**< that says so, from 1; 0 if there is none */
} journal_case;

typedef struct journal {
    char *path;
    int descriptor;
    uint32_t head; /**< its check */
    bool is_dirty; /**< something was written since the last journal_sync */
} journal;

/** Open the journal, creating it with the line `head` (without check and newline) if it does not exist or has no complete line.
 *  @param cases  [n_cases] what is recorded of each; the later of two lines counts
 *  @param n_recorded  number of cases of which something is recorded
 *  @return false with the reason in `error`: EVL_EXIT_CASE if it has another head, EVL_EXIT_IO */
bool journal_open(journal *journal, const char *path, const char *head, long n_cases, journal_case *cases,
                  long *n_recorded, evl_error *error);
/** Append a line, to which it gives its check, with one write. A line that does not fit on the disk leaves nothing behind. */
bool journal_append(journal *journal, const char *line, size_t length, evl_error *error);
/** Bring to the disk what was appended. */
bool journal_sync(journal *journal, evl_error *error);
/** Close without a sync. */
void journal_close(journal *journal);
