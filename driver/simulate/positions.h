/** Outputs by position: what a history has of them, and what is to be said of them at the end. */
#pragma once

#include "integrate/integrate_types.h"
#include "simulate/prepare.h"

/** What a history has of the grid, where outputs go by position. */
enum { POSITIONS_PLACE, POSITIONS_KIND, POSITIONS_OUTPUTS };

/** What outputs go by. */
typedef struct {
    const char *per;  /**< "pitch" or "turn"; NULL: they go by time */
    int number;       /**< of them in one */
    const char *what; /**< "mesh" or "wheel" */
    const char *of;   /**< its name */
    int position_of;  /**< as of integrate_options */
} positions_rule;
positions_rule positions_of(const prepared_case *prepared);

/** The outputs of the grid, with texts in a pool. @param before  values before theirs */
void positions_describe(const positions_rule *rule, int before, memory_pool *pool,
                        model_output outputs[POSITIONS_OUTPUTS]);

/** Refuse a wheel that nothing can turn. @return false with the reason in `error` */
bool positions_check_start(const prepared_case *prepared, const dae_state *start, evl_error *error);

/** What happened so far. */
typedef struct {
    positions_rule rule;
    long forwards, backwards; /**< positions on the grid, without the start */
    double first, last;       /**< position at the start, and of the last output */
    bool has_started;
} positions_watch;

/** Keep what happened. */
void positions_keep(positions_watch *watch, archive *archive);
/** Take an output. */
void positions_take(positions_watch *watch, const output_mark *mark);
/** Say how far it came, if that is less than a pitch or turn; else "". */
void positions_remark(const positions_watch *watch, char *text, size_t length);
