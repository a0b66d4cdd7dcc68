/** A mesh of a case at rest, under torques. */
#pragma once

#include "files/history.h"
#include "model/model_static.h"
#include "simulate/prepare.h"

#include <signal.h>

enum { STATIC_MOST_TORQUES = 1000 };

/** What is asked for, as texts. */
typedef struct {
    const char *mesh;                       /**< name or index; NULL: the first one */
    const char *torque;                     /**< FROM:TO:STEPS or one number; NULL: what the loads give */
    const char *speed;                      /**< NULL: no friction */
    const char *points;                     /**< NULL: 200 */
    const volatile sig_atomic_t *interrupt; /**< ends it when it is not 0 */
    const char *(*who)(int interrupt);      /**< by whom */
} static_request;

typedef struct {
    const prepared_case *prepared;
    const char *path;      /**< where it goes; as of history_layout */
    struct history **kept; /**< the same */
    static_plan plan;
    history *file;
    int n_torques;
    double torques[STATIC_MOST_TORQUES];
    double *values;  /**< [n_values] of the last torque */
    double *numbers; /**< [n_torques][n_outputs] the first of each output, of each torque */
    bool is_bare;    /**< tooth pairs carry without a contact pressure at some torque */
} static_analysis;

/* Each of these returns false with the reason in `error`. */
/** What can be refused without a case. @param[out] points  a pitch */
bool static_check(const static_request *request, int *points, evl_error *error);
/** What is to be done. @param[in,out] analysis  the first three are set, the others zeros; in any case it is to be freed */
bool static_plan_case(static_analysis *analysis, const static_request *request, int points, evl_error *error);
/** Do it. A file that was begun says how it ended. */
bool static_analyse(static_analysis *analysis, const static_request *request, evl_error *error);
void static_analysis_free(static_analysis *analysis);
