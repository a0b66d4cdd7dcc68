/** Outputs by position: their columns in a history, and the remark at the end of a run. */
#pragma once

#include "case/description.h"
#include "integrate/integrate_types.h"
#include "model/model.h"

/** Outputs of the position grid in a history. */
enum { POSITIONS_VALUE, POSITIONS_KIND, POSITIONS_OUTPUTS };

/** Rule of outputs by position. */
typedef struct {
    const char *per;  /**< "pitch" or "turn"; NULL: outputs by time */
    int number;       /**< outputs per pitch or revolution */
    const char *what; /**< "mesh" or "wheel" */
    const char *of;   /**< its name */
    int position_of;  /**< as in integrate_options */
} positions_rule;
positions_rule positions_of(const description *description, const model *model);

/** The outputs of the grid, with texts in an arena. @param before  number of preceding values */
void positions_describe(const positions_rule *rule, int before, memory_arena *arena,
                        model_output outputs[POSITIONS_OUTPUTS]);

/** Refuse a wheel that nothing can drive. @return false with the reason in `refusal` */
bool positions_check_start(const positions_rule *rule, const model *model, const dae_state *start,
                           model_message *refusal);

/** Counts of the outputs so far. */
typedef struct {
    positions_rule rule;
    long forwards, backwards; /**< grid positions, without the start */
    double first, last;       /**< position at the start, and of the last output */
    bool has_started;
} positions_counts;

/** Serialise the counts. */
void positions_serialize(positions_counts *counts, archive *archive);
/** Count an output. */
void positions_take(positions_counts *counts, const output_mark *mark);
/** Report the distance covered, if less than a pitch or revolution; else "". */
void positions_remark(const positions_counts *counts, char *text, size_t length);
