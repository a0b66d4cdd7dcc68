/** Variables and dimensions of netCDF, with values on file or in memory. */
#pragma once

#include <limits.h>
#include <stdbool.h>

enum { NETCDF_MAX_RANK = 5, NETCDF_REASON_LENGTH = 200 };

/** A named dimension; its coordinate variable has the same name. */
typedef struct {
    const char *name;              /**< valid as long as the dimension */
    struct dimension_scale *scale; /**< of an open file, from its arena; NULL: not defined */
    bool grows;                    /**< empty at first */
    unsigned long long length;     /**< largest length; 0 for a growing one without a limit */
} netcdf_dimension;

typedef enum {
    NETCDF_REAL,
    NETCDF_FLOAT, /**< 32 bits, space on file allocated at once */
    NETCDF_INTEGER,
    NETCDF_LONG, /**< 64 bits */
    NETCDF_TEXT
} netcdf_type;

/** Its texts must outlive it. */
typedef struct {
    netcdf_type type;
    const char *name, *units, *symbol, *long_name;
    int rank;
    netcdf_dimension *dimensions[NETCDF_MAX_RANK]; /**< only the first may grow */
    int n_flags;                                   /**< the values 0..n_flags-1 have a meaning; 0: plain numbers */
    const char *flag_meanings;                     /**< n_flags words */
    const char *rates;                             /**< names of the variables whose sum is its rate; NULL: none */
} netcdf_variable;

/** A variable without dimensions so far. */
static inline netcdf_variable netcdf_describe(netcdf_type type, const char *name, const char *units, const char *symbol,
                                              const char *long_name)
{
    return (netcdf_variable){.type = type, .name = name, .units = units, .symbol = symbol, .long_name = long_name};
}

static inline bool netcdf_is_integer(double value)
{
    return value >= INT_MIN && value <= INT_MAX;
}
/** Whether all values of an integer variable are in range.
 *  @param reason  [NETCDF_REASON_LENGTH] why not, unless it already contains a reason */
bool netcdf_are_integers(char *reason, const char *name, int n, const double *values);
