/** Range of a parameter: PATH=FROM:TO[:STEPS]. */
#pragma once

#include "base/status.h"
#include "case/case.h"
#include "model/model.h"

enum { RANGE_USUAL_STEPS = 101, RANGE_MOST_STEPS = 100000 };

typedef struct {
    char *path;      /**< as in --set; owned */
    char *unit;      /**< of the key, "" if none; owned */
    int n;           /**< number of values */
    bool is_counted; /**< the number of values was given */
    double from, to; /**< in the key's unit */
} value_range;

/** Read it. @return false with the reason in `error`: EVL_EXIT_USAGE, or EVL_EXIT_CASE for a path that does not exist
 *  in the case */
bool value_range_read(value_range *range, const char *text, const case_base *base, evl_error *error);
/** Whether the path is a parameter of a case, and a real number.
 *  @param is_there  the path must exist in the case; else its absence is no error
 *  @return false with the reason in `error` */
bool value_range_check(const value_range *range, const model *model, bool is_there, evl_error *error);
double value_range_at(const value_range *range, int index);
/** "PATH=VALUE", a new string. */
char *value_range_option(const value_range *range, double value);
void value_range_free(value_range *range);
