#include "batch/batch_check.h"

#include "base/interrupt.h"
#include "base/json.h"
#include "base/memory.h"
#include "batch/batch_case.h"

#include <math.h>
#include <stdio.h>

/** Results so far. */
typedef struct {
    long checked, refused;
    double shortest; /**< duration of the cases that would run [s], NaN if there are none */
} findings;

static void write_refusal(long index, const evl_error *refusal)
{
    CLEANUP_FREE char *text = evl_error_text(refusal);
    json_writer writer = {.stream = stdout, .is_line = true};
    json_open(&writer, NULL, '{');
    json_integer(&writer, "case", index);
    json_text(&writer, "message", text);
    json_close(&writer, '}');
}

static void write_findings(const findings *found)
{
    json_writer writer = {.stream = stdout, .is_line = true};
    json_open(&writer, NULL, '{');
    json_integer(&writer, "checked", found->checked);
    json_integer(&writer, "refused", found->refused);
    json_number(&writer, "shortest", found->shortest);
    json_close(&writer, '}');
}

bool batch_check(const batch_plan *plan, evl_error *error)
{
    findings found = {.shortest = NAN};
    case_plan of_case = {0};
    for (long i = plan->first_case; i < plan->design->n_cases && interrupt_signal == 0; i += plan->stride) {
        evl_error refusal;
        found.checked++;
        if (batch_case_check(plan, i, &of_case, &refusal)) {
            if (of_case.file != NULL) { /* a response has no duration */
                found.shortest = fmin(found.shortest, of_case.integration.t_end);
            }
        } else {
            found.refused++;
            write_refusal(i, &refusal);
        }
    }
    case_plan_free(&of_case);
    if (interrupt_signal != 0) {
        return evl_error_set(error, EVL_EXIT_INTERRUPTED, plan->design->file, "interrupted by %s",
                             interrupt_name((int)interrupt_signal));
    }
    write_findings(&found);
    return found.refused > 0;
}
