/** The names of what the values of a model belong to. */
#pragma once

#include "case/case.h"
#include "model/model.h"

typedef struct {
    int n;
    const char *const *names; /**< [n] */
} name_list;

typedef struct {
    name_list wheels, meshes, shafts;
    name_list pairs; /**< places for the tooth pairs of a mesh: drive_0, drive_1, ..., coast_0, ... */
} model_names;

/** Copies, which outlive model and description. */
model_names model_names_copy(const model *model, const description *description);
void model_names_free(model_names *names);
