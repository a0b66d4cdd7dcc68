/** Mapping of a case to an FMU: value references of the variables, and the texts common to the description and the
 *  binary. */
#pragma once

#include "base/sha256.h"
#include "motion/motion.h"

/** Name of the binary and of the model in an FMU; the file name is chosen by the user. */
#define FMU_MODEL_IDENTIFIER "evolvent"
/** The case among the FMU's resources. */
#define FMU_CASE "case.yaml"

/** A value reference consists of a kind of variable and an index. */
typedef enum {
    FMU_TIME = 0,
    FMU_STATE = 1,
    FMU_RATE = 2, /**< of a state */
    FMU_INDICATOR = 3,
    FMU_INPUT = 4,
    FMU_INPUT_RATE = 5, /**< of an input that is a speed */
    FMU_OUTPUT = 6,     /**< a value of the outputs selected by the case */
    FMU_PARAMETER = 7   /**< of a motion, with all its numbers */
} fmu_kind;
enum { FMU_KIND_SHIFT = 28 };

static inline unsigned fmu_reference(fmu_kind kind, int index)
{
    return ((unsigned)kind << FMU_KIND_SHIFT) | (unsigned)index;
}

/** Instantiation token of the FMU: identifies the case and the program of its description. */
void fmu_token(const case_file *file, char token[SHA256_TEXT]);
