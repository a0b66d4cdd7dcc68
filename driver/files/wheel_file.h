/** Computed compliance of a wheel on file. The interface is independent of HDF5; wheel_file_hdf5.c uses it. */
#pragma once

#include "base/status.h"

/** All inputs of the compliance of a wheel, and the results. */
typedef struct {
    int n_key, n;
    const double *key;
    double *numbers;
} wheel_numbers;

/** 64-bit hash of a wheel's key. */
unsigned long long wheel_file_hash(const wheel_numbers *wheel);

/** Write a wheel to the disk under a new name. The first complete file of a name remains: if there is one now, or
 *  another process was faster, nothing is written. No file of that name is incomplete, however the program ends.
 *  @return false with the reason in `error`, EVL_EXIT_IO */
bool wheel_file_write(const char *path, const wheel_numbers *wheel, evl_error *error);

typedef enum { WHEEL_FILE_READ, WHEEL_FILE_MISSING, WHEEL_FILE_REFUSED } wheel_file_status;
/** Read the numbers of a wheel. A damaged file, or one of another wheel, is refused: EVL_EXIT_CASE */
wheel_file_status wheel_file_read(const char *path, const wheel_numbers *wheel, evl_error *error);
