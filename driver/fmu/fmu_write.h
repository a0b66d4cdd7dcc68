/** The writing of an FMU: a zip archive of its description, its binary with what that needs, and the case. */
#pragma once

#include "fmu/fmu.h"

/** What the description tells of a motion: all outputs that the case chooses and all parameters, and some of the inputs. */
typedef struct {
    const motion *motion;
    const char *name; /**< of the model */
    bool *is_chosen;  /**< [n_inputs] */
} fmu_plan;

/** Choose inputs by options "wheel:NAME:torque" or "wheel:NAME:speed". @return false with the reason in `error`, EVL_EXIT_USAGE */
bool fmu_choose_inputs(const fmu_plan *plan, int n, const char *const *options, evl_error *error);
/** The text of modelDescription.xml, a new string. */
char *fmu_description(const fmu_plan *plan);

/** A file of the archive, with the path of what it is made of: NULL if it is `text`. */
typedef struct {
    char *name, *path;
    const char *text;
} fmu_file;
/** The binary and the libraries beside it that are no part of every system, with their names in the archive. @return how many, 0 with
 *  the reason in `error` */
int fmu_binary(memory_pool *pool, fmu_file **files, evl_error *error);
/** Write files into an archive; it gets its name when it is whole. @return false with the reason in `error` */
bool fmu_archive(const char *path, int n, const fmu_file *files, evl_error *error);
