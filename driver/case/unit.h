/** Engineering units: `3 mm`, `1500 rpm`, `206 GPa`. The single table of the units that a key's unit accepts, their
 *  spellings, and their conversion to the key's unit. A key's unit is that of its row, such as "m", "rad/s" or "deg";
 *  "" accepts percent. Case-sensitive. */
#pragma once

#include "base/memory.h"
#include "base/number.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/** Classification of a text as a number. */
typedef enum {
    QUANTITY_NUMBER,     /**< a number alone, in the key's unit */
    QUANTITY_CONVERTED,  /**< a number with one of the key's units */
    QUANTITY_NOT_FINITE, /**< or too large for a double in the key's unit */
    QUANTITY_OTHER_UNIT, /**< a number followed by text that is none of the key's units */
    QUANTITY_NONE        /**< not a number */
} quantity_kind;

/** Read a number with or without a unit, such as `3 mm`, `3mm` or `3e-3`. If the units differ by a power of ten, the
 *  result is the double of the decimal text in the key's unit: `3 mm` is 0.003. Other factors are rounded once.
 *  @param key_unit    NULL: no unit is accepted, nor percent
 *  @param[out] value  in the key's unit, if the result is QUANTITY_NUMBER or QUANTITY_CONVERTED
 *  @param[out] unit   the part of `text` behind the number and its blanks, if there is one */
quantity_kind quantity_read(const char *text, const char *key_unit, double *value, const char **unit);

/** Names of the units accepted for this key unit, the usual one first; they belong to the table. NULL if there is no
 *  such key unit.
 *  @param arena  owns the array, as in arena_calloc */
const char **unit_names(const char *key_unit, memory_arena *arena, int *n);
/** Same in all accepted spellings: `kg mm2` is also kg·mm², kg*mm^2 and more. They belong to the arena, which must not
 *  be NULL. */
const char **unit_spellings(const char *key_unit, memory_arena *arena, int *n);
/** Quantity of a key unit, such as "length"; NULL if there is no such key unit. */
const char *unit_kind_name(const char *key_unit);
/** The key units of the table by index; NULL behind the last. */
const char *unit_of_keys(int index);

/** A unit for printed output. */
typedef struct {
    const char *name; /**< "" of a dimensionless number */
    double factor;    /**< number in it = factor * number */
} reading_unit;
/** The unit suitable for numbers of this size, such as mm or um; angles in degrees.
 *  @param unit     of the numbers: that of a key or any other of the table, such as "rad". An unknown unit is returned
 *                  unchanged
 *  @param largest  largest of the numbers that share the unit */
reading_unit unit_for_reading(const char *unit, double largest);
/** One of a key's units by its name, which must exist. */
reading_unit unit_of_name(const char *key_unit, const char *name);
/** A number in the unit suitable for its size, with that unit; reading the text returns the number. A new string. */
char *quantity_text(double value, const char *key_unit);

/** Why the text behind a number is refused, and which units are accepted instead: one line without end, a new string. */
char *unit_refusal(const char *key_unit, const char *unit);
/** Read the number of an option, with or without a unit.
 *  @param must  requirement to print for a text that is not a number
 *  @return NULL if `value` is read; else the reason, one line without end, a new string */
char *quantity_complaint(const char *text, const char *key_unit, const char *must, double *value);

/** Print the table in Markdown. */
void unit_print(FILE *stream);
