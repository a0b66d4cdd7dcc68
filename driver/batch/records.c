#include "batch/records.h"

#include "base/memory.h"
#include "batch/journal.h"
#include "batch/journal_line.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/** A shard with a journal. */
typedef struct {
    int index, of;
    char *path;
    char *head;     /**< describes the other lines, usually the first; NULL if damaged and not written again */
    uint32_t check; /**< checksum of the head */
    long n_rows;    /**< valid lines behind it */
    FILE *file;
} shard_journal;

/** Location of the valid record of a case so far. */
typedef struct {
    int shard; /**< -1 if there is none */
    int times; /**< number of records of the case */
    journal_status status;
    long offset;
    size_t length; /**< of the line, without its newline */
    double at;     /**< Unix time [s] */
} record;

typedef struct {
    int n_shards;
    shard_journal *shards; /**< ordered by `of`, then by `index` */
    long n_cases;
    record *records; /**< [n_cases] */
    long torn;       /**< truncated or damaged lines */
} collection;

static int by_split(const void *a, const void *b)
{
    const shard_journal *one = a, *other = b;
    return one->of != other->of ? one->of - other->of : one->index - other->index;
}

/** Whether a name has the form "shard-I-of-N.jsonl". */
static bool read_name(const char *name, shard_journal *journal)
{
    static const char *const words[] = {"shard-", "-of-"};
    long numbers[] = {0, 0};
    for (int i = 0; i < 2; i++) {
        const size_t length = strlen(words[i]);
        if (strncmp(name, words[i], length) != 0) {
            return false;
        }
        char *end = NULL;
        numbers[i] = strtol(name + length, &end, 10);
        name = end;
    }
    *journal = (shard_journal){.index = (int)numbers[0], .of = (int)numbers[1]};
    return strcmp(name, ".jsonl") == 0;
}

static bool find_journals(collection *found, const char *folder, evl_error *error)
{
    DIR *listing = opendir(folder);
    if (listing == NULL) {
        return evl_error_set(error, EVL_EXIT_CASE, folder, "cannot be read: %s", strerror(errno));
    }
    for (const struct dirent *entry = readdir(listing); entry != NULL; entry = readdir(listing)) {
        found->shards = xrealloc(found->shards, (size_t)found->n_shards + 1, sizeof *found->shards);
        shard_journal *journal = &found->shards[found->n_shards];
        if (read_name(entry->d_name, journal)) {
            journal->path = xasprintf("%s/%s", folder, entry->d_name);
            found->n_shards++;
        }
    }
    (void)closedir(listing);
    if (found->n_shards > 1) {
        qsort(found->shards, (size_t)found->n_shards, sizeof *found->shards, by_split);
    }
    return true;
}

/** Read a head. A damaged one is ignored: then no row of the journal is valid until a batch has written it again. */
static bool take_head(collection *found, shard_journal *journal, const char *line, size_t length, evl_error *error)
{
    long format = 0;
    const journal_head_kind kind = journal_line_is_head(line, length, &format);
    if (kind == JOURNAL_OTHER_FORMAT) {
        return evl_error_set(
            error, EVL_EXIT_CASE, journal->path,
            "has journal format %ld, but this evolvent reads format %d; use the evolvent that wrote it", format,
            JOURNAL_FORMAT);
    }
    if (kind == JOURNAL_NO_HEAD) {
        return true;
    }
    const char *count = strstr(line, "\"n_cases\":");
    const long n_cases = count != NULL ? strtol(count + strlen("\"n_cases\":"), NULL, 10) : 0;
    if (n_cases > found->n_cases) {
        found->records = xrealloc(found->records, (size_t)n_cases, sizeof *found->records);
        for (; found->n_cases < n_cases; found->n_cases++) {
            found->records[found->n_cases] = (record){.shard = -1};
        }
    }
    journal->head = xstrdup(line);
    journal->check = journal_line_check(line, length);
    return true;
}

/** Find the head, usually the first line. */
static bool find_head(collection *found, shard_journal *journal, evl_error *error)
{
    char *line = NULL;
    size_t capacity = 0;
    bool good = true;
    for (ssize_t n = 0; good && journal->head == NULL && (n = getline(&line, &capacity, journal->file)) > 0;) {
        if (line[n - 1] == '\n') {
            line[n - 1] = '\0';
            good = take_head(found, journal, line, (size_t)n - 1, error);
        }
    }
    free(line);
    const bool was_read =
        !good || journal->head != NULL || feof(journal->file) != 0; /* a failed allocation for a line */
    if (!was_read || (good && fseek(journal->file, 0, SEEK_SET) != 0)) {
        good = evl_error_set(error, EVL_EXIT_CASE, journal->path, "cannot be read: %s", strerror(errno));
    }
    return good;
}

/** In one journal the later line is valid, regardless of its time; of two journals the later time. */
static void take_record(collection *found, const journal_row *row, record new)
{
    record *known = &found->records[row->index];
    const bool is_older = known->shard >= 0 && known->shard != new.shard && row->at < known->at;
    new.times = known->times + 1;
    if (is_older) {
        known->times++;
    } else {
        *known = new;
    }
}

static bool take_line(collection *found, int shard, const char *line, size_t length, long offset, evl_error *error)
{
    const shard_journal *journal = &found->shards[shard];
    journal_row row;
    long format = 0;
    if (journal->head == NULL || !journal_read_row(line, length, journal->check, &row)) {
        found->torn += journal_line_is_head(line, length, &format) == JOURNAL_NO_HEAD ? 1 : 0;
        return true;
    }
    if (row.index < 0 || row.index >= found->n_cases) {
        return evl_error_set(error, EVL_EXIT_CASE, journal->path, "has case %ld, but the design has %ld", row.index,
                             found->n_cases);
    }
    if (row.status == JOURNAL_MISSING) {
        return evl_error_set(error, EVL_EXIT_CASE, journal->path, "case %ld: the status '%.*s' is unknown", row.index,
                             (int)strcspn(row.word, "\""), row.word);
    }
    found->shards[shard].n_rows++;
    take_record(found, &row,
                (record){.shard = shard, .status = row.status, .offset = offset, .length = length, .at = row.at});
    return true;
}

static bool read_journal(collection *found, int shard, evl_error *error)
{
    shard_journal *journal = &found->shards[shard];
    journal->file = fopen(journal->path, "rb");
    char *line = NULL;
    size_t capacity = 0;
    long offset = 0;
    bool good = journal->file != NULL && find_head(found, journal, error);
    for (ssize_t n = 0; good && (n = getline(&line, &capacity, journal->file)) > 0; offset += n) {
        const bool is_whole = line[n - 1] == '\n';
        line[n - (is_whole ? 1 : 0)] = '\0';
        if (!is_whole) {
            found->torn++;
        } else if (n > 1) {
            good = take_line(found, shard, line, (size_t)n - 1, offset, error);
        }
    }
    free(line);
    if (error->code == EVL_EXIT_OK && (journal->file == NULL || feof(journal->file) == 0)) {
        evl_error_set(error, EVL_EXIT_CASE, journal->path, "cannot be read: %s", strerror(errno));
    }
    return error->code == EVL_EXIT_OK;
}

/** Print the number of cases of each status, and of their lines. */
static void print_counts(FILE *stream, const collection *found)
{
    long n_rows = 0;
    for (int i = 0; i < found->n_shards; i++) {
        n_rows += found->shards[i].n_rows;
    }
    fprintf(stream, "{\"torn\":%ld,\"rows\":%ld", found->torn, n_rows);
    for (journal_status status = JOURNAL_DONE; status <= JOURNAL_REFUSED; status++) {
        long n = 0;
        for (long i = 0; i < found->n_cases; i++) {
            n += found->records[i].shard >= 0 && found->records[i].status == status ? 1 : 0;
        }
        fprintf(stream, ",\"%s\":%ld", journal_status_name(status), n);
    }
}

/** Print the common data of all records, and the cases with several records. */
static void print_heads(FILE *stream, const collection *found)
{
    const char *separator = "";
    fputs(",\"repeated\":[", stream);
    for (long i = 0; i < found->n_cases; i++) {
        if (found->records[i].times > 1) {
            fprintf(stream, "%s%ld", separator, i);
            separator = ",";
        }
    }
    fputs("],\"journals\":[", stream);
    for (int i = 0; i < found->n_shards; i++) {
        const shard_journal *journal = &found->shards[i];
        fprintf(stream, "%s{\"shard\":%d,\"of\":%d,\"rows\":%ld,\"head\":%s}", i == 0 ? "" : ",", journal->index,
                journal->of, journal->n_rows, journal->head != NULL ? journal->head : "null");
    }
    fputs("]", stream);
}

/** Print the journal's line behind the journal's number. */
static bool print_record(FILE *stream, const collection *found, const record *record, bool brief, evl_error *error)
{
    const shard_journal *journal = &found->shards[record->shard];
    CLEANUP_FREE char *line = xcalloc(record->length + 1, 1);
    journal_row row;
    if (fseek(journal->file, record->offset, SEEK_SET) != 0 ||
        fread(line, 1, record->length, journal->file) != record->length ||
        !journal_read_row(line, record->length, journal->check, &row)) {
        return evl_error_set(error, EVL_EXIT_CASE, journal->path, "changed while it was read");
    }
    const char *const behind = line + row.length, *const end = brief ? journal_numbers(&row) : behind;
    fprintf(stream, "{\"journal\":%d,%.*s%.*s}\n", record->shard, (int)(end - line - 1), line + 1,
            brief ? (int)(behind - row.end) : 0, row.end);
    return true;
}

static void collection_free(collection *found)
{
    for (int i = 0; i < found->n_shards; i++) {
        if (found->shards[i].file != NULL) {
            (void)fclose(found->shards[i].file);
        }
        free(found->shards[i].head);
        free(found->shards[i].path);
    }
    free(found->shards);
    free(found->records);
}

evl_exit records(FILE *stream, const char *folder, records_detail detail, evl_error *error)
{
    collection found = {.torn = 0};
    bool good = find_journals(&found, folder, error);
    for (int i = 0; i < found.n_shards && good; i++) {
        good = read_journal(&found, i, error);
    }
    if (good) {
        print_counts(stream, &found);
    }
    if (good && detail != RECORDS_COUNTS) {
        print_heads(stream, &found);
    }
    fputs(good ? "}\n" : "", stream);
    for (long i = 0; i < found.n_cases && good && detail != RECORDS_COUNTS; i++) {
        good = found.records[i].shard < 0 ||
               print_record(stream, &found, &found.records[i], detail == RECORDS_BRIEF, error);
    }
    collection_free(&found);
    return error->code;
}
