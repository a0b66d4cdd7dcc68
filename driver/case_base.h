/** A case parsed once and read many times: shared by case.c and case_base.c. */
#ifndef EVOLVENT_CASE_BASE_H
#define EVOLVENT_CASE_BASE_H

#include "case.h"
#include "case_schema.h"
#include "case_tree.h"

struct case_base {
    char *name;
    const law_tables *laws;
    case_schema *schema;
    case_node *root;
};

#endif
