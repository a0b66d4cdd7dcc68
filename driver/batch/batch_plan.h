/** What all cases of a batch share: made once, before the workers are. */
#pragma once

#include "batch/batch_axis.h"
#include "batch/batch_checkpoints.h"
#include "batch/batch_statistics.h"
#include "case/case.h"
#include "files/stack.h"
#include "files/wheel_store.h"
#include "simulate/prepare.h"

/** What the histories of all cases have in common. */
typedef struct {
    int n_variables;
    model_output *variables; /**< as the model of the first good case has them */
    batch_axis axis;
    prepared_case first; /**< the first good case; the variables and their dimensions are those of its model */
} batch_histories;

typedef struct {
    memory_pool pool; /**< of names */
    const design *design;
    case_base *base;
    statistics_table table;
    batch_histories histories; /**< n_variables 0: none */
    stack stack;               /**< open if there are histories */
    batch_checkpoints checkpoints;
    const char *responses;   /**< folder of their files, if cases are responses */
    wheel_store *wheels;     /**< that give way and are known; each worker has its own copy */
    long first_case, stride; /**< of the shard, whose rows the stack has */
} batch_plan;

/** Parse the base case, check the paths of the design, lay out the histories. The stack is not opened yet.
 *  @return false with the reason in `error`, EVL_EXIT_CASE; then there is nothing to free */
bool batch_plan_init(batch_plan *plan, const design *design, evl_error *error);
void batch_plan_free(batch_plan *plan);

/** The journal's first line, without its newline, as a new string. */
char *batch_plan_head(const batch_plan *plan, int shard, int n_shards);

/** Make a case from its row. `prepared` and the result are those of prepare_edited. */
bool batch_prepare(const batch_plan *plan, long index, prepared_case *prepared, evl_error *error);
