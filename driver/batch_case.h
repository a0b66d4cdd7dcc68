/** One case of a batch: from its row in the design to its line in the journal. */
#ifndef EVOLVENT_BATCH_CASE_H
#define EVOLVENT_BATCH_CASE_H

#include "batch_statistics.h"
#include "case.h"
#include "design.h"
#include "journal.h"
#include "prepare.h"
#include "stack.h"

/** What the histories of all cases have in common. */
typedef struct {
    int n_variables;
    model_output *variables; /**< as the model of the first good case has them */
    int n_times;
    double *times;           /**< [s] */
    double duration, output_interval; /**< [s] that a case needs to have such a history */
    int n_wheels, n_meshes;
    char **wheel_names, **mesh_names;
} batch_histories;

/** All that does not depend on the case: made once, before the workers are. */
typedef struct {
    const design *design;
    case_base *base;
    statistics_table table;
    batch_histories histories; /**< n_variables 0: none */
    stack stack;               /**< open if there are histories */
    long first_case, stride;   /**< of the shard, whose rows the stack has */
} batch_plan;

/** Parse the base case, check the paths of the design, lay out the histories. The stack is not opened yet.
 *  @return false with the reason in `error`, EVL_EXIT_CASE; then there is nothing to free */
bool batch_plan_init(batch_plan *plan, const design *design, evl_error *error);
void batch_plan_free(batch_plan *plan);

/** The journal's first line, without its newline, as a new string. */
char *batch_plan_head(const batch_plan *plan, int shard, int n_shards);

/** Make a case from its row. @return false with the reason in `error`; then there is nothing to free */
bool batch_prepare(const batch_plan *plan, long index, prepared_case *prepared, evl_error *error);

typedef struct {
    journal_status status;
    char *line; /**< of the journal, with its newline; to be freed */
    size_t length;
} batch_row;

/** Run a case. What is wrong with it is told in its row.
 *  @return false with the reason in `error` if its history could not be written */
bool batch_case_run(const batch_plan *plan, long index, batch_row *row, evl_error *error);
/** The row of a case that ended the process that ran it. */
void batch_case_lost(const batch_plan *plan, long index, const char *message, batch_row *row);

#endif
