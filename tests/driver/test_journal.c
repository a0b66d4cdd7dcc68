/* The journal and the lock of a batch: what counts as recorded, and who may record. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/lock.h"
#include "base/memory.h"
#include "batch/journal.h"
#include "batch/journal_line.h"

enum { N_CASES = 4 };
static const char path[] = "test_journal.tmp.jsonl";
static const char head[] = "{\"journal\":2}";
static const char whole_head[] = "{\"journal\":2,\"check\":\"1b4e34a2\"}\n"; /* by zlib.crc32 of Python */
#define ROW(index, status) "{\"case\":" #index ",\"status\":\"" status "\",\"message\":\"{a: 1}\",\"at\":1.5}"

static journal_case cases[N_CASES];
static long n_recorded;

/** A head and lines, each closed by a newline but perhaps the last, with their checks. */
static char *checked(const char *under, const char *lines)
{
    char *next = NULL;
    size_t n = 0;
    char *text = journal_line_make(under, strlen(under), 0, &n);
    const uint32_t check = journal_line_check(text, n - 1);
    for (const char *line = lines; *line != '\0'; text = next) {
        const size_t length = strcspn(line, "\n");
        CLEANUP_FREE char *before = text, *made = journal_line_make(line, length, check, &n);
        next = xasprintf("%s%.*s", before, (int)(line[length] == '\n' ? n : n - 1), made);
        line += length + (line[length] == '\n' ? 1 : 0);
    }
    return text;
}

static void write_file(const char *text)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static void assert_file(const char *expected)
{
    char text[4096] = "";
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    (void)!fread(text, 1, sizeof text - 1, file);
    assert_int_equal(fclose(file), 0);
    assert_string_equal(text, expected);
}

static bool open_file(journal *journal, evl_error *error)
{
    return journal_open(journal, path, head, N_CASES, cases, &n_recorded, error);
}

static int remove_file(void **state)
{
    (void)state;
    return unlink(path) == 0 || access(path, F_OK) != 0 ? 0 : -1;
}

static void a_new_journal_has_its_head_only(void **state)
{
    (void)state;
    journal journal;
    evl_error error;
    assert_true(open_file(&journal, &error));
    assert_int_equal(n_recorded, 0);
    for (int i = 0; i < N_CASES; i++) {
        assert_int_equal(cases[i].status, JOURNAL_MISSING);
    }
    assert_true(journal_sync(&journal, &error));
    journal_close(&journal);
    assert_file(whole_head);
}

static void what_was_appended_is_read_with_its_row_and_the_later_line_counts(void **state)
{
    (void)state;
    static const char *const rows[] = {ROW(2, "failed") "\n", ROW(0, "done") "\n", ROW(2, "done") "\n",
                                       ROW(3, "refused") "\n"};
    journal journal;
    evl_error error;
    assert_true(open_file(&journal, &error));
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        assert_true(journal_append(&journal, rows[i], strlen(rows[i]), &error));
    }
    journal_close(&journal);
    assert_true(open_file(&journal, &error));
    journal_close(&journal);
    static const journal_status expected[] = {JOURNAL_DONE, JOURNAL_MISSING, JOURNAL_DONE, JOURNAL_REFUSED};
    static const long row[] = {2, 0, 3, 4};
    for (int i = 0; i < N_CASES; i++) {
        assert_int_equal(cases[i].status, expected[i]);
        assert_int_equal(cases[i].row, row[i]);
    }
    assert_int_equal(n_recorded, 3);
}

static void every_cut_of_the_last_line_leaves_the_others_and_is_closed(void **state)
{
    (void)state;
    CLEANUP_FREE char *one = checked(head, ROW(1, "done") "\n");
    CLEANUP_FREE char *whole = checked(head, ROW(1, "done") "\n" ROW(2, "failed") "\n");
    const size_t start = strlen(one), length = strlen(whole);
    for (size_t cut = start; cut <= length; cut++) {
        char text[1024], closed[1026];
        journal journal;
        evl_error error;
        (void)snprintf(text, sizeof text, "%.*s", (int)cut, whole);
        write_file(text);
        assert_true(open_file(&journal, &error));
        journal_close(&journal);
        const bool is_there = cut >= length - 1; /* only the newline is missing */
        assert_int_equal(cases[1].status, JOURNAL_DONE);
        assert_int_equal(cases[2].status, is_there ? JOURNAL_FAILED : JOURNAL_MISSING);
        (void)snprintf(closed, sizeof closed, "%s%s", text, cut == start || cut == length ? "" : "\n");
        assert_file(closed);
        assert_true(open_file(&journal, &error)); /* a closed torn line does not count either */
        journal_close(&journal);
        assert_int_equal(cases[2].status, is_there ? JOURNAL_FAILED : JOURNAL_MISSING);
    }
}

static void lines_that_are_none_of_ours_do_not_count(void **state)
{
    (void)state;
    CLEANUP_FREE char *text = checked(head, ROW(4, "done") "\n" ROW(-1, "done") "\n" ROW(1, "lost") "\nhello\n");
    CLEANUP_FREE char *bare = xasprintf("%s" ROW(0, "done") "\nhello\n\n", text);
    write_file(bare);
    journal journal;
    evl_error error;
    assert_true(open_file(&journal, &error));
    journal_close(&journal);
    assert_int_equal(n_recorded, 0);
}

static void a_torn_head_is_written_anew(void **state)
{
    (void)state;
    journal journal;
    evl_error error;
    for (size_t cut = 0; cut < strlen(whole_head); cut++) {
        char text[sizeof whole_head];
        (void)snprintf(text, sizeof text, "%.*s", (int)cut, whole_head);
        write_file(text);
        assert_true(open_file(&journal, &error));
        journal_close(&journal);
        assert_file(whole_head);
    }
}

static void every_changed_bit_loses_the_line_that_has_it_and_no_other(void **state)
{
    (void)state;
    CLEANUP_FREE char *whole = checked(head, ROW(1, "done") "\n" ROW(2, "failed") "\n" ROW(3, "done") "\n");
    const size_t length = strlen(whole);
    int line = 0, n_refused = 0;
    for (size_t i = 0; i < length; i++) {
        const char before = whole[i];
        whole[i] = (char)(before ^ 1 << i % 7);
        write_file(whole);
        whole[i] = before;
        journal journal;
        evl_error error;
        if (!open_file(&journal, &error)) { /* the number of the format, without which nothing is known */
            n_refused++;
            continue;
        }
        journal_close(&journal);
        static const journal_status all[] = {JOURNAL_MISSING, JOURNAL_DONE, JOURNAL_FAILED, JOURNAL_DONE};
        for (int k = 1; k < N_CASES; k++) {
            const bool is_hit = k == line || (before == '\n' && k == line + 1);
            assert_int_equal(cases[k].status, is_hit ? JOURNAL_MISSING : all[k]);
        }
        line += before == '\n' ? 1 : 0;
    }
    assert_int_equal(n_refused, 0);
}

static void a_damaged_head_is_written_anew_and_the_lines_before_it_count(void **state)
{
    (void)state;
    CLEANUP_FREE char *whole = checked(head, ROW(1, "done") "\n");
    whole[3] = 'X';
    write_file(whole);
    CLEANUP_FREE char *expected = xasprintf("%s%s", whole, whole_head);
    journal journal;
    evl_error error;
    for (int times = 0; times < 2; times++) {
        assert_true(open_file(&journal, &error));
        journal_close(&journal);
        assert_int_equal(cases[1].status, JOURNAL_DONE);
        assert_file(expected);
    }
}

static void rows_of_another_head_do_not_count_though_it_is_damaged(void **state)
{
    (void)state;
    CLEANUP_FREE char *other = checked("{\"journal\":2,\"design\":\"another\"}", ROW(1, "done") "\n");
    other[20] ^= 1;
    write_file(other);
    journal journal;
    evl_error error;
    assert_true(open_file(&journal, &error));
    journal_close(&journal);
    assert_int_equal(n_recorded, 0);
}

static void a_journal_of_the_first_format_is_refused(void **state)
{
    (void)state;
    static const char text[] = "{\"journal\":1}\n" ROW(1, "done") "\n";
    journal journal;
    evl_error error;
    write_file(text);
    assert_false(open_file(&journal, &error));
    assert_int_equal(error.code, EVL_EXIT_CASE);
    assert_file(text);
}

static void a_journal_with_another_head_is_refused_and_left_alone(void **state)
{
    (void)state;
    CLEANUP_FREE char *text = checked("{\"journal\":2,\"design\":\"another\"}", ROW(1, "done"));
    journal journal;
    evl_error error;
    write_file(text);
    assert_false(open_file(&journal, &error));
    assert_int_equal(error.code, EVL_EXIT_CASE);
    assert_string_equal(error.location, path);
    assert_file(text);
}

/** A head whose results have these names, units and texts. */
static char *head_of(const char *name, const char *units, const char *long_name)
{
    return xasprintf("{\"journal\":2,\"scalars\":[{\"name\":\"%s\",\"units\":\"%s\",\"long_name\":\"%s\"},"
                     "{\"name\":\"steps\",\"units\":\"1\",\"long_name\":\"steps\"}]}",
                     name, units, long_name);
}

/** Open a journal of one row under the head of another program. @return whether it continues */
static bool continues(const char *before, const char *now)
{
    CLEANUP_FREE char *text = checked(before, ROW(1, "done") "\n");
    write_file(text);
    journal journal;
    evl_error error = {.code = EVL_EXIT_OK};
    const bool good = journal_open(&journal, path, now, N_CASES, cases, &n_recorded, &error);
    if (good) {
        assert_int_equal(n_recorded, 1);
        assert_true(journal_append(&journal, ROW(2, "done") "\n", strlen(ROW(2, "done") "\n"), &error));
        journal_close(&journal);
        CLEANUP_FREE char *both = checked(before, ROW(1, "done") "\n" ROW(2, "done") "\n");
        assert_file(both);
    } else {
        assert_int_equal(error.code, EVL_EXIT_CASE);
        assert_file(text);
    }
    return good;
}

static void a_journal_continues_under_its_head_if_only_texts_of_results_differ(void **state)
{
    (void)state;
    CLEANUP_FREE char *now = head_of("load", "N", "largest load"),
                      *texts = head_of("load", "N", "the load, \\\"most\\\"");
    CLEANUP_FREE char *name = head_of("loads", "N", "largest load"), *units = head_of("load", "kN", "largest load");
    CLEANUP_FREE char *without = head_of("load", "N", "");
    assert_true(continues(now, now));
    assert_true(continues(texts, now));
    assert_true(continues(now, texts));
    assert_true(continues(without, now));
    assert_false(continues(name, now));
    assert_false(continues(units, now));
    assert_false(continues(head, now));
    assert_false(continues(now, head));
}

static void a_line_that_finds_no_room_leaves_nothing_behind(void **state)
{
    (void)state;
    static const char row[] = ROW(1, "done") "\n";
    const struct rlimit none = {RLIM_INFINITY, RLIM_INFINITY};
    CLEANUP_FREE char *fits = checked(head, row);
    struct rlimit size = {strlen(fits) + 10, RLIM_INFINITY}; /* one row and ten bytes */
    journal journal;
    evl_error error;
    (void)signal(SIGXFSZ, SIG_IGN);
    assert_true(open_file(&journal, &error));
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &size), 0);
    const bool first = journal_append(&journal, row, sizeof row - 1, &error);
    const bool second = journal_append(&journal, row, sizeof row - 1, &error);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &none), 0);
    journal_close(&journal);
    assert_true(first);
    assert_false(second);
    assert_int_equal(error.code, EVL_EXIT_IO);
    assert_non_null(strstr(error.message, "File too large"));
    assert_file(fits);
}

/* ---- the lock ---- */

static const char lock_path[] = "test_journal.tmp.lock";

/** Try to take the lock in another process. @return what it got: 0 the lock, else the error's code */
static int try_elsewhere(char *message, size_t size)
{
    int ends[2], result = 0;
    assert_int_equal(pipe(ends), 0);
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        file_lock lock;
        evl_error error = {.code = EVL_EXIT_OK};
        (void)file_lock_take(&lock, lock_path, &error);
        (void)!write(ends[1], error.message, strlen(error.message) + 1);
        _exit(error.code);
    }
    (void)close(ends[1]);
    const ssize_t n = read(ends[0], message, size - 1);
    message[n > 0 ? n : 0] = '\0';
    (void)close(ends[0]);
    assert_int_equal(waitpid(pid, &result, 0), pid);
    return WEXITSTATUS(result);
}

static void a_lock_that_is_held_is_refused_naming_its_owner(void **state)
{
    (void)state;
    file_lock lock;
    evl_error error = {.code = EVL_EXIT_OK};
    char message[EVL_ERROR_MESSAGE_LENGTH], owner[64];
    assert_true(file_lock_take(&lock, lock_path, &error));
    assert_int_equal(try_elsewhere(message, sizeof message), EVL_EXIT_CASE);
    (void)snprintf(owner, sizeof owner, "pid %ld on ", (long)getpid());
    assert_non_null(strstr(message, owner));
    file_lock_release(&lock);
    assert_int_equal(try_elsewhere(message, sizeof message), 0);
    assert_int_equal(unlink(lock_path), 0);
}

static void a_lock_ends_with_its_owner(void **state)
{
    (void)state;
    char message[EVL_ERROR_MESSAGE_LENGTH];
    assert_int_equal(try_elsewhere(message, sizeof message), 0); /* took it, and ended without a word */
    assert_int_equal(access(lock_path, F_OK), 0);
    assert_int_equal(try_elsewhere(message, sizeof message), 0);
    assert_int_equal(unlink(lock_path), 0);
}

static void a_lock_in_no_folder_is_an_error_of_output(void **state)
{
    (void)state;
    file_lock lock;
    evl_error error;
    assert_false(file_lock_take(&lock, "no/such/folder/x.lock", &error));
    assert_int_equal(error.code, EVL_EXIT_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_teardown(a_new_journal_has_its_head_only, remove_file),
        cmocka_unit_test_teardown(what_was_appended_is_read_with_its_row_and_the_later_line_counts, remove_file),
        cmocka_unit_test_teardown(every_cut_of_the_last_line_leaves_the_others_and_is_closed, remove_file),
        cmocka_unit_test_teardown(lines_that_are_none_of_ours_do_not_count, remove_file),
        cmocka_unit_test_teardown(a_torn_head_is_written_anew, remove_file),
        cmocka_unit_test_teardown(every_changed_bit_loses_the_line_that_has_it_and_no_other, remove_file),
        cmocka_unit_test_teardown(a_damaged_head_is_written_anew_and_the_lines_before_it_count, remove_file),
        cmocka_unit_test_teardown(rows_of_another_head_do_not_count_though_it_is_damaged, remove_file),
        cmocka_unit_test_teardown(a_journal_of_the_first_format_is_refused, remove_file),
        cmocka_unit_test_teardown(a_journal_with_another_head_is_refused_and_left_alone, remove_file),
        cmocka_unit_test_teardown(a_journal_continues_under_its_head_if_only_texts_of_results_differ, remove_file),
        cmocka_unit_test_teardown(a_line_that_finds_no_room_leaves_nothing_behind, remove_file),
        cmocka_unit_test(a_lock_that_is_held_is_refused_naming_its_owner),
        cmocka_unit_test(a_lock_ends_with_its_owner),
        cmocka_unit_test(a_lock_in_no_folder_is_an_error_of_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
