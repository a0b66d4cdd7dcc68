/** A checked tree laid out as the entries that a model is made from. */
#pragma once

#include "case/case_schema.h"
#include "case/description.h"

/** Fill the entries of a description. Their names are the texts of the tree, which have to stay where they are. */
void case_lay_out(const case_schema *schema, const case_node *root, description *description);
