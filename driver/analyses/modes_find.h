/** Natural modes of a case. */
#pragma once

#include "analyses/modes_print.h"

#include <signal.h>

/** Options: at most one of the first three; none: the steady state at the start of the case. */
typedef struct {
    const char *at;            /**< time [s] as a text, or NULL */
    const char *mesh_position; /**< steady state, in pitches from the start of contact, as a text, or NULL */
    bool mean;                 /**< the mean over the steady states at all positions of the meshes */
    bool is_shown;             /**< show the progress on stderr */
    const volatile sig_atomic_t *interrupt; /**< ends it when it is not 0 */
    const char *(*who)(int interrupt);      /**< name of the interrupt's source */
} modes_request;

/** Reason why the options cannot be combined; NULL if they can. */
const char *modes_check(const modes_request *request);
/** Values of the texts of a request. */
typedef struct {
    double time, position;
} modes_point;
/** @return false with the reason in `error` */
bool modes_read(const modes_request *request, modes_point *point, evl_error *error);
/** Find the modes. @param[in,out] report  zeros; to be freed by modes_free in any case
 *  @return false with the reason in `error` */
bool modes_find(const case_plan *plan, const modes_request *request, const modes_point *point, modes_report *report,
                evl_error *error);
void modes_free(modes_report *report);
