/** Suggested word for a mistyped one. Leaf module. */
#pragma once

/** The candidate with the smallest edit distance to `text` (insertions, deletions, substitutions, transposed
 *  neighbours; case ignored), the first one of several; NULL if none is near enough. */
const char *suggest_nearest(const char *text, int n, const char *const *candidates);

/** " (did you mean 'WORD'?)" as a new string, or an empty one; the caller frees it. */
char *suggest_phrase(const char *text, int n, const char *const *candidates);
