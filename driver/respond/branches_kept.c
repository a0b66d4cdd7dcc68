#include "respond/branches.h"

#include <string.h>

enum { MOST = 10000000, LONGEST = 100000 };

static void keep_count(int *n, int most, archive *archive)
{
    archive_keep(archive, n, 1, sizeof *n);
    archive->has_failed = archive->has_failed || *n < 0 || *n > most;
    if (archive->has_failed) {
        *n = 0;
    }
}

static void keep_text(branches *o, const char **text, archive *archive)
{
    int length = archive->is_reading ? 0 : (int)strlen(*text);
    keep_count(&length, LONGEST, archive);
    char *copy = pool_calloc(&o->pool, (size_t)length + 1, 1);
    if (!archive->is_reading) {
        memcpy(copy, *text, (size_t)length);
    }
    KEEP_ARRAY(archive, copy, length);
    *text = copy;
}

static void keep_point(branches *o, int index, archive *archive)
{
    orbit_point *point = &o->points[index];
    const int n_room = 2 * (o->sizes.n + o->sizes.n_reals);
    bool has_values = point->values != NULL;
    KEEP(archive, point->branch);
    KEEP(archive, point->orbit);
    KEEP(archive, point->at_value);
    KEEP(archive, has_values);
    if (archive->is_reading) {
        point->multipliers = pool_calloc(&o->pool, (size_t)n_room, sizeof(double));
        o->kept[index] = pool_calloc(&o->pool, (size_t)o->n_kept, sizeof(double));
        point->values = has_values ? pool_calloc(&o->pool, (size_t)o->sweep->n_values, sizeof(double)) : NULL;
    }
    KEEP_ARRAY(archive, point->multipliers, n_room);
    KEEP_ARRAY(archive, o->kept[index], o->n_kept);
    if (has_values) {
        KEEP_ARRAY(archive, point->values, o->sweep->n_values);
    }
}

static void keep_sizes(branches *o, archive *archive)
{
    keep_count(&o->sizes.n, LONGEST, archive);
    keep_count(&o->sizes.n_integers, LONGEST, archive);
    keep_count(&o->sizes.n_reals, LONGEST, archive);
    keep_count(&o->n_kept, LONGEST, archive);
    keep_count(&o->n_branches, MOST, archive);
    keep_count(&o->n_points, MOST, archive);
    keep_count(&o->n_problems, MOST, archive);
    if (archive->is_reading) {
        o->branches = pool_calloc(&o->pool, (size_t)o->n_branches + 1, sizeof *o->branches);
        o->points = pool_calloc(&o->pool, (size_t)o->n_points + 1, sizeof *o->points);
        o->kept = pool_calloc(&o->pool, (size_t)o->n_points + 1, sizeof *o->kept);
        o->problems = pool_calloc(&o->pool, (size_t)o->n_problems + 1, sizeof *o->problems);
    }
}

void branches_keep(branches *o, archive *archive)
{
    KEEP(archive, o->value);
    KEEP(archive, o->task);
    KEEP(archive, o->doubling);
    KEEP(archive, o->is_under_way);
    KEEP(archive, o->progress);
    KEEP(archive, o->at.period);
    KEEP(archive, o->at.time);
    KEEP(archive, o->has_orbits);
    KEEP(archive, o->scaled_at);
    KEEP(archive, o->place);
    bool moves = o->motion.exists;
    KEEP(archive, moves);
    if (moves) {
        carried_keep(&o->motion, archive);
    }
    keep_sizes(o, archive);
    int n = 0;
    for (int i = 0; i < o->n_branches && !archive->has_failed; i++) {
        orbit_branch *branch = &o->branches[i];
        KEEP(archive, branch->parent);
        keep_count(&branch->n, o->n_points, archive);
        keep_text(o, &branch->end, archive);
        n += branch->n;
    }
    archive->has_failed = archive->has_failed || n != o->n_points || o->value < 0 || o->value > o->sweep->range->n ||
                          o->task < BRANCHES_LOOK || o->task > BRANCHES_DOUBLE || o->doubling < 0 ||
                          o->doubling > o->n_points || (o->is_under_way && (o->n_branches == 0 || !o->has_orbits));
    for (int i = 0; i < o->n_points && !archive->has_failed; i++) {
        keep_point(o, i, archive);
    }
    for (int i = 0; i < o->n_problems && !archive->has_failed; i++) {
        keep_text(o, &o->problems[i], archive);
    }
}
