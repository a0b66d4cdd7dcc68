#include "model/model_names.h"

#include "base/memory.h"

#include <stdlib.h>

model_names model_names_copy(const model *model, const description *description)
{
    int n_pairs, n_drive;
    model_pair_places(model, &n_pairs, &n_drive);
    char **wheels = xcalloc((size_t)description->n_wheels, sizeof *wheels);
    char **meshes = xcalloc((size_t)description->n_meshes, sizeof *meshes);
    char **shafts = xcalloc((size_t)description->n_shafts, sizeof *shafts);
    char **pairs = xcalloc((size_t)n_pairs, sizeof *pairs);
    for (int i = 0; i < description->n_wheels; i++) {
        wheels[i] = xstrdup(description->wheels[i]);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        meshes[i] = xstrdup(description->meshes[i]);
    }
    for (int i = 0; i < description->n_shafts; i++) {
        shafts[i] = xstrdup(description->shafts[i]);
    }
    for (int i = 0; i < n_pairs; i++) {
        pairs[i] = i < n_drive ? xasprintf("drive_%d", i) : xasprintf("coast_%d", i - n_drive);
    }
    return (model_names){.wheels = {description->n_wheels, (const char *const *)wheels},
                         .meshes = {description->n_meshes, (const char *const *)meshes},
                         .shafts = {description->n_shafts, (const char *const *)shafts},
                         .pairs = {n_pairs, (const char *const *)pairs}};
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
