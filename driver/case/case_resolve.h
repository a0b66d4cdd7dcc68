/** A checked case tree to a description: what goes beyond single keys (references, tables, names) is checked here. */
#pragma once

#include "case/case_schema.h"
#include "case/description.h"

/** Fill `description`, but for its entries, from a tree that schema_check accepted; gaps that are not given are added to the tree as 0.
 *  @param path  the case file, for the places in messages
 *  @return false with the reason in `error`; `description` can be freed in any case */
bool case_resolve(const case_schema *schema, const char *path, case_node *root, description *description,
                  evl_error *error);
