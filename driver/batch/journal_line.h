/** Line of a journal with a checksum at its end, to detect truncated or damaged lines. Leaf module.
 *
 *  {"case":7,...,"at":1.5} becomes {"case":7,...,"at":1.5,"check":"1a2b3c4d"}: the CRC-32 of all bytes before
 *  `,"check"`. That of the head stands alone; that of a row continues from it, so that a row is invalid under another
 *  head. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { JOURNAL_FORMAT = 2 };

/** The line with its checksum and a newline, as a new string.
 *  @param line  a JSON object of `length` bytes, with or without a newline behind it
 *  @param head  checksum of the head; 0: the line is the head
 *  @param n  length of the result */
char *journal_line_make(const char *line, size_t length, uint32_t head, size_t *n);
/** Length of the part before the checksum of a line without its newline; 0 if the checksum is wrong. */
size_t journal_line_read(const char *line, size_t length, uint32_t head);
/** The checksum at the end of a line that has one. */
uint32_t journal_line_check(const char *line, size_t length);

typedef enum { JOURNAL_NO_HEAD, JOURNAL_HEAD, JOURNAL_OTHER_FORMAT } journal_head_kind;

/** Whether two heads with checksums differ at most in the texts `long_name`, as those of two versions of the program
 *  may. */
bool journal_heads_agree(const char *a, const char *b);

/** Whether a line without its newline is a journal's head.
 *  @param format  that of a head, also of one in another format */
journal_head_kind journal_line_is_head(const char *line, size_t length, long *format);
