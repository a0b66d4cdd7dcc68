/* What any bytes do to the reader of cases, in process, for libFuzzer: the text of a case and, behind zero bytes, --set options. */
#include "base/memory.h"
#include "case/case.h"
#include "model/model.h"

#include <stdint.h>
#include <string.h>
#include <time.h>

enum { MOST_OPTIONS = 4 };

static struct {
    double seconds;
    size_t size;
    uint8_t *data;
} slowest; /* input of this process; libFuzzer itself counts whole seconds */

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/** A case that is good says the same when it is read again. */
static void read_again(const case_file *file)
{
    evl_error error;
    CLEANUP_FREE char *text = case_text_for_reading(file, model_schema());
    if (strstr(text, " more)") != NULL) { /* a list was cut */
        return;
    }
    case_base *base = case_base_parse("again", text, model_schema(), &error);
    case_file *again = NULL;
    if (base == NULL || !case_override(base, 0, NULL, &again, &error)) {
        fprintf(stderr, "not read again: %s: %s\n%s", error.location, error.message, text);
        abort();
    }
    case_delete(&again);
    case_base_delete(&base);
}

/** One line that says something and where. */
static void check_refusal(const evl_error *error)
{
    if (error->code == EVL_EXIT_OK || error->message[0] == '\0' || strchr(error->message, '\n') != NULL) {
        abort();
    }
}

static double processor_time(void)
{
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/** At the end: the slowest input is named, and kept where FUZZ_SLOWEST says. */
static void report_slowest(void)
{
    const char *path = getenv("FUZZ_SLOWEST");
    fprintf(stderr, "slowest input: %.3f s, %zu bytes\n", slowest.seconds, slowest.size);
    FILE *file = path == NULL ? NULL : fopen(path, "wb");
    if (file != NULL) {
        (void)fwrite(slowest.data, 1, slowest.size, file);
        (void)fclose(file);
    }
    free(slowest.data);
}

static void note_time(double seconds, const uint8_t *data, size_t size)
{
    if (slowest.data == NULL) {
        (void)atexit(report_slowest);
    }
    if (slowest.data == NULL || seconds > slowest.seconds) {
        free(slowest.data);
        slowest.data = xcalloc(size + 1, 1);
        memcpy(slowest.data, data, size);
        slowest.size = size;
        slowest.seconds = seconds;
    }
}

static void read_case(const uint8_t *data, size_t size)
{
    CLEANUP_FREE char *bytes = xcalloc(size + 1, 1);
    const char *options[MOST_OPTIONS];
    int n = 0;
    memcpy(bytes, data, size);
    for (size_t end = strlen(bytes); end < size && n < MOST_OPTIONS; end += strlen(bytes + end)) {
        options[n++] = bytes + ++end;
    }
    evl_error error;
    case_file *file = NULL;
    case_base *base = case_base_parse("fuzz", bytes, model_schema(), &error);
    if (base == NULL || !case_override(base, n, options, &file, &error)) {
        check_refusal(&error);
    } else {
        read_again(file);
    }
    case_delete(&file);
    case_base_delete(&base);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const double began = processor_time();
    read_case(data, size);
    note_time(processor_time() - began, data, size);
    return 0;
}
