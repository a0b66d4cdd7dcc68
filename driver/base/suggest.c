#include "base/suggest.h"

#include "base/memory.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_WORD = 64 };

static int lower(char c)
{
    return tolower((unsigned char)c);
}

static int smaller(int a, int b)
{
    return a < b ? a : b;
}

/** Optimal string alignment distance of two words of at most LONGEST_WORD bytes. */
static int edit_distance(const char *a, int n_a, const char *b, int n_b)
{
    int rows[3][LONGEST_WORD + 1];
    int *before = rows[0], *last = rows[1], *row = rows[2];
    for (int j = 0; j <= n_b; j++) {
        last[j] = j;
    }
    for (int i = 1; i <= n_a; i++) {
        row[0] = i;
        for (int j = 1; j <= n_b; j++) {
            const int cost = lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1;
            row[j] = smaller(smaller(last[j] + 1, row[j - 1] + 1), last[j - 1] + cost);
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1])) {
                row[j] = smaller(row[j], before[j - 2] + 1);
            }
        }
        int *free_row = before;
        before = last;
        last = row;
        row = free_row;
    }
    return last[n_b];
}

const char *suggest_nearest(const char *text, int n, const char *const *candidates)
{
    const size_t length = strlen(text);
    if (length > LONGEST_WORD) {
        return NULL;
    }
    const char *nearest = NULL;
    int nearest_distance = 0;
    for (int i = 0; i < n; i++) {
        const size_t candidate_length = strlen(candidates[i]);
        if (candidate_length > LONGEST_WORD) {
            continue;
        }
        const int distance = edit_distance(text, (int)length, candidates[i], (int)candidate_length);
        /* a third of the letters may be wrong, one in short words; at least one must match */
        const int longer = (int)(length > candidate_length ? length : candidate_length);
        if (distance <= (longer < 6 ? 1 + longer / 5 : longer / 3) && distance < longer &&
            (nearest == NULL || distance < nearest_distance)) {
            nearest = candidates[i];
            nearest_distance = distance;
        }
    }
    return nearest;
}

char *suggest_phrase(const char *text, int n, const char *const *candidates)
{
    const char *nearest = suggest_nearest(text, n, candidates);
    return nearest == NULL ? xstrdup("") : xasprintf(" (did you mean '%s'?)", nearest);
}
