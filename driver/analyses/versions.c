#include "analyses/versions.h"

#include "base/memory.h"
#include "files/history.h"
#include "integrate/integrate.h"
#include "model/model.h"

#include <evolvent_version.h>

char *result_versions(void)
{
    const char *library = history_version();
    return xasprintf("evolvent %s, %s%s%s, C compiler %s, Fortran compiler %s", EVOLVENT_VERSION, integrate_version(),
                     library[0] == '\0' ? "" : ", ", library, EVOLVENT_C_COMPILER, model_tables()->compiler);
}
