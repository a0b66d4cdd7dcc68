#include "base/memory.h"
#include "files/checkpoint.h"
#include "model/model.h"

#include <evolvent_version.h>
#include <stdio.h>
#include <string.h>

void checkpoint_identify(checkpoint *own, const char *integrator, const char *text)
{
    const char *processor = model_tables()->processor;
    own->texts[CHECKPOINT_PROGRAM] = xstrdup("evolvent " EVOLVENT_VERSION);
    own->texts[CHECKPOINT_INTEGRATOR] = xstrdup(integrator);
    own->texts[CHECKPOINT_KERNEL] = xasprintf("%s, compiled for %s", model_tables()->compiler,
                                              processor[0] != '\0' ? processor : "the compiler's usual processor");
    own->texts[CHECKPOINT_CASE] = xstrdup(text);
}

/** The first line in which two texts differ, truncated to the length of a message. */
static void find_difference(const char *a, const char *b, char line_a[80], char line_b[80])
{
    for (;;) {
        const size_t n_a = strcspn(a, "\n"), n_b = strcspn(b, "\n");
        if (n_a != n_b || strncmp(a, b, n_a) != 0 || a[n_a] != b[n_b]) {
            a += strspn(a, " ");
            b += strspn(b, " ");
            (void)snprintf(line_a, 80, "%.*s", (int)strcspn(a, "\n"), a);
            (void)snprintf(line_b, 80, "%.*s", (int)strcspn(b, "\n"), b);
            return;
        }
        if (a[n_a] == '\0') {
            return;
        }
        a += n_a + 1;
        b += n_b + 1;
    }
}

int checkpoint_compare(const checkpoint *own, const checkpoint *found, const char *location, evl_error *error)
{
    static const char *const words[N_CHECKPOINT_TEXTS] = {"version", "integrator", "kernel", "case"};
    for (int i = 0; i < N_CHECKPOINT_TEXTS; i++) {
        char theirs[80] = "", ours[80] = "";
        if (strcmp(found->texts[i], own->texts[i]) != 0) {
            find_difference(found->texts[i], own->texts[i], theirs, ours);
            (void)evl_error_set(error, EVL_EXIT_CASE, location,
                                "the checkpoint is of another %s: '%s' there, '%s' here", words[i], theirs, ours);
            return i;
        }
    }
    return N_CHECKPOINT_TEXTS;
}
