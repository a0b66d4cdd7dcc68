/** What was computed of a wheel that gives way, on file. The interface knows nothing of HDF5; wheel_file_hdf5.c does. */
#pragma once

#include "base/status.h"

/** All that decides about a wheel, and what was computed. */
typedef struct {
    int n_key, n;
    const double *key;
    double *numbers;
} wheel_numbers;

/** 64 bits of a wheel's key. */
unsigned long long wheel_file_hash(const wheel_numbers *wheel);

/** Bring a wheel to the disk under a name that it does not have yet. The first complete file of a name stays: if there is one
 *  now, or another process was faster, nothing is written. Whatever ends the program, no file of that name is incomplete.
 *  @return false with the reason in `error`, EVL_EXIT_IO */
bool wheel_file_write(const char *path, const wheel_numbers *wheel, evl_error *error);

typedef enum { WHEEL_FILE_READ, WHEEL_FILE_MISSING, WHEEL_FILE_REFUSED } wheel_file_answer;
/** Read the numbers of a wheel. A file that is damaged, or of another wheel, is refused: EVL_EXIT_CASE */
wheel_file_answer wheel_file_read(const char *path, const wheel_numbers *wheel, evl_error *error);
