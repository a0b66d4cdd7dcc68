/** The spellings of a unit's name: kg mm2 is also kg·mm², kg*mm^2, and rad/s is rad s-1. A leaf. */
#pragma once

#include <stdbool.h>

enum { N_UNIT_SPELLINGS = 90, UNIT_SPELLING_LENGTH = 64 };

/** One of the spellings of a name, by numbers from 0 (the name itself) to N_UNIT_SPELLINGS - 1.
 *  @return false if there is none of that number */
bool unit_spelling(const char *name, int i, char text[UNIT_SPELLING_LENGTH]);
/** Whether a text is one of them. */
bool unit_is_spelled(const char *name, const char *text);
/** The one of them that results have: "rad s-1" of "rad/s"; a name that has one spelling ("N/m^exponent") as it is. A new string. */
char *unit_of_results(const char *name);
