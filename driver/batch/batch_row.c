#include "batch/batch_row.h"

#include "base/json.h"
#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <time.h>

void batch_row_write(const batch_plan *plan, long index, journal_status status, const char *message,
                     const double *results, const float *history, batch_row *row)
{
    static const int exits[] = {
        [JOURNAL_DONE] = EVL_EXIT_OK, [JOURNAL_FAILED] = EVL_EXIT_INTEGRATION, [JOURNAL_REFUSED] = EVL_EXIT_CASE};
    struct timespec now = {0};
    (void)clock_gettime(CLOCK_REALTIME, &now);
    *row = (batch_row){.status = status};
    json_writer writer = {.stream = memory_open(&row->line, &row->length), .is_line = true};
    json_open(&writer, NULL, '{');
    json_integer(&writer, "case", index);
    json_text(&writer, "status", journal_status_name(status));
    json_integer(&writer, "exit", exits[status]);
    if (history != NULL) {
        char check[16];
        (void)snprintf(check, sizeof check, "%08x", (unsigned)stack_check(&plan->stack, history));
        json_text(&writer, "history", check);
    }
    json_text(&writer, "message", message);
    for (int i = 0; i < plan->table.n; i++) {
        json_number(&writer, plan->table.scalars[i].name, results == NULL ? NAN : results[i]);
    }
    json_number(&writer, "at", (double)now.tv_sec + floor(1e-6 * (double)now.tv_nsec) / 1000);
    json_close(&writer, '}');
    memory_close(writer.stream, &row->line);
}
