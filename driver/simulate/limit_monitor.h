/** Monitor of friction laws that hold an argument at a limit, for one warning per run. Checked at the ends of all steps
 *  until the first such state. */
#pragma once

#include "base/archive.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

typedef struct {
    const model *model; /**< NULL: no such law, or a limit was already found */
    double *y;          /**< of one state */
    char text[DAE_MESSAGE_LENGTH];
} limit_monitor;

void limit_monitor_init(limit_monitor *monitor, const model *model);
void limit_monitor_serialize(limit_monitor *monitor, archive *archive);
void limit_monitor_step(limit_monitor *monitor, const integrate_step *step);
void limit_monitor_free(limit_monitor *monitor);
