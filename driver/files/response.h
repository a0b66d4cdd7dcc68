/** Motions over a parameter that increases and decreases: the result of `evolvent respond`, on file in the program
 *  (response_hdf5.c), in memory in the library (response_memory.c), as linked. response_rows.c passes the content to
 *  both. */
#pragma once

#include "base/status.h"
#include "files/history.h"

enum { RESPONSE_DIRECTIONS = 2, RESPONSE_SETTLING = -2 };

/** A jump from one motion to another. */
typedef struct {
    int direction;        /**< 0 up, 1 down */
    double before, after; /**< values of the parameter just before and just after it */
    int period_before, period_after;
    double *deviation_before, *deviation_after; /**< [n_meshes] standard deviations of the transmission errors */
} response_jump;

/** Result at one value. */
typedef struct {
    int period;  /**< common periods after which the motion repeats; 0: it does not; -1: not computed;
                  *   RESPONSE_SETTLING: not yet settled */
    int periods; /**< number of common periods that it was followed */
    int pitches; /**< of the first mesh in a common period */
    double distance;
    double time;          /**< of one orbit [s], if computed in this run */
    double common_time;   /**< of a common period [s] */
    double time_constant; /**< of the slowest damped mode [s]; NAN: unknown */
    double *values;       /**< [n_values] metrics; NULL: not computed */
} response_point;

typedef struct {
    const char *path; /**< final name */
    const char *parameter, *units;
    int n; /**< number of values */
    const double *values;
    const model_names *names;
    int n_harmonics, n_outputs, n_values;
    const model_output *outputs;                       /**< metrics of a point, with their offsets */
    const response_point *points[RESPONSE_DIRECTIONS]; /**< [n] each; NULL: direction not requested */
    int n_jumps;
    const response_jump *jumps;
    int n_attributes;
    const history_attribute *attributes; /**< of the root */
    struct history **in_memory;          /**< in memory: receives the result; not used for a file */
} response;

/** Write it as NAME.partial; if `commit`, rename it to NAME. @return false with the reason in `error`, EVL_EXIT_IO */
bool response_write(const response *response, bool commit, evl_error *error);
