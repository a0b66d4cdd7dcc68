/** Quasi-static analysis of a mesh of a case under torques. */
#pragma once

#include "files/history.h"
#include "model/model_static.h"
#include "simulate/case_plan.h"

#include <signal.h>

enum { STATIC_MOST_TORQUES = 1000 };

/** Options, as texts. */
typedef struct {
    const char *mesh;                       /**< name or index; NULL: the first one */
    const char *torque;                     /**< FROM:TO:STEPS or one number; NULL: from the loads */
    const char *speed;                      /**< NULL: no friction */
    const char *points;                     /**< NULL: 200 */
    const volatile sig_atomic_t *interrupt; /**< ends it when it is not 0 */
    const char *(*who)(int interrupt);      /**< name of the interrupt's source */
} static_request;

typedef struct {
    const case_plan *of_case;
    const char *path;           /**< of the result; as in history_layout */
    struct history **in_memory; /**< as in history_layout */
    static_plan plan;
    history *file;
    int n_torques;
    double torques[STATIC_MOST_TORQUES];
    double *values;  /**< [n_values] of the last torque */
    double *numbers; /**< [n_torques][n_outputs] first value of each output, for each torque */
} static_analysis;

/* Each of these returns false with the reason in `error`. */
/** Checks without a case. @param[out] points  per pitch */
bool static_check(const static_request *request, int *points, evl_error *error);
/** Plan the analysis. @param[in,out] analysis  the first three members are set, the others zero; free it in any case */
bool static_plan_case(static_analysis *analysis, const static_request *request, int points, evl_error *error);
/** Run the analysis. A file that was started records how it ended. */
bool static_analyse(static_analysis *analysis, const static_request *request, evl_error *error);
void static_analysis_free(static_analysis *analysis);
