#include "analyses/find_mesh.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/suggest.h"

#include <math.h>
#include <string.h>

bool find_mesh(const description *description, const char *text, int *mesh, evl_error *error)
{
    double index;
    *mesh = 0;
    if (text == NULL) {
        return true;
    }
    for (int i = 0; i < description->n_meshes; i++) {
        if (strcmp(text, description->meshes[i]) == 0) {
            *mesh = i;
            return true;
        }
    }
    if (number_read(text, &index) == NUMBER_FINITE && index >= 0.0 && index < description->n_meshes &&
        index == floor(index)) {
        *mesh = (int)index;
        return true;
    }
    CLEANUP_FREE char *meant = suggest_phrase(text, description->n_meshes, description->meshes);
    CLEANUP_FREE char *location = xasprintf("--mesh %s", text);
    return evl_error_set(error, EVL_EXIT_USAGE, location, "the case has no such mesh%s", meant);
}
