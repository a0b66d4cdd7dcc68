/** The word that a mistyped one was probably meant to be. A leaf. */
#pragma once

/** The candidate with the smallest edit distance to `text` (insertions, deletions, substitutions, swapped neighbours;
 *  case ignored), the first one of several; NULL if none is near enough to be worth naming. */
const char *suggest_nearest(const char *text, int n, const char *const *candidates);

/** " (did you mean 'WORD'?)" as a new string, or an empty one; the caller frees it. */
char *suggest_phrase(const char *text, int n, const char *const *candidates);
