/* Responses of the library. */
#include "analyses/versions.h"
#include "base/memory.h"
#include "library/boundary.h"
#include "library/library.h"
#include "respond/respond.h"

#include <string.h>

typedef struct {
    const char *name;
    const evolvent_respond_request *request;
    respond_options options;
    history *in_memory;
    evolvent_record *record;
    evl_error error;
} response_call;

static bool read_request(response_call *call)
{
    const evolvent_respond_request *request = call->request;
    const char *direction = request->direction != NULL ? request->direction : "both";
    respond_options *options = &call->options;
    const bool both = strcmp(direction, "both") == 0;
    options->over = request->over;
    options->up = both || strcmp(direction, "up") == 0;
    options->down = both || strcmp(direction, "down") == 0;
    if (request->over == NULL) {
        return evl_error_set(&call->error, EVL_EXIT_USAGE, "over",
                             "PATH=FROM:TO[:STEPS] gives the parameter and its range");
    }
    if (!options->up && !options->down) {
        return evl_error_set(&call->error, EVL_EXIT_USAGE, "direction", "is '%s', must be up, down or both", direction);
    }
    return request->periods == NULL || respond_read_most(request->periods, &options->most) ||
           evl_error_set(&call->error, EVL_EXIT_USAGE, "", "%s", respond_periods);
}

static void work(void *with)
{
    response_call *call = with;
    CLEANUP_FREE char *versions = result_versions();
    call->options.versions = versions;
    call->options.in_memory = &call->in_memory;
    if (read_request(call)) {
        (void)respond(call->name, &call->options, &call->error);
    }
    call->record = library_record(call->in_memory);
}

evolvent_code evolvent_respond(const char *name, const char *text, int n_set, const char *const *set,
                               const evolvent_respond_request *request, const volatile int *stop,
                               evolvent_record **record, evolvent_error *error)
{
    static const evolvent_respond_request nothing = {NULL, NULL, NULL};
    response_call call = {.name = name,
                          .request = request != NULL ? request : &nothing,
                          .options = {.text = text,
                                      .path = "",
                                      .n_set = n_set,
                                      .set = set,
                                      .quiet = true,
                                      .interrupt = stop != NULL ? stop : &library_never,
                                      .who = library_who}};
    boundary_call(work, &call, &call.error);
    *record = call.record;
    return library_report_error(&call.error, error);
}
