/** Common data of all cases of a batch, created once before the workers. */
#pragma once

#include "batch/batch_axis.h"
#include "batch/batch_checkpoints.h"
#include "batch/batch_statistics.h"
#include "files/stack.h"
#include "files/wheel_store.h"
#include "simulate/case_plan.h"

/** Common data of the histories of all cases. */
typedef struct {
    int n_variables;
    model_output *variables; /**< as in the model of the first valid case */
    batch_axis axis;
    case_plan first; /**< the first valid case; the variables and their dimensions belong to its model */
} batch_histories;

typedef struct {
    memory_arena arena; /**< owns names */
    const design *design;
    case_base *base;
    statistics_table table;
    bool needs_roots;          /**< metrics or histories contain the root stress */
    bool needs_temperatures;   /**< or the flash or contact temperature */
    batch_histories histories; /**< n_variables 0: none */
    stack stack;               /**< open if there are histories */
    batch_checkpoints checkpoints;
    const char *responses;   /**< folder of their files, if cases are responses */
    wheel_store *wheels;     /**< known compliant wheels; each worker has its own copy */
    long first_case, stride; /**< of the shard; rows of the stack */
} batch_plan;

/** Parse the base case, check the paths of the design, lay out the histories. The stack is not opened yet.
 *  @return false with the reason in `error`, EVL_EXIT_CASE; then there is nothing to free */
bool batch_plan_init(batch_plan *plan, const design *design, evl_error *error);
void batch_plan_free(batch_plan *plan);

/** The journal's first line, without its newline, as a new string. */
char *batch_plan_head(const batch_plan *plan, int shard, int n_shards);

/** Plan the case of a row. `of_case` and the result are as in case_plan_make. */
bool batch_plan_case(const batch_plan *plan, long index, case_plan *of_case, evl_error *error);
