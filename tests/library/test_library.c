/* The library in a process that has settings of its own, other threads, little memory, many calls. */
#include <evolvent/evolvent.h>

#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

static const char *const radau[] = {"meshes.0.tracking=closed_form", "simulation.duration=0.1"};
static const char *const ida[] = {"simulation.integrator=ida", "simulation.duration=0.1"};

static evolvent_case *read_case(const char *const set[2])
{
    evolvent_error error;
    evolvent_case *gearbox = evolvent_case_read("examples/paper-friction.yaml", 2, set, &error);
    if (gearbox == NULL) {
        fail_msg("%s: %s", error.place, error.message);
    }
    return gearbox;
}

static evolvent_record *run(const evolvent_case *gearbox)
{
    evolvent_record *record = NULL;
    assert_int_equal(evolvent_run(gearbox, NULL, &record, NULL), EVOLVENT_OK);
    return record;
}

static size_t bytes_of(const evolvent_variable *variable)
{
    size_t n = variable->type == EVOLVENT_REAL ? sizeof(double) : sizeof(int);
    for (int i = 0; i < variable->rank; i++) {
        n *= variable->lengths[i];
    }
    return n;
}

/* Whether two records have the same numbers, to the last bit. */
static int same(const evolvent_record *one, const evolvent_record *other)
{
    int n, m;
    const evolvent_variable *a = evolvent_record_variables(one, &n), *b = evolvent_record_variables(other, &m);
    int is_same = n == m;
    for (int i = 0; i < n && is_same; i++) {
        is_same = strcmp(a[i].name, b[i].name) == 0 &&
                  (a[i].type == EVOLVENT_TEXT ||
                   (bytes_of(&a[i]) == bytes_of(&b[i]) && memcmp(a[i].values, b[i].values, bytes_of(&a[i])) == 0));
    }
    return is_same;
}

/* ---- threads ---- */

enum { N_THREADS = 4, N_RUNS = 3 };

typedef struct {
    const evolvent_case *gearbox;
    const evolvent_record *expected;
    int n_same;
} worker;

static void *work(void *with)
{
    worker *w = with;
    for (int i = 0; i < N_RUNS; i++) {
        evolvent_record *record = NULL;
        if (evolvent_run(w->gearbox, NULL, &record, NULL) == EVOLVENT_OK) {
            w->n_same += same(record, w->expected);
        }
        evolvent_record_free(record);
    }
    return NULL;
}

/* Two of them share a case. */
static void threads_side_by_side_get_the_bits_of_a_run_alone(void **state)
{
    (void)state;
    evolvent_case *gearboxes[2] = {read_case(radau), read_case(ida)};
    evolvent_record *expected[2] = {run(gearboxes[0]), run(gearboxes[1])};
    assert_false(same(expected[0], expected[1]));
    pthread_t threads[N_THREADS];
    worker workers[N_THREADS];
    for (int i = 0; i < N_THREADS; i++) {
        workers[i] = (worker){gearboxes[i % 2], expected[i % 2], 0};
        assert_int_equal(pthread_create(&threads[i], NULL, work, &workers[i]), 0);
    }
    for (int i = 0; i < N_THREADS; i++) {
        assert_int_equal(pthread_join(threads[i], NULL), 0);
        assert_int_equal(workers[i].n_same, N_RUNS);
    }
    for (int i = 0; i < 2; i++) {
        evolvent_record_free(expected[i]);
        evolvent_case_free(gearboxes[i]);
    }
}

static void a_run_leaves_no_warning_of_its_start_in_the_case(void **state)
{
    (void)state;
    static const char *const set[] = {"simulation.initial={kind: periodic}", "simulation.duration=1e-4",
                                      "meshes.0.damping.value=0"}; /* undamped: its orbit is unstable */
    evolvent_case *gearbox = evolvent_case_read("examples/spur-pair.yaml", 3, set, NULL);
    assert_non_null(gearbox);
    char *before = evolvent_show(gearbox, NULL);
    evolvent_record *record = run(gearbox);
    char *after = evolvent_show(gearbox, NULL);
    int n;
    const evolvent_attribute *attributes = evolvent_record_attributes(record, &n);
    bool warns = false;
    for (int i = 0; i < n; i++) {
        warns = warns || (strcmp(attributes[i].name, "warnings") == 0 &&
                          strstr(attributes[i].text, "the periodic orbit is unstable") != NULL);
    }
    assert_true(warns);
    assert_string_equal(after, before);
    evolvent_text_free(before);
    evolvent_text_free(after);
    evolvent_record_free(record);
    evolvent_case_free(gearbox);
}

/* ---- the caller's settings ---- */

static void the_caller_s_rounding_changes_no_bit_and_stays(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        evolvent_case *gearbox = read_case(i == 0 ? radau : ida);
        evolvent_record *expected = run(gearbox);
        assert_int_equal(fesetround(FE_UPWARD), 0);
        evolvent_case *again = read_case(i == 0 ? radau : ida);
        evolvent_record *record = run(again);
        assert_int_equal(fegetround(), FE_UPWARD);
        assert_int_equal(fesetround(FE_TONEAREST), 0);
        assert_true(same(record, expected));
        evolvent_record_free(record);
        evolvent_record_free(expected);
        evolvent_case_free(again);
        evolvent_case_free(gearbox);
    }
}

/* With a decimal comma, where the machine knows a place that has one. */
static void the_caller_s_locale_changes_no_bit_and_stays(void **state)
{
    (void)state;
    static const char *const locales[] = {"de_DE.UTF-8", "de_DE", "fr_FR.UTF-8", "C.UTF-8", "C"};
    evolvent_case *gearbox = read_case(radau);
    evolvent_record *expected = run(gearbox);
    locale_t own = (locale_t)0;
    for (int i = 0; i < 5 && own == (locale_t)0; i++) {
        own = newlocale(LC_ALL_MASK, locales[i], (locale_t)0);
    }
    assert_true(own != (locale_t)0);
    const locale_t before = uselocale(own);
    evolvent_case *again = read_case(radau);
    evolvent_record *record = run(again);
    const bool stays = uselocale((locale_t)0) == own;
    (void)uselocale(before);
    freelocale(own);
    assert_true(stays);
    assert_true(same(record, expected));
    evolvent_record_free(record);
    evolvent_record_free(expected);
    evolvent_case_free(again);
    evolvent_case_free(gearbox);
}

/* ---- records ---- */

static void a_variable_is_found_by_its_name_and_none_of_the_events(void **state)
{
    (void)state;
    evolvent_case *gearbox = read_case(radau);
    evolvent_record *record = run(gearbox);
    int n, n_events = 0;
    const evolvent_variable *all = evolvent_record_variables(record, &n);
    for (int i = 0; i < n; i++) {
        const evolvent_variable *found = evolvent_record_find(record, all[i].name);
        n_events += all[i].is_of_events;
        assert_true(all[i].is_of_events ? found == NULL || !found->is_of_events : found == &all[i]);
    }
    assert_true(n_events > 0);
    assert_null(evolvent_record_find(record, "kind"));
    evolvent_record_free(record);
    evolvent_case_free(gearbox);
}

/* Whether two records have the same layout. */
static int alike(const evolvent_record *one, const evolvent_record *other)
{
    size_t n, m;
    const void *a = evolvent_record_layout(one, &n), *b = evolvent_record_layout(other, &m);
    return n == m && memcmp(a, b, n) == 0;
}

static void records_have_the_layout_of_others_whose_numbers_alone_differ(void **state)
{
    (void)state;
    static const char *const longer[] = {"meshes.0.tracking=closed_form", "simulation.duration=0.2"};
    static const char *const fewer[] = {"simulation.duration=0.1", "simulation.outputs=gap"};
    static const char *const renamed[] = {"simulation.duration=0.1", "meshes.0.name=other"};
    const char *const *const sets[] = {radau, longer, fewer, renamed, ida};
    enum { N = sizeof sets / sizeof *sets, N_ALIKE = 2 };
    evolvent_case *gearboxes[N];
    evolvent_record *records[N];
    for (int i = 0; i < N; i++) {
        gearboxes[i] = read_case(sets[i]);
        records[i] = run(gearboxes[i]);
    }
    for (int i = 0; i < N; i++) {
        for (int k = 0; k < N; k++) {
            assert_int_equal(alike(records[i], records[k]), i == k || (i < N_ALIKE && k < N_ALIKE));
        }
    }
    for (int i = 0; i < N; i++) {
        evolvent_record_free(records[i]);
        evolvent_case_free(gearboxes[i]);
    }
}

/* ---- stopped ---- */

static void a_run_that_is_stopped_gives_what_there_is(void **state)
{
    (void)state;
    volatile const int stop = 1;
    evolvent_case *gearbox = read_case(radau);
    evolvent_record *record = NULL;
    evolvent_error error;
    assert_int_equal(evolvent_run(gearbox, &stop, &record, &error), EVOLVENT_INTERRUPTED);
    assert_string_equal(error.message, "interrupted by the caller");
    assert_non_null(record);
    const evolvent_variable *time = evolvent_record_find(record, "time");
    assert_in_range(time->lengths[0], 1, 3);
    int n;
    const evolvent_attribute *attributes = evolvent_record_attributes(record, &n);
    int i = 0;
    while (i < n && strcmp(attributes[i].name, "status") != 0) {
        i++;
    }
    assert_true(i < n);
    assert_string_equal(attributes[i].text, "interrupted");
    evolvent_record_free(record);
    record = NULL;
    assert_int_equal(evolvent_static(gearbox, NULL, &stop, &record, &error), EVOLVENT_CASE); /* no real gears */
    assert_null(record);
    assert_null(evolvent_modes(gearbox, &(evolvent_modes_request){.at = "0.05"}, &stop, &error));
    assert_int_equal(error.code, EVOLVENT_INTERRUPTED);
    evolvent_case_free(gearbox);
}

static evolvent_code respond(const char *over, const char *direction, const volatile int *stop,
                             evolvent_record **record, evolvent_error *error)
{
    const evolvent_respond_request request = {over, direction, "100"};
    return evolvent_respond("examples/spur-pair.yaml", NULL, 0, NULL, &request, stop, record, error);
}

static void a_response_is_done_stopped_or_refused_and_leaves_nothing(void **state)
{
    (void)state;
    static const char over[] = "wheels.pinion.loads.0.value=-40:-50:2";
    volatile const int stop = 1;
    evolvent_record *record = NULL;
    evolvent_error error;
    assert_int_equal(respond(over, NULL, &stop, &record, &error), EVOLVENT_INTERRUPTED);
    assert_string_equal(error.message, "interrupted by the caller; 0 of 4 values are done");
    assert_non_null(record);
    const evolvent_variable *period = evolvent_record_find(record, "period");
    assert_int_equal(((const int *)period->values)[0], -1);
    evolvent_record_free(record);
    assert_int_equal(respond(over, "up", NULL, &record, &error), EVOLVENT_OK);
    period = evolvent_record_find(record, "period");
    assert_int_equal(period->lengths[0] * period->lengths[1], 2);
    assert_int_equal(((const int *)period->values)[0], 1);
    evolvent_record_free(record);
    assert_int_equal(respond("wheels.pinion.teeth=20:21", NULL, NULL, &record, &error), EVOLVENT_USAGE);
    assert_null(record);
    assert_int_equal(evolvent_respond("examples/spur-pair.yaml", NULL, 0, NULL, NULL, NULL, &record, &error),
                     EVOLVENT_USAGE);
    assert_string_equal(error.place, "over");
    assert_null(record);
}

/* ---- memory ---- */

#if defined(__linux__) && !defined(__SANITIZE_ADDRESS__)

typedef struct {
    long all, resident;
} pages;

/* Of this process. */
static pages read_pages(void)
{
    char line[128] = "", *rest = NULL;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file != NULL) {
        (void)fgets(line, sizeof line, file);
        (void)fclose(file);
    }
    assert_string_not_equal(line, "");
    const long all = strtol(line, &rest, 10);
    return (pages){all, strtol(rest, NULL, 10)};
}

static void limit_memory(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_AS, &limit), 0);
    limit.rlim_cur = bytes == 0 ? limit.rlim_max : bytes;
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
}

static void a_call_without_memory_ends_with_an_error_and_the_next_one_works(void **state)
{
    (void)state;
    static const rlim_t MEBIBYTE = 1024 * 1024;
    static const char *const many[] = {"meshes.0.tracking=closed_form",
                                       "simulation={duration: 20, output_interval: 1e-5}"}; /* 2 GB of rows */
    evolvent_case *gearbox = read_case(radau), *large = read_case(many);
    evolvent_record *expected = run(gearbox), *record = NULL;
    evolvent_error error;
    int n_refused = 0;
    /* as much as is there, and a little more each time: it ends at many places */
    for (rlim_t more = 0; more < 48; more += 3) {
        limit_memory((rlim_t)read_pages().all * (rlim_t)sysconf(_SC_PAGESIZE) + more * MEBIBYTE);
        const evolvent_code code = evolvent_run(large, NULL, &record, &error);
        evolvent_case *other = evolvent_case_read("examples/compliant-pair.yaml", 0, NULL, NULL);
        limit_memory(0);
        n_refused += code == EVOLVENT_MEMORY;
        assert_int_equal(code, EVOLVENT_MEMORY);
        assert_non_null(strstr(error.message, "out of memory: "));
        assert_null(strstr(error.message, " x 0 bytes"));
        assert_null(record);
        evolvent_case_free(other);
    }
    assert_int_equal(n_refused, 16);
    record = run(gearbox);
    assert_true(same(record, expected));
    evolvent_record_free(record);
    evolvent_record_free(expected);
    evolvent_case_free(large);
    evolvent_case_free(gearbox);
}

/* Whatever one call kept would be kept as often. */
static void many_calls_take_no_more_memory_than_a_few(void **state)
{
    (void)state;
    enum { WARM = 200, MANY = 2000, MOST_PAGES = 100 };
    static const char *const set[] = {"simulation.duration=0.002", "simulation.output_interval=0.001"};
    static const char *const bad[] = {"simulation.duration=0.002", "wheels.gear.teeth=-1"};
    long before = 0;
    for (int i = 0; i < WARM + MANY; i++) {
        if (i == WARM) {
            before = read_pages().resident;
        }
        evolvent_case *gearbox = read_case(set);
        evolvent_record_free(run(gearbox));
        evolvent_text_free(evolvent_show(gearbox, NULL));
        evolvent_text_free(evolvent_datasheet(gearbox, NULL, i % 2, NULL));
        evolvent_case_free(gearbox);
        assert_null(evolvent_case_read("examples/paper-friction.yaml", 2, bad, NULL));
    }
    assert_true(read_pages().resident - before < MOST_PAGES);
}

#define MEMORY_TESTS                                                                                                   \
    cmocka_unit_test(many_calls_take_no_more_memory_than_a_few),                                                       \
        cmocka_unit_test(a_call_without_memory_ends_with_an_error_and_the_next_one_works),
#else
#define MEMORY_TESTS /* a sanitizer has an allocator of its own */
#endif

int main(void)
{
    const struct CMUnitTest tests[] = {MEMORY_TESTS cmocka_unit_test(threads_side_by_side_get_the_bits_of_a_run_alone),
                                       cmocka_unit_test(a_run_leaves_no_warning_of_its_start_in_the_case),
                                       cmocka_unit_test(the_caller_s_rounding_changes_no_bit_and_stays),
                                       cmocka_unit_test(the_caller_s_locale_changes_no_bit_and_stays),
                                       cmocka_unit_test(a_variable_is_found_by_its_name_and_none_of_the_events),
                                       cmocka_unit_test(records_have_the_layout_of_others_whose_numbers_alone_differ),
                                       cmocka_unit_test(a_run_that_is_stopped_gives_what_there_is),
                                       cmocka_unit_test(a_response_is_done_stopped_or_refused_and_leaves_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
