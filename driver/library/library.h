/** Shared by the files of the library. */
#pragma once

#include "base/status.h"
#include "files/history_memory.h"
#include "simulate/case_plan.h"

#include <evolvent/evolvent.h>
#include <signal.h>

struct evolvent_case {
    case_plan plan;
};

/** Flag used if `stop` is NULL; never set. */
extern const volatile sig_atomic_t library_never;
/** Name of its source, for messages. */
const char *library_who(int stop);
/** Copy an error to the caller's struct. @return its code */
evolvent_code library_report_error(const evl_error *from, evolvent_error *to);
/** The record of a history, which takes ownership of it; NULL for NULL. */
evolvent_record *library_record(history *history);
