/** A case and its model. */
#pragma once

#include "case/case.h"
#include "model/model.h"

typedef struct {
    case_file *file;
    model *model;
    bool needs_roots; /**< the model has the outputs of the root stress although the case does not name them */
} prepared_case;
