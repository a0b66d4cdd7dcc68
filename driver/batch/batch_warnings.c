#include "batch/batch_warnings.h"

#include "base/log.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

static double magnitude(const design_column *column, long index)
{
    const design_value value = column->values[index];
    return column->type == DESIGN_TEXT ? 0 : fabs(column->type == DESIGN_REAL ? value.real : (double)value.integer);
}

/** Cases with the largest and the smallest nonzero magnitude of a column; the first case for texts. */
static void find_ends(const design *design, const design_column *column, long ends[2])
{
    ends[0] = ends[1] = 0;
    for (long i = 1; i < design->n_cases; i++) {
        const double size = magnitude(column, i), smallest = magnitude(column, ends[1]);
        ends[0] = size > magnitude(column, ends[0]) ? i : ends[0];
        ends[1] = size > 0 && (smallest <= 0 || size < smallest) ? i : ends[1];
    }
}

/** Warn of the value of a column in a case, if it is implausible. */
static bool warn_of_value(const batch_plan *plan, int column, long index)
{
    const design *design = plan->design;
    ARENA_SCOPE memory_arena arena = {NULL};
    const char **options = arena_calloc(&arena, (size_t)design->n_columns, sizeof *options);
    for (int i = 0; i < design->n_columns; i++) {
        options[i] = design_option(design, i, index, &arena);
    }
    case_file *file = NULL;
    evl_error ignored;
    bool is_warned = false;
    if (case_override(plan->base, design->n_columns, options, &file, &ignored)) {
        int n = 0;
        const case_warning *warnings = case_warnings(file, &arena, &n);
        for (int i = 0; i < n && !is_warned; i++) {
            is_warned = warnings[i].option != NULL && strcmp(warnings[i].option, options[column]) == 0;
            if (is_warned) {
                log_warning("case %ld: %s", index, warnings[i].text);
            }
        }
    }
    case_delete(&file);
    return is_warned;
}

void batch_warn(const batch_plan *plan)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    case_file *base = NULL;
    evl_error ignored;
    int n = 0;
    if (case_override(plan->base, 0, NULL, &base, &ignored)) {
        const case_warning *warnings = case_warnings(base, &arena, &n);
        for (int i = 0; i < n; i++) {
            log_warning("%s", warnings[i].text);
        }
    }
    case_delete(&base);
    for (int i = 0; i < plan->design->n_columns && plan->design->n_cases > 0; i++) {
        long ends[2];
        find_ends(plan->design, &plan->design->columns[i], ends);
        (void)(warn_of_value(plan, i, ends[0]) || warn_of_value(plan, i, ends[1]));
    }
}
