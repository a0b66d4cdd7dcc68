#include "batch/journal.h"

#include "base/log.h"
#include "base/memory.h"
#include "base/write_bytes.h"
#include "batch/journal_line.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char *const status_names[] = {
    [JOURNAL_MISSING] = "missing", [JOURNAL_DONE] = "done", [JOURNAL_FAILED] = "failed", [JOURNAL_REFUSED] = "refused"};

const char *journal_status_name(journal_status status)
{
    return status_names[status];
}

/** @return false */
static bool fail(const journal *journal, evl_error *error)
{
    return evl_error_set(error, EVL_EXIT_IO, journal->path,
                         "cannot be written: %s; recorded cases are preserved, continue with --resume",
                         strerror(errno));
}

/** Start of the time of a row, ",\"at\":TIME"; NULL if there is none. No text inside a row can look like that: its
 *  quotes are escaped. */
static const char *find_end(const char *line, size_t length)
{
    static const char mark[] = ",\"at\":";
    const char *end = line + length;
    while (end > line && (strchr("0123456789.", end[-1]) != NULL)) {
        end--;
    }
    const size_t n = sizeof mark - 1;
    return (size_t)(end - line) > n && end < line + length && memcmp(end - n, mark, n) == 0 ? end - n : NULL;
}

/** Rest of a text that starts with `start`; NULL if it does not. */
static const char *after(const char *text, const char *start)
{
    const size_t length = strlen(start);
    return strncmp(text, start, length) == 0 ? text + length : NULL;
}

bool journal_read_row(const char *line, size_t length, uint32_t head, journal_row *row)
{
    const char *number = after(line, "{\"case\":");
    char *end = NULL;
    *row = (journal_row){.length = number == NULL ? 0 : journal_line_read(line, length, head)};
    row->end = row->length == 0 ? NULL : find_end(line, row->length);
    if (row->end == NULL) {
        return false;
    }
    row->index = strtol(number, &end, 10);
    row->word = after(end, ",\"status\":\"");
    row->at = strtod(row->end + strlen(",\"at\":"), NULL);
    for (int i = JOURNAL_DONE; i <= JOURNAL_REFUSED && row->word != NULL; i++) {
        const char *rest = after(row->word, status_names[i]);
        row->status = rest != NULL && rest[0] == '"' ? (journal_status)i : row->status;
    }
    return row->word != NULL;
}

const char *journal_numbers(const journal_row *row)
{
    const char *text = strstr(row->word, "\"message\":\"");
    if (text == NULL) {
        return row->end;
    }
    for (text += strlen("\"message\":\""); *text != '"' && text < row->end; text++) {
        text += *text == '\\' ? 1 : 0;
    }
    return text < row->end ? text + 1 : row->end;
}

static void take_line(const char *line, size_t length, uint32_t head, long n_cases, journal_case *cases, long *n_rows,
                      long *n_recorded)
{
    journal_row row;
    if (!journal_read_row(line, length, head, &row)) {
        return;
    }
    ++*n_rows;
    if (row.status != JOURNAL_MISSING && row.index >= 0 && row.index < n_cases) {
        *n_recorded += cases[row.index].status == JOURNAL_MISSING ? 1 : 0;
        cases[row.index] = (journal_case){.status = row.status, .row = *n_rows};
    }
}

/** Write with one call; the remainder of an incomplete write is tried to obtain the reason. */
static bool write_all(const journal *journal, const char *text, size_t length, evl_error *error)
{
    const size_t done = write_bytes(journal->descriptor, -1, text, length);
    if (done == length) {
        return true;
    }
    const int reason = errno;
    struct stat file;
    if (done > 0 && fstat(journal->descriptor, &file) == 0) {
        /* if that fails, the line remains truncated and is invalid */
        (void)!ftruncate(journal->descriptor, file.st_size - (off_t)done);
    }
    errno = reason;
    return fail(journal, error);
}

/** State of a journal apart from its rows. */
typedef struct {
    bool has_line;  /**< at least one complete line */
    bool has_head;  /**< the expected head */
    bool has_other; /**< another head precedes it */
    bool is_torn;   /**< the last line is truncated */
} journal_state;

/** Read the whole file, line by line: rows are valid under `head`, a line without its newline, wherever it is. */
static journal_state read_lines(FILE *file, const journal *journal, const char *head, long n_cases, journal_case *cases,
                                long *n_recorded)
{
    journal_state state = {.has_line = false};
    char *line = NULL;
    size_t capacity = 0;
    long n_rows = 0, format = 0;
    for (ssize_t length = getline(&line, &capacity, file); length > 0; length = getline(&line, &capacity, file)) {
        state.is_torn = line[length - 1] != '\n';
        if (!state.is_torn) {
            line[--length] = '\0';
            state.has_line = true;
        }
        if (!state.is_torn && journal_line_is_head(line, (size_t)length, &format) != JOURNAL_NO_HEAD) {
            const bool is_this = strcmp(line, head) == 0;
            state.has_other = state.has_other || (!is_this && !state.has_head);
            state.has_head = state.has_head || is_this;
        } else {
            take_line(line, (size_t)length, journal->head, n_cases, cases, &n_rows, n_recorded);
        }
    }
    free(line);
    return state;
}

/** The head of a file that agrees with `head`: a new string; `head` itself if there is none. Rows have the checksum of
 *  the head under which the journal was started. */
static char *find_head(const char *path, const char *head)
{
    FILE *file = fopen(path, "rb");
    char *line = NULL;
    size_t capacity = 0;
    long format = 0;
    bool found = false;
    ssize_t length = 0;
    while (file != NULL && !found && (length = getline(&line, &capacity, file)) > 0) {
        length -= line[length - 1] == '\n' ? 1 : 0;
        line[length] = '\0';
        found = journal_line_is_head(line, (size_t)length, &format) == JOURNAL_HEAD && journal_heads_agree(line, head);
    }
    if (file != NULL) {
        (void)fclose(file);
    }
    char *result = xstrdup(found ? line : head);
    free(line);
    return result;
}

/** Read the existing lines, and prepare the end for the next line.
 *  @param head  with its checksum and newline, `n` bytes */
static bool take_over(journal *journal, const char *head, size_t n, long n_cases, journal_case *cases, long *n_recorded,
                      evl_error *error)
{
    CLEANUP_FREE char *present = xasprintf("%.*s", (int)n - 1, head), *expected = find_head(journal->path, present);
    journal->head = journal_line_check(expected, strlen(expected));
    FILE *file = fopen(journal->path, "rb");
    if (file == NULL) {
        return fail(journal, error);
    }
    const journal_state state = read_lines(file, journal, expected, n_cases, cases, n_recorded);
    const bool was_read = feof(file) != 0; /* a failed allocation for a line is not a file error */
    (void)fclose(file);
    if (!was_read) {
        return fail(journal, error);
    }
    if (state.has_other) {
        return evl_error_set(error, EVL_EXIT_CASE, journal->path,
                             "belongs to another design, or was started by another version; choose another folder");
    }
    if (!state.has_line) { /* nothing was recorded yet */
        return (ftruncate(journal->descriptor, 0) == 0 || fail(journal, error)) && write_all(journal, head, n, error);
    }
    if (state.is_torn && !write_all(journal, "\n", 1, error)) {
        return false;
    }
    if (!state.has_head) {
        log_warning("%s: its first line is damaged and is rewritten; %ld cases are recorded", journal->path,
                    *n_recorded);
    }
    return state.has_head || write_all(journal, head, n, error);
}

bool journal_open(journal *journal, const char *path, const char *head, long n_cases, journal_case *cases,
                  long *n_recorded, evl_error *error)
{
    *journal = (struct journal){.path = xstrdup(path), .is_dirty = true};
    *n_recorded = 0;
    size_t n = 0;
    CLEANUP_FREE char *line = journal_line_make(head, strlen(head), 0, &n);
    for (long i = 0; i < n_cases; i++) {
        cases[i] = (journal_case){.status = JOURNAL_MISSING};
    }
    journal->descriptor = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (journal->descriptor < 0 ? !fail(journal, error)
                                : !take_over(journal, line, n, n_cases, cases, n_recorded, error)) {
        journal_close(journal);
        return false;
    }
    return true;
}

bool journal_append(journal *journal, const char *line, size_t length, evl_error *error)
{
    size_t n = 0;
    CLEANUP_FREE char *checked = journal_line_make(line, length, journal->head, &n);
    journal->is_dirty = true;
    return write_all(journal, checked, n, error);
}

bool journal_sync(journal *journal, evl_error *error)
{
    if (!journal->is_dirty) {
        return true;
    }
    journal->is_dirty = false;
    return sync_bytes(journal->descriptor) || fail(journal, error);
}

void journal_close(journal *journal)
{
    if (journal->descriptor >= 0) {
        (void)close(journal->descriptor);
    }
    free(journal->path);
    *journal = (struct journal){.descriptor = -1};
}
