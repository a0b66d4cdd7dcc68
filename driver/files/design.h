/** A design: a base case and a table, case by parameter, of the --set values that define the cases of a sweep.
 *  docs/guides/batch.md describes the file. The interface is independent of HDF5; design_hdf5.c uses it. */
#pragma once

#include "base/memory.h"
#include "base/status.h"

typedef enum { DESIGN_REAL, DESIGN_INTEGER, DESIGN_TEXT } design_type;

/** All of the same size, as in a table on file. */
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
    memory_arena arena; /**< owns all except texts in columns */
    char *file;
    char *hash;              /**< hash that identifies its results, of everything that affects them */
    char *base_case;         /**< YAML */
    double window[2];        /**< [s] of the statistics, from and to; NaN: half of each case's duration, its end */
    char *metrics;           /**< requested metrics over whole periods, separated by blanks; "" if none */
    char *history_variables; /**< names, separated by blanks; "" if no histories are requested */
    long history_every;      /**< one of this number of outputs is stored */
    long history_rows;       /**< number of outputs by position that are stored; 0: not specified */
    char *respond_over;      /**< "PATH=FROM:TO[:STEPS]": each case is a response; "": each is a run */
    char *respond_direction; /**< "up", "down" or "both" */
    long respond_periods;    /**< at a value; 0: the default */
    long n_cases;
    int n_columns; /**< with a path */
    design_column *columns;
} design;

/** Read a whole design. @return NULL with the reason in `error`, EVL_EXIT_CASE */
design *design_read(const char *path, evl_error *error);
void design_delete(design **design);

/** The --set option of a column for a case, "PATH=VALUE", in an arena; numbers read back exactly. */
char *design_option(const design *design, int column, long index, memory_arena *arena);
