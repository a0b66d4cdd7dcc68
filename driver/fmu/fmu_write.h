/** Writer of an FMU: a zip archive of its description, its binary with dependencies, and the case. */
#pragma once

#include "fmu/fmu.h"

/** Content of the description: all outputs selected by the case, all parameters, and selected inputs. */
typedef struct {
    const motion *motion;
    const char *name; /**< of the model */
    bool *is_chosen;  /**< [n_inputs] */
} fmu_plan;

/** Select inputs by options "wheel:NAME:torque" or "wheel:NAME:speed". @return false with the reason in `error`,
 *  EVL_EXIT_USAGE */
bool fmu_choose_inputs(const fmu_plan *plan, int n, const char *const *options, evl_error *error);
/** The text of modelDescription.xml, a new string. */
char *fmu_description(const fmu_plan *plan);

/** A file of the archive, with the path of its source: NULL if it is `text`. */
typedef struct {
    char *name, *path;
    const char *text;
} fmu_file;
/** The binary and the libraries next to it that are not part of every system, with their names in the archive. @return
 *  their number, 0 with the reason in `error` */
int fmu_binary(memory_arena *arena, fmu_file **files, evl_error *error);
/** Write files to an archive, which is renamed when it is complete. @return false with the reason in `error` */
bool fmu_archive(const char *path, int n, const fmu_file *files, evl_error *error);
