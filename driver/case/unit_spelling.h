/** Spellings of a unit's name: kg mm2 is also kg·mm², kg*mm^2, and rad/s is rad s-1. Leaf module. */
#pragma once

#include <stdbool.h>

enum { N_UNIT_SPELLINGS = 90, UNIT_SPELLING_LENGTH = 64 };

/** One of the spellings of a name, by index from 0 (the name itself) to N_UNIT_SPELLINGS - 1.
 *  @return false if there is none of that index */
bool unit_spelling(const char *name, int i, char text[UNIT_SPELLING_LENGTH]);
/** Typeset a name: um mm/N is µm·mm/N, kg m2 is kg·m², deg is °. */
void unit_typeset(const char *name, char text[UNIT_SPELLING_LENGTH]);
/** Whether a text is one of the spellings. */
bool unit_is_spelled(const char *name, const char *text);
/** The spelling used in results: "rad s-1" of "rad/s"; a name with only one spelling ("N/m^exponent") is unchanged. A
 *  new string. */
char *unit_of_results(const char *name);
