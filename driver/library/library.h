/** What the files of the library share. */
#pragma once

#include "base/status.h"
#include "files/history_memory.h"
#include "simulate/prepare.h"

#include <evolvent/evolvent.h>
#include <signal.h>

struct evolvent_case {
    prepared_case prepared;
};

/** What a NULL for `stop` stands for. */
extern const volatile sig_atomic_t library_never;
/** Who sets it. */
const char *library_who(int stop);
/** Hand an error over. @return its code */
evolvent_code library_tell(const evl_error *from, evolvent_error *to);
/** What the library hands over of a history, which becomes part of it; NULL of NULL. */
evolvent_record *library_record(history *history);
