#include "batch/journal.h"

#include "base/memory.h"
#include "base/write_bytes.h"

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
                         "cannot be written: %s; what is recorded stays, go on with --resume", strerror(errno));
}

/** Where the end of a row begins, ",\"at\":TIME}"; NULL if it is torn. No text inside a row can look like that: its quotes
 *  are escaped. */
static const char *find_end(const char *line, size_t length)
{
    static const char mark[] = ",\"at\":";
    const char *end = line + length;
    if (length == 0 || *--end != '}') {
        return NULL;
    }
    while (end > line && (strchr("0123456789.", end[-1]) != NULL)) {
        end--;
    }
    const size_t n = sizeof mark - 1;
    return (size_t)(end - line) > n && end[0] != '}' && memcmp(end - n, mark, n) == 0 ? end - n : NULL;
}

/** What comes after `start` in a text that begins with it; NULL if it does not. */
static const char *after(const char *text, const char *start)
{
    const size_t length = strlen(start);
    return strncmp(text, start, length) == 0 ? text + length : NULL;
}

bool journal_read_row(const char *line, size_t length, journal_row *row)
{
    const char *number = after(line, "{\"case\":");
    char *end = NULL;
    *row = (journal_row){.end = find_end(line, length)};
    if (number == NULL || row->end == NULL) {
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

static void take_line(const char *line, size_t length, long n_cases, journal_case *cases, long *n_rows,
                      long *n_recorded)
{
    journal_row row;
    if (!journal_read_row(line, length, &row)) {
        return;
    }
    ++*n_rows;
    if (row.status != JOURNAL_MISSING && row.index >= 0 && row.index < n_cases) {
        *n_recorded += cases[row.index].status == JOURNAL_MISSING ? 1 : 0;
        cases[row.index] = (journal_case){.status = row.status, .row = *n_rows};
    }
}

/** With one write; the rest of one that came up short is tried for the reason's sake. */
static bool write_all(const journal *journal, const char *text, size_t length, evl_error *error)
{
    const size_t done = write_bytes(journal->descriptor, -1, text, length);
    if (done == length) {
        return true;
    }
    const int reason = errno;
    struct stat file;
    if (done > 0 && fstat(journal->descriptor, &file) == 0) {
        /* if that fails, the line stays torn: it does not count */
        (void)!ftruncate(journal->descriptor, file.st_size - (off_t)done);
    }
    errno = reason;
    return fail(journal, error);
}

/** The whole file but for the head, line by line. @return the head without its newline; NULL if it has none */
static char *read_lines(FILE *file, long n_cases, journal_case *cases, long *n_recorded, bool *is_torn)
{
    char *line = NULL, *head = NULL;
    size_t room = 0;
    long n_rows = 0;
    *is_torn = false;
    for (ssize_t length = getline(&line, &room, file); length > 0; length = getline(&line, &room, file)) {
        *is_torn = line[length - 1] != '\n';
        if (!*is_torn) {
            line[--length] = '\0';
        }
        if (head != NULL) {
            take_line(line, (size_t)length, n_cases, cases, &n_rows, n_recorded);
        } else if (!*is_torn) {
            head = xstrdup(line);
        }
    }
    free(line);
    return head;
}

/** Read what is there, and make the end ready for the next line. */
static bool take_over(journal *journal, const char *head, long n_cases, journal_case *cases, long *n_recorded,
                      evl_error *error)
{
    FILE *file = fopen(journal->path, "rb");
    if (file == NULL) {
        return fail(journal, error);
    }
    bool is_torn = false;
    OWNED char *found = read_lines(file, n_cases, cases, n_recorded, &is_torn);
    const bool was_read = ferror(file) == 0;
    (void)fclose(file);
    if (!was_read) {
        return fail(journal, error);
    }
    if (found == NULL) { /* nothing was ever recorded */
        OWNED char *line = xasprintf("%s\n", head);
        return (ftruncate(journal->descriptor, 0) == 0 || fail(journal, error)) &&
               write_all(journal, line, strlen(line), error);
    }
    if (strcmp(found, head) != 0) {
        return evl_error_set(error, EVL_EXIT_CASE, journal->path,
                             "belongs to another design, or was begun by another version; choose another folder");
    }
    return !is_torn || write_all(journal, "\n", 1, error);
}

bool journal_open(journal *journal, const char *path, const char *head, long n_cases, journal_case *cases,
                  long *n_recorded, evl_error *error)
{
    *journal = (struct journal){.path = xstrdup(path), .is_dirty = true};
    *n_recorded = 0;
    for (long i = 0; i < n_cases; i++) {
        cases[i] = (journal_case){.status = JOURNAL_MISSING};
    }
    journal->descriptor = open(path, O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (journal->descriptor < 0 ? !fail(journal, error)
                                : !take_over(journal, head, n_cases, cases, n_recorded, error)) {
        journal_close(journal);
        return false;
    }
    return true;
}

bool journal_append(journal *journal, const char *line, size_t length, evl_error *error)
{
    journal->is_dirty = true;
    return write_all(journal, line, length, error);
}

bool journal_sync(journal *journal, evl_error *error)
{
    if (!journal->is_dirty) {
        return true;
    }
    journal->is_dirty = false;
    return fsync(journal->descriptor) == 0 || errno == EINVAL || fail(journal, error);
}

void journal_close(journal *journal)
{
    if (journal->descriptor >= 0) {
        (void)close(journal->descriptor);
    }
    free(journal->path);
    *journal = (struct journal){.descriptor = -1};
}
