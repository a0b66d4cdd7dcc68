#include "respond/branches.h"

#include <string.h>

enum { MOST = 10000000, LONGEST = 100000 };

static void serialize_count(int *n, int most, archive *archive)
{
    archive_serialize(archive, n, 1, sizeof *n);
    archive->has_failed = archive->has_failed || *n < 0 || *n > most;
    if (archive->has_failed) {
        *n = 0;
    }
}

static void serialize_text(branches *o, const char **text, archive *archive)
{
    int length = archive->is_reading ? 0 : (int)strlen(*text);
    serialize_count(&length, LONGEST, archive);
    char *copy = arena_calloc(&o->arena, (size_t)length + 1, 1);
    if (!archive->is_reading) {
        memcpy(copy, *text, (size_t)length);
    }
    SERIALIZE_ARRAY(archive, copy, length);
    *text = copy;
}

static void serialize_point(branches *o, int index, archive *archive)
{
    orbit_point *point = &o->points[index];
    const int n_doubles = 2 * (o->sizes.n + o->sizes.n_reals);
    bool has_values = point->values != NULL;
    SERIALIZE(archive, point->branch);
    SERIALIZE(archive, point->orbit);
    SERIALIZE(archive, point->at_value);
    SERIALIZE(archive, has_values);
    if (archive->is_reading) {
        point->multipliers = arena_calloc(&o->arena, (size_t)n_doubles, sizeof(double));
        o->records[index] = arena_calloc(&o->arena, (size_t)o->record_length, sizeof(double));
        point->values = has_values ? arena_calloc(&o->arena, (size_t)o->sweep->n_values, sizeof(double)) : NULL;
    }
    SERIALIZE_ARRAY(archive, point->multipliers, n_doubles);
    SERIALIZE_ARRAY(archive, o->records[index], o->record_length);
    if (has_values) {
        SERIALIZE_ARRAY(archive, point->values, o->sweep->n_values);
    }
}

static void serialize_sizes(branches *o, archive *archive)
{
    serialize_count(&o->sizes.n, LONGEST, archive);
    serialize_count(&o->sizes.n_integers, LONGEST, archive);
    serialize_count(&o->sizes.n_reals, LONGEST, archive);
    serialize_count(&o->record_length, LONGEST, archive);
    serialize_count(&o->n_branches, MOST, archive);
    serialize_count(&o->n_points, MOST, archive);
    serialize_count(&o->n_problems, MOST, archive);
    if (archive->is_reading) {
        o->branches = arena_calloc(&o->arena, (size_t)o->n_branches + 1, sizeof *o->branches);
        o->points = arena_calloc(&o->arena, (size_t)o->n_points + 1, sizeof *o->points);
        o->records = arena_calloc(&o->arena, (size_t)o->n_points + 1, sizeof *o->records);
        o->problems = arena_calloc(&o->arena, (size_t)o->n_problems + 1, sizeof *o->problems);
    }
}

void branches_serialize(branches *o, archive *archive)
{
    SERIALIZE(archive, o->value);
    SERIALIZE(archive, o->task);
    SERIALIZE(archive, o->doubling);
    SERIALIZE(archive, o->is_continuing);
    SERIALIZE(archive, o->progress);
    SERIALIZE(archive, o->at.period);
    SERIALIZE(archive, o->at.time);
    SERIALIZE(archive, o->has_orbits);
    SERIALIZE(archive, o->scaled_at);
    SERIALIZE(archive, o->position);
    bool moves = o->motion.exists;
    SERIALIZE(archive, moves);
    if (moves) {
        state_transfer_serialize(&o->motion, archive);
    }
    serialize_sizes(o, archive);
    int n = 0;
    for (int i = 0; i < o->n_branches && !archive->has_failed; i++) {
        orbit_branch *branch = &o->branches[i];
        SERIALIZE(archive, branch->parent);
        serialize_count(&branch->n, o->n_points, archive);
        serialize_text(o, &branch->end, archive);
        n += branch->n;
    }
    archive->has_failed = archive->has_failed || n != o->n_points || o->value < 0 || o->value > o->sweep->range->n ||
                          o->task < BRANCHES_LOOK || o->task > BRANCHES_DOUBLE || o->doubling < 0 ||
                          o->doubling > o->n_points || (o->is_continuing && (o->n_branches == 0 || !o->has_orbits));
    for (int i = 0; i < o->n_points && !archive->has_failed; i++) {
        serialize_point(o, i, archive);
    }
    for (int i = 0; i < o->n_problems && !archive->has_failed; i++) {
        serialize_text(o, &o->problems[i], archive);
    }
}
