/* Cases of the library. */
#include "base/memory.h"
#include "library/boundary.h"
#include "library/library.h"

#include <evolvent_version.h>
#include <stdio.h>
#include <stdlib.h>

const volatile sig_atomic_t library_never = 0;

#define SAME_CODE(ours, theirs) _Static_assert((int)(ours) == (int)(theirs), "exit codes are those of the program")
SAME_CODE(EVOLVENT_OK, EVL_EXIT_OK);
SAME_CODE(EVOLVENT_USAGE, EVL_EXIT_USAGE);
SAME_CODE(EVOLVENT_CASE, EVL_EXIT_CASE);
SAME_CODE(EVOLVENT_INTEGRATION, EVL_EXIT_INTEGRATION);
SAME_CODE(EVOLVENT_MEMORY, EVL_EXIT_MEMORY);
SAME_CODE(EVOLVENT_RESULT, EVL_EXIT_IO);
SAME_CODE(EVOLVENT_INTERRUPTED, EVL_EXIT_INTERRUPTED);
_Static_assert(sizeof((evolvent_error *)NULL)->place == EVL_ERROR_LOCATION_LENGTH, "whole places");
_Static_assert(sizeof((evolvent_error *)NULL)->message == EVL_ERROR_MESSAGE_LENGTH, "whole messages");
_Static_assert(sizeof(sig_atomic_t) == sizeof(int), "a caller's int stops a run");

const char *library_who(int stop)
{
    (void)stop;
    return "the caller";
}

evolvent_code library_report_error(const evl_error *from, evolvent_error *to)
{
    if (to != NULL) {
        to->code = (evolvent_code)from->code;
        (void)snprintf(to->place, sizeof to->place, "%s", from->location);
        (void)snprintf(to->message, sizeof to->message, "%s", from->message);
    }
    return (evolvent_code)from->code;
}

const char *evolvent_version(void)
{
    return EVOLVENT_VERSION;
}

typedef struct {
    plan_request from;
    evolvent_case *made;
    evl_error error;
} making;

static void make(void *with)
{
    making *m = with;
    m->made = xcalloc(1, sizeof *m->made);
    if (!case_plan_make(&m->made->plan, &m->from, &m->error)) {
        evolvent_case_free(m->made);
        m->made = NULL;
    }
}

static evolvent_case *make_case(making *m, evolvent_error *error)
{
    boundary_call(make, m, &m->error);
    return library_report_error(&m->error, error) == EVOLVENT_OK ? m->made : NULL;
}

evolvent_case *evolvent_case_read(const char *path, int n_set, const char *const *set, evolvent_error *error)
{
    return make_case(&(making){.from = {.name = path, .n_set = n_set, .set = set}}, error);
}

evolvent_case *evolvent_case_parse(const char *name, const char *text, int n_set, const char *const *set,
                                   evolvent_error *error)
{
    return make_case(&(making){.from = {.name = name, .text = text, .n_set = n_set, .set = set}}, error);
}

void evolvent_case_free(evolvent_case *gearbox)
{
    if (gearbox != NULL) {
        case_plan_free(&gearbox->plan);
        free(gearbox);
    }
}
