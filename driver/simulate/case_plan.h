/** Plan of a case: its model, and the options, output grid and outputs of its run, computed once. */
#pragma once

#include "case/case.h"
#include "simulate/metrics.h"
#include "simulate/positions.h"

/** Constant from case_plan_make to case_plan_free. */
typedef struct {
    case_file *file;                /**< NULL: the case could not be read */
    const description *description; /**< of the file */
    const char *path;               /**< of the file */
    model *model;                   /**< NULL: the case is refused */
    /* valid only if case_plan_make succeeded */
    integrate_options integration; /**< of a run */
    positions_rule positions;      /**< of its outputs */
    metric_window window;          /**< of its metrics; the default window if the case has none */
    int n_outputs, n_values;       /**< n_values: of these outputs at a state */
    int *outputs;                  /**< [n_outputs] indices of the variable outputs of a result */
} case_plan;

/** Root stress of wheels with finite elements: only the outputs that the case names, also for analyses, or also all its
 *  outputs. */
typedef enum { PLAN_ROOTS_OF_CASE, PLAN_ROOT_STRESS, PLAN_ROOT_OUTPUTS } plan_roots;

typedef struct {
    const char *name;      /**< path of the case, or name of the text in error messages */
    const char *text;      /**< NULL: that of the file */
    const case_base *base; /**< a text parsed before, instead of both; NULL: none */
    int n_set;
    const char *const *set;        /**< [n_set] options "PATH=VALUE" */
    const evl_wheel_store *wheels; /**< known wheel compliances; NULL: none */
    plan_roots roots;
    bool needs_temperatures; /**< outputs of the flash and contact temperature, although the case does not name them */
} plan_request;

/** Read and check a case, create its model, and compute the rest of its plan.
 *  @param[in,out] plan  zeros, or with a base the result of an earlier call for the same base: becomes the new plan
 *  @return false with the reason in `error`; the members that were found before it remain. Free the plan in any case */
bool case_plan_make(case_plan *plan, const plan_request *request, evl_error *error);
void case_plan_free(case_plan *plan);
/** Add the root stress of wheels with finite elements, on the first request for it. The model computes it once; threads
 *  may share the plan. @return false with the reason in `error` */
bool case_plan_add_root_stress(const case_plan *plan, evl_error *error);

/** Turn a refusal by the model into an error at a location in the case file. @return false */
bool case_plan_refuse(const case_plan *plan, const model_message *refusal, evl_error *error);
/** All warnings: numbers outside the plausible ranges of their keys, with their locations, and warnings of the model and
 *  of a start, preceded by their subject as in a refusal. For a refused case without a model only the former.
 *  @param start  orbit from case_start; NULL: the case was not started
 *  @param arena  owns all that is returned */
const char **case_plan_warning_list(const case_plan *plan, const model_start_orbit *start, memory_arena *arena, int *n);
/** The same in one new string, "" if there are none. */
char *case_plan_warnings(const case_plan *plan, const model_start_orbit *start, const char *separator);
/** Same without those of numbers in the file itself, which are common to all cases of a batch. */
char *case_plan_own_warnings(const case_plan *plan, const model_start_orbit *start, const char *separator);
