#include "model/model_names.h"

#include "base/memory.h"

#include <stdlib.h>

static name_list copy_names(int n, const char *const *names)
{
    char **copy = xcalloc((size_t)n, sizeof *copy);
    for (int i = 0; i < n; i++) {
        copy[i] = xstrdup(names[i]);
    }
    return (name_list){n, (const char *const *)copy};
}

static name_list name_pairs(const model *model)
{
    int n, n_drive;
    model_pair_places(model, &n, &n_drive);
    char **pairs = xcalloc((size_t)n, sizeof *pairs);
    for (int i = 0; i < n; i++) {
        pairs[i] = i < n_drive ? xasprintf("drive_%d", i) : xasprintf("coast_%d", i - n_drive);
    }
    return (name_list){n, (const char *const *)pairs};
}

model_names model_names_copy(const model *model, const description *description)
{
    return (model_names){.wheels = copy_names(description->n_wheels, description->wheels),
                         .meshes = copy_names(description->n_meshes, description->meshes),
                         .shafts = copy_names(description->n_shafts, description->shafts),
                         .pairs = name_pairs(model)};
}

void model_names_free(model_names *names)
{
    const name_list lists[] = {names->wheels, names->meshes, names->shafts, names->pairs};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++) {
        for (int i = 0; i < lists[k].n; i++) {
            free((char *)lists[k].names[i]);
        }
        free((void *)lists[k].names);
    }
    *names = (model_names){0};
}
