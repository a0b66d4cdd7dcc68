/** A case and its model. */
#pragma once

#include "case/case.h"
#include "model/model.h"

typedef struct {
    case_file *file;
    model *model;
} prepared_case;
