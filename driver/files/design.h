/** A design: a base case and a table, case by parameter, of the --set values that make the cases of a sweep.
 *  docs/batch.md describes the file. The interface knows nothing of HDF5; design_hdf5.c does. */
#pragma once

#include "base/memory.h"
#include "base/status.h"

typedef enum { DESIGN_REAL, DESIGN_INTEGER, DESIGN_TEXT } design_type;

/** All of one size, as a file has them side by side. */
typedef union {
    double real;
    long long integer;
    char *text;
} design_value;

/** One parameter: a column of the table. */
typedef struct {
    char *path; /**< as in --set */
    design_type type;
    design_value *values; /**< [n_cases] */
} design_column;

typedef struct {
    memory_pool pool; /**< of all but texts in columns */
    char *file;
    char *hash;              /**< identity of its results, of all that decides them */
    char *base_case;         /**< YAML */
    double window[2];        /**< [s] of the statistics, from and to; NaN: half of each case's duration, its end */
    char *numbers;           /**< over whole periods that are wanted, separated by blanks; "" if none are */
    char *history_variables; /**< names, separated by blanks; "" if no histories are wanted */
    long history_every;      /**< of the outputs one is kept */
    long history_rows;       /**< how many are kept of outputs by position; 0: not said */
    char *respond_over;      /**< "PATH=FROM:TO[:STEPS]": each case is a response; "": each is a run */
    char *respond_direction; /**< "up", "down" or "both" */
    long respond_periods;    /**< at a value; 0: the usual number */
    long n_cases;
    int n_columns; /**< those with a path */
    design_column *columns;
} design;

/** Read a whole design. @return NULL with the reason in `error`, EVL_EXIT_CASE */
design *design_read(const char *path, evl_error *error);
void design_delete(design **design);

/** The --set option of a column for a case, "PATH=VALUE", in a pool; numbers so that they read back exactly. */
char *design_option(const design *design, int column, long index, memory_pool *pool);
