#include "case/description.h"

#include <stdlib.h>
#include <string.h>

void description_clear(description *description)
{
    free(description->wheels);
    free(description->meshes);
    free(description->shafts);
    free((void *)description->simulation.initial.speeds);
    free((void *)description->simulation.initial.gaps);
    free(description->entries);
    free(description->numbers);
    memset(description, 0, sizeof *description);
}
