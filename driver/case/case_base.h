/** A case parsed once and read many times: shared by case.c and case_base.c. */
#pragma once

#include "case/case.h"
#include "case/case_schema.h"
#include "case/case_tree.h"

struct case_base {
    char *name;
    const case_schema *schema;
    case_node *root;
};
