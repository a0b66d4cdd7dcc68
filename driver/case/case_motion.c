/* Part of a case that affects the motion. */
#include "case/case.h"

#include "base/memory.h"
#include "case/case_file.h"

#include <string.h>

static void leave_out(case_node *mapping, const char *key)
{
    const int at = node_find(mapping, key);
    if (at >= 0) {
        mapping->n--;
        memmove(mapping->entries + at, mapping->entries + at + 1, (size_t)(mapping->n - at) * sizeof *mapping->entries);
    }
}

char *case_text_of_motion(const case_file *file)
{
    POOLED memory_pool pool = {NULL};
    case_node *root = node_copy(&pool, file->root);
    leave_out(root, "title");
    leave_out(node_get(root, "simulation"), "max_steps");
    return tree_text(root);
}
