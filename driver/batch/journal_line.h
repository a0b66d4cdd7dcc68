/** A line of a journal and the check at its end, by which a line that was torn or damaged is known. A leaf.
 *
 *  {"case":7,...,"at":1.5} becomes {"case":7,...,"at":1.5,"check":"1a2b3c4d"}: the CRC-32 of all before `,"check"`. That of the
 *  head stands by itself; that of a row goes on from it, so that no row counts under another head. */
#pragma once

#include "base/status.h"

#include <stddef.h>
#include <stdint.h>

enum { JOURNAL_FORMAT = 2 };

/** The line with its check and a newline, as a new string.
 *  @param line  a JSON object of `length` bytes, with or without a newline behind it
 *  @param head  check of the head; 0: it is the head itself
 *  @param n  length of the result */
char *journal_line_make(const char *line, size_t length, uint32_t head, size_t *n);
/** Length of what stands in front of the check of a line without its newline; 0 if the check is not that of the line. */
size_t journal_line_read(const char *line, size_t length, uint32_t head);
/** The check at the end of a line that has one. */
uint32_t journal_line_check(const char *line, size_t length);

typedef enum { JOURNAL_NO_HEAD, JOURNAL_HEAD, JOURNAL_OTHER_FORMAT } journal_head_kind;

/** Whether a line without its newline is a journal's head.
 *  @param format  that of a head, also of one of another format */
journal_head_kind journal_line_is_head(const char *line, size_t length, long *format);
