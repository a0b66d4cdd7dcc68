#include "case/description.h"

#include <stdlib.h>
#include <string.h>

static void clear_wheel(wheel_description *wheel)
{
    for (int i = 0; i < wheel->n_loads; i++) {
        free(wheel->loads[i].choice.numbers);
    }
    free(wheel->loads);
    free(wheel->support.numbers);
    free(wheel->deviation.pitch_errors);
    free(wheel->name);
}

void description_clear(description *description)
{
    for (int i = 0; i < description->n_materials; i++) {
        free(description->materials[i].name);
    }
    for (int i = 0; i < description->n_wheels; i++) {
        clear_wheel(&description->wheels[i]);
    }
    for (int i = 0; i < description->n_meshes; i++) {
        free(description->meshes[i].name);
    }
    for (int i = 0; i < description->n_shafts; i++) {
        free(description->shafts[i].name);
    }
    for (int i = 0; i < description->housing.n_motions; i++) {
        free(description->housing.motions[i].time);
        free(description->housing.motions[i].values);
    }
    free(description->housing.motions);
    free(description->materials);
    free(description->wheels);
    free(description->meshes);
    free(description->shafts);
    free(description->simulation.initial.speeds);
    free(description->simulation.initial.gaps);
    free(description->title);
    memset(description, 0, sizeof *description);
}
