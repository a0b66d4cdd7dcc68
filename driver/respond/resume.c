#include "respond/resume.h"

#include "base/memory.h"
#include "base/progress.h"
#include "case/former_keys.h"
#include "model/model.h"

#include <evolvent_version.h>
#include <math.h>
#include <string.h>

void resume_identify(resume *g, const char *text)
{
    const char *processor = model_tables()->processor;
    g->of.texts[CHECKPOINT_PROGRAM] = xstrdup("evolvent " EVOLVENT_VERSION " respond");
    g->of.texts[CHECKPOINT_INTEGRATOR] = xstrdup("radau");
    g->of.texts[CHECKPOINT_KERNEL] = xasprintf("%s, compiled for %s", model_tables()->compiler, processor);
    g->of.texts[CHECKPOINT_CASE] = xstrdup(text);
}

static bool is_same(const checkpoint *a, const checkpoint *b)
{
    bool same = true;
    for (int i = 0; i < N_CHECKPOINT_TEXTS; i++) {
        same = same && strcmp(a->texts[i], b->texts[i]) == 0;
    }
    return same;
}

bool resume_open(resume *g, const char *path, evl_error *error)
{
    g->saved = clock_seconds();
    return parts_open(&g->parts, path, error);
}

bool resume_read(resume *g, bool *taken_up, evl_error *error)
{
    const char *folder = g->parts.folder;
    char doubt[EVL_ERROR_MESSAGE_LENGTH];
    checkpoint found;
    *taken_up = false;
    if (!checkpoint_exists(folder)) {
        return true;
    }
    bool good = checkpoint_read(folder, &found, doubt, error);
    if (good) {
        case_text_use_present_keys(&found.texts[CHECKPOINT_CASE]);
    }
    if (good && !is_same(&found, &g->of)) {
        good = evl_error_set(error, EVL_EXIT_CASE, "",
                             "'%s' contains another incomplete response: its case, range, options or program differ; "
                             "complete that one, delete the folder, or write to another file with -o",
                             folder);
    } else if (good) {
        g->serialize(g->self, &found.state);
        good = archive_is_read(&found.state) ||
               evl_error_set(error, EVL_EXIT_CASE, "", "'%s' contains something else; delete the folder", folder);
    }
    *taken_up = good;
    checkpoint_free(&found);
    return good;
}

bool resume_is_due(const resume *g)
{
    static const double interval = 0.25, share = 0.1; /* [s] between two checkpoints; share of the total time */
    return clock_seconds() - g->saved > fmax(interval, g->took / share);
}

bool resume_save(resume *g, double t, evl_error *error)
{
    const double began = clock_seconds();
    checkpoint next = g->of;
    next.t = t;
    next.state = (archive){.n = 0};
    g->serialize(g->self, &next.state);
    const bool good = checkpoint_write(g->parts.folder, &next, error);
    archive_free(&next.state);
    g->saved = clock_seconds();
    g->took = g->saved - began;
    return good;
}

void resume_close(resume *g, bool done)
{
    if (done) {
        parts_remove(&g->parts);
    }
    parts_close(&g->parts);
}
