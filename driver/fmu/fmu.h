/** What a case is as an FMU: which number stands for which variable, and the texts that the description and the binary share. */
#pragma once

#include "base/sha256.h"
#include "motion/motion.h"

/** The name of the binary and of the model in an FMU; that of an importer's choice is the file's. */
#define FMU_MODEL_IDENTIFIER "evolvent"
/** The case among the FMU's resources. */
#define FMU_CASE "case.yaml"

/** A value reference is a kind of variable and which one of it. */
typedef enum {
    FMU_TIME = 0,
    FMU_STATE = 1,
    FMU_RATE = 2, /**< of a state */
    FMU_INDICATOR = 3,
    FMU_INPUT = 4,
    FMU_INPUT_RATE = 5, /**< of an input that is a speed */
    FMU_OUTPUT = 6,     /**< a value of the outputs that the case chooses */
    FMU_PARAMETER = 7   /**< of a motion, with all its numbers */
} fmu_kind;
enum { FMU_KIND_SHIFT = 28 };

static inline unsigned fmu_reference(fmu_kind kind, int index)
{
    return ((unsigned)kind << FMU_KIND_SHIFT) | (unsigned)index;
}

/** What ties a description to the case and the program that it was made with: the FMU's instantiation token. */
void fmu_token(const prepared_case *prepared, char token[SHA256_TEXT]);
