/** Motions over a parameter that goes up and down: the result of `evolvent respond`, on file in the program (response_hdf5.c), in memory
 *  in the library (response_memory.c). Who links chooses; what is in it is told by response_rows.c to both. */
#pragma once

#include "base/status.h"
#include "files/history.h"

enum { RESPONSE_DIRECTIONS = 2, RESPONSE_SETTLING = -2 };

/** Where a motion jumps to another one. */
typedef struct {
    int direction;        /**< 0 up, 1 down */
    double before, after; /**< values of the parameter just before and just behind it */
    int period_before, period_after;
    double *deviation_before, *deviation_after; /**< [n_meshes] standard deviations of the transmission errors */
} response_jump;

/** At one value. */
typedef struct {
    int period;  /**< common periods after which the motion repeats; 0: it does not; -1: it was not looked at;
                      RESPONSE_SETTLING: it still settles */
    int periods; /**< common periods that it was followed */
    int pitches; /**< of the first mesh in a common period */
    double distance;
    double time;          /**< of one orbit [s], if it was looked at in this run */
    double common_time;   /**< of a common period [s] */
    double time_constant; /**< of the slowest damped mode [s]; NAN: not known */
    double *values;       /**< [n_values] numbers; NULL: not looked at */
} response_point;

typedef struct {
    const char *path; /**< final name */
    const char *parameter, *units;
    int n; /**< values */
    const double *values;
    const model_names *names;
    int n_harmonics, n_outputs, n_values;
    const model_output *outputs;                       /**< numbers of a point, where they stand */
    const response_point *points[RESPONSE_DIRECTIONS]; /**< [n] each; NULL: not this direction */
    int n_jumps;
    const response_jump *jumps;
    int n_attributes;
    const history_attribute *attributes; /**< of the root */
    struct history **kept;               /**< in memory: where it is then; a file has no need of it */
} response;

/** Write it as NAME.partial; if `commit`, it becomes NAME. @return false with the reason in `error`, EVL_EXIT_IO */
bool response_write(const response *response, bool commit, evl_error *error);
