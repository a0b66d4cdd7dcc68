#include "batch/journal_line.h"

#include "base/crc32.h"
#include "base/memory.h"

#include <stdbool.h>
#include <string.h>

enum { DIGITS = 8, TAIL = 20 /**< length of the line from the mark on */ };
static const char mark[] = ",\"check\":\"", ending[] = "\"}";

char *journal_line_make(const char *line, size_t length, uint32_t head, size_t *n)
{
    while (length > 0 && (line[length - 1] == '\n' || line[length - 1] == '}')) {
        length--;
    }
    char *made = xcalloc(length + TAIL + 2, 1);
    memcpy(made, line, length);
    *n = length +
         (size_t)snprintf(made + length, TAIL + 2, "%s%08x%s\n", mark, (unsigned)crc32_on(head, line, length), ending);
    return made;
}

size_t journal_line_read(const char *line, size_t length, uint32_t head)
{
    if (length <= TAIL) {
        return 0;
    }
    const size_t before = length - TAIL;
    char tail[TAIL + 1];
    (void)snprintf(tail, sizeof tail, "%s%08x%s", mark, (unsigned)crc32_on(head, line, before), ending);
    return memcmp(line + before, tail, TAIL) == 0 ? before : 0;
}

uint32_t journal_line_check(const char *line, size_t length)
{
    return (uint32_t)strtoul(line + (length - DIGITS - (sizeof ending - 1)), NULL, 16);
}

/** End of a JSON text: its closing quote. */
static const char *text_end(const char *at)
{
    while (*at != '\0' && *at != '"') {
        at += *at == '\\' && at[1] != '\0' ? 2 : 1;
    }
    return at;
}

bool journal_heads_agree(const char *a, const char *b)
{
    static const char skipped[] = "\"long_name\":\"";
    const size_t n = sizeof skipped - 1, n_mark = sizeof mark - 1;
    while (*a == *b && *a != '\0' && (strncmp(a, mark, n_mark) != 0 || strncmp(b, mark, n_mark) != 0)) {
        const bool is_skipped = strncmp(a, skipped, n) == 0 && strncmp(b, skipped, n) == 0;
        a = is_skipped ? text_end(a + n) : a + 1;
        b = is_skipped ? text_end(b + n) : b + 1;
    }
    return *a == *b;
}

journal_head_kind journal_line_is_head(const char *line, size_t length, long *format)
{
    static const char start[] = "{\"journal\":";
    const size_t n = sizeof start - 1;
    if (length <= n || strncmp(line, start, n) != 0) {
        return JOURNAL_NO_HEAD;
    }
    *format = strtol(line + n, NULL, 10);
    const bool has_check = strstr(line, mark) != NULL; /* the first format had no checksum */
    if (has_check ? journal_line_read(line, length, 0) == 0 : *format == JOURNAL_FORMAT) {
        return JOURNAL_NO_HEAD;
    }
    return *format == JOURNAL_FORMAT ? JOURNAL_HEAD : JOURNAL_OTHER_FORMAT;
}
