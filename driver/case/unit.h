/** Units as engineers write them: `3 mm`, `1500 rpm`, `206 GPa`. The one table: what a key's unit takes, in which spellings, and what a
 *  number in it is in the key's unit. A key's unit is that of its row, such as "m", "rad/s" or "deg"; "" takes percent. Small and
 *  capital letters differ. */
#pragma once

#include "base/memory.h"
#include "base/number.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/** What a text says of a number. */
typedef enum {
    QUANTITY_NUMBER,     /**< a number alone, in the key's unit */
    QUANTITY_CONVERTED,  /**< a number with one of the key's units */
    QUANTITY_NOT_FINITE, /**< or too large for a double in the key's unit */
    QUANTITY_OTHER_UNIT, /**< a number and behind it what is none of the key's units */
    QUANTITY_NONE        /**< no number */
} quantity_kind;

/** Read a number with or without a unit, such as `3 mm`, `3mm` or `3e-3`. With a power of ten between the units it is the double of
 *  the decimal text in the key's unit: `3 mm` is 0.003. Other factors are rounded once.
 *  @param key_unit    NULL: no unit is taken, nor percent
 *  @param[out] value  in the key's unit, where the result is QUANTITY_NUMBER or QUANTITY_CONVERTED
 *  @param[out] unit   the part of `text` behind the number and its blanks, where there is one */
quantity_kind quantity_read(const char *text, const char *key_unit, double *value, const char **unit);

/** The names of the units that a key of this unit takes: the usual one first. NULL if there is
 *  no such key unit. They are the table's.
 *  @param pool  of the array, as pool_calloc has it */
const char **unit_names(const char *key_unit, memory_pool *pool, int *n);
/** The same in all spellings that are read, exactly: `kg mm2` is also kg·mm², kg*mm^2 and more. They are the pool's, which is there. */
const char **unit_spellings(const char *key_unit, memory_pool *pool, int *n);
/** What a key of this unit is, such as "length"; NULL if there is no such key unit. */
const char *unit_kind_name(const char *key_unit);
/** The key units of the table, one by one: NULL behind the last. */
const char *unit_of_keys(int index);

/** A unit in which something is printed for reading. */
typedef struct {
    const char *name; /**< "" of a number without unit */
    double factor;    /**< number in it = factor * number */
} reading_unit;
/** The unit that suits numbers of this size, such as mm or um; angles in degrees.
 *  @param unit    of the numbers: that of a key or any other of the table, such as "rad". What is none is its own reading unit
 *  @param largest of the numbers that are to have one unit */
reading_unit unit_for_reading(const char *unit, double largest);
/** One of a key's units, which has to be one of its names. */
reading_unit unit_of_name(const char *key_unit, const char *name);
/** A number in the unit that suits its size, with that unit: reading the text gives the number again. A new string. */
char *quantity_text(double value, const char *key_unit);

/** Why what stands behind a number is refused, and what a key of this unit takes instead: one line without end, a new string. */
char *unit_refusal(const char *key_unit, const char *unit);
/** Read the number of an option, with or without a unit.
 *  @param must  what is said of a text that is no number
 *  @return NULL if `value` is read; else why not, one line without end, a new string */
char *quantity_complaint(const char *text, const char *key_unit, const char *must, double *value);

/** Print the table in Markdown. */
void unit_print(FILE *stream);
