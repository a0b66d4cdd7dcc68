#include "commands/warn.h"

#include "base/log.h"
#include "base/memory.h"

void warn_of_case(const prepared_case *prepared)
{
    for (int i = 0; i < model_n_warnings(prepared->model); i++) {
        OWNED char *text = prepare_warning(prepared, i);
        log_warning("%s", text);
    }
}
