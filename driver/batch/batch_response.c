#include "batch/batch_response.h"

#include "analyses/versions.h"
#include "base/memory.h"
#include "base/write_bytes.h"
#include "batch/response_table.h"
#include "files/parts.h"
#include "respond/respond.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

bool batch_response_folder(const batch_plan *plan, evl_error *error)
{
    return plan->design->respond_over[0] == '\0' || mkdir(plan->responses, 0777) == 0 || errno == EEXIST ||
           evl_error_set_unwritten(error, plan->responses);
}

static int compare(const void *a, const void *b)
{
    const long *x = a, *y = b;
    return (*x > *y) - (*x < *y);
}

/** Case of a checkpoint folder; -1: not one. */
static long case_of(const char *name)
{
    static const char begin[] = "case-", end[] = ".h5.parts";
    char *rest = NULL;
    if (strncmp(name, begin, sizeof begin - 1) != 0 || name[sizeof begin - 1] < '0' || name[sizeof begin - 1] > '9') {
        return -1;
    }
    errno = 0;
    const long index = strtol(name + sizeof begin - 1, &rest, 10);
    return errno == 0 && strcmp(rest, end) == 0 ? index : -1;
}

void batch_response_retain(const batch_plan *plan, long n, const long *todo)
{
    DIR *folder = plan->design->respond_over[0] == '\0' ? NULL : opendir(plan->responses);
    for (const struct dirent *entry = folder == NULL ? NULL : readdir(folder); entry != NULL; entry = readdir(folder)) {
        const long index = case_of(entry->d_name);
        const bool is_ours = index >= 0 && index % plan->stride == plan->first_case;
        if (is_ours && bsearch(&index, todo, (size_t)n, sizeof *todo, compare) == NULL) {
            CLEANUP_FREE char *path = xasprintf("%s/%s", plan->responses, entry->d_name);
            parts_remove(&(parts){.folder = path});
        }
    }
    (void)(folder != NULL && closedir(folder));
}

/* ---- a case ---- */

typedef struct {
    const batch_plan *plan;
    double *results; /**< [n scalars] */
    char *warnings;
    bool has_other_sizes;
} listener;

static double larger(double a, double b)
{
    return isnan(a) || b > a ? b : a;
}

static void hear_point(const listener *listener, const response_point *point)
{
    const statistics_table *table = &listener->plan->table;
    double *own = listener->results + table->n - N_RESPONSE_SCALARS;
    own[RESPONSE_LONGEST_PERIOD] = larger(own[RESPONSE_LONGEST_PERIOD], point->period);
    own[RESPONSE_NOT_PERIODIC] += point->period == 0;
    own[RESPONSE_STILL_SETTLING] += point->period == RESPONSE_SETTLING;
    for (int i = 0; i < table->n_metrics && !listener->has_other_sizes; i++) {
        double *result = &listener->results[table->metrics[i].scalar];
        *result = larger(*result, point->values[table->metrics[i].index]);
    }
}

static void hear_jumps(double *own, const response *response)
{
    for (int i = response->n_jumps - 1; i >= 0; i--) {
        const response_jump *jump = &response->jumps[i];
        own[jump->direction == 0 ? RESPONSE_JUMPS_UP : RESPONSE_JUMPS_DOWN]++;
        own[jump->direction == 0 ? RESPONSE_JUMP_UP_AT : RESPONSE_JUMP_DOWN_AT] = jump->after;
    }
}

static char *warnings_of(const response *response)
{
    char *text = NULL;
    for (int i = 0; i < response->n_attributes && text == NULL; i++) {
        text = strcmp(response->attributes[i].key, "warnings") == 0 ? xstrdup(response->attributes[i].text) : NULL;
    }
    for (char *c = text; c != NULL && *c != '\0'; c++) {
        *c = (char)(*c == '\n' ? ';' : *c);
    }
    return text;
}

static void hear(void *self, const response *response)
{
    listener *listener = self;
    const statistics_table *table = &listener->plan->table;
    const model_names *names = response->names;
    double *own = listener->results + table->n - N_RESPONSE_SCALARS;
    listener->has_other_sizes =
        table->n_metrics > 0 && (names->meshes.n != table->names.meshes.n || names->wheels.n != table->names.wheels.n ||
                                 names->accelerometers.n != table->names.accelerometers.n);
    own[RESPONSE_JUMPS_UP] = own[RESPONSE_JUMPS_DOWN] = own[RESPONSE_LONGEST_PERIOD] = own[RESPONSE_NOT_PERIODIC] =
        own[RESPONSE_STILL_SETTLING] = 0;
    hear_jumps(own, response);
    for (int d = 0; d < RESPONSE_DIRECTIONS; d++) {
        for (int i = 0; i < response->n && response->points[d] != NULL; i++) {
            hear_point(listener, &response->points[d][i]);
        }
    }
    listener->warnings = warnings_of(response);
}

/** Options of a case; its settings are in the arena. */
static respond_options options_of(const batch_plan *plan, long index, memory_arena *arena)
{
    const design *design = plan->design;
    const char **set = arena_calloc(arena, (size_t)design->n_columns, sizeof *set);
    for (int i = 0; i < design->n_columns; i++) {
        set[i] = design_option(design, i, index, arena);
    }
    return (respond_options){.over = design->respond_over,
                             .text = design->base_case,
                             .up = strcmp(design->respond_direction, "down") != 0,
                             .down = strcmp(design->respond_direction, "up") != 0,
                             .most = (int)design->respond_periods,
                             .n_set = design->n_columns,
                             .set = set,
                             .quiet = true,
                             .wheels = plan->wheels};
}

bool batch_response_check(const batch_plan *plan, long index, evl_error *refusal)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    const respond_options options = options_of(plan, index, &arena);
    const char *name = arena_printf(&arena, "%s: base case", plan->design->file);
    refusal->code = EVL_EXIT_OK;
    return respond_check(name, &options, refusal) == EVL_EXIT_OK;
}

static const char *by_the_batch(int stop)
{
    (void)stop;
    return "the end of the batch";
}

/** @return false if it ends the batch: then `error` is not an error of the case */
static bool write_row(const batch_plan *plan, long index, const listener *listener, evl_exit code, batch_row *row,
                      evl_error *error)
{
    CLEANUP_FREE char *message = evl_error_text(error);
    if (code == EVL_EXIT_OK && listener->has_other_sizes) {
        batch_row_write(plan, index, JOURNAL_REFUSED,
                        "differs from the base case in the number of meshes, wheels or accelerometers; with `metrics` "
                        "all cases need the same",
                        NULL, NULL, row);
    } else if (code == EVL_EXIT_OK) {
        batch_row_write(plan, index, JOURNAL_DONE, listener->warnings, listener->results, NULL, row);
    } else if (code == EVL_EXIT_INTEGRATION) {
        batch_row_write(plan, index, JOURNAL_FAILED, message, NULL, NULL, row);
    }
    return code == EVL_EXIT_OK || code == EVL_EXIT_INTEGRATION || code == EVL_EXIT_INTERRUPTED;
}

bool batch_response_run(const batch_plan *plan, const batch_queue *queue, long index, batch_row *row, evl_error *error)
{
    static const double second = CLOCKS_PER_SEC;
    ARENA_SCOPE memory_arena arena = {NULL};
    const int n = plan->table.n;
    CLEANUP_FREE char *versions = result_versions();
    listener listener = {.plan = plan, .results = arena_calloc(&arena, (size_t)n, sizeof(double))};
    for (int i = 0; i < n; i++) {
        listener.results[i] = NAN;
    }
    respond_options options = options_of(plan, index, &arena);
    options.path = arena_printf(&arena, "%s/case-%ld.h5", plan->responses, index);
    options.versions = versions;
    options.interrupt = batch_queue_stop_word(queue);
    options.who = by_the_batch;
    options.self = &listener;
    options.on_response = hear;
    const clock_t begun = clock();
    const char *name = arena_printf(&arena, "%s: base case", plan->design->file);
    const evl_exit code = respond(name, &options, error);
    listener.results[n - N_RESPONSE_SCALARS + RESPONSE_CPU_TIME] = (double)(clock() - begun) / second;
    const bool good = write_row(plan, index, &listener, code, row, error);
    free(listener.warnings);
    return good;
}
