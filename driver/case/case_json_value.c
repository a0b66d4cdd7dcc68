/* Single values in a JSON Schema: numbers with their ranges and units, lists, words, names. */
#include "case/case_json_value.h"

#include "base/words.h"
#include "case/case_check.h"
#include "case/unit.h"

#include <limits.h>
#include <math.h>
#include <string.h>

/** Syntax of numbers accepted by the reader (base/number.c). */
#define DECIMAL "[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?"
/** Syntax accepted by check_name: no blank, no path separator, not a number. */
#define NO_NAME DECIMAL "|[-+]?([iI][nN][fF]([iI][nN][iI][tT][yY])?|[nN][aA][nN])"
#define NAME "^(?!(" NO_NAME ")$)[^\\u0000- .=/\\u007f]+$"

static void write_words(json_writer *json, const char *key, const char *words)
{
    CLEANUP_FREE char **list = NULL;
    const int n = words_split(words, &list);
    json_open(json, key, '[');
    for (int i = 0; i < n; i++) {
        if (strcmp(list[i], "true") == 0 || strcmp(list[i], "false") == 0) {
            json_truth(json, NULL, list[i][0] == 't');
        }
        json_text(json, NULL, list[i]);
    }
    json_close(json, ']');
}

static void write_limit(json_writer *json, const char *name, double limit)
{
    if (isfinite(limit)) {
        json_number(json, name, limit);
    }
}

/** Name of the definition of numbers with this unit; it may also be the name of a block's variant. */
static char *quantity_name(const char *key_unit)
{
    char *name = xasprintf("quantity_%s", unit_kind_name(key_unit));
    for (char *c = name; *c != '\0'; c++) {
        *c = *c == ' ' ? '_' : *c;
    }
    return name;
}

void json_schema_reference(json_writer *json, const char *key, const char *block)
{
    CLEANUP_FREE char *name = xasprintf("#/$defs/%s", block);
    if (key != NULL) {
        json_open(json, key, '{');
    }
    json_text(json, "$ref", name);
    if (key != NULL) {
        json_close(json, '}');
    }
}

/** One number of a key. Ranges apply to numbers without a unit. */
static void write_number(json_writer *json, const evl_row *row)
{
    const bool is_whole = row->type == EVL_INTEGER;
    if (is_whole || unit_kind_name(row->unit) == NULL) {
        json_text(json, "type", is_whole ? "integer" : "number");
    } else {
        CLEANUP_FREE char *name = quantity_name(row->unit);
        json_schema_reference(json, NULL, name);
    }
    const bool is_free_below = is_whole && !isfinite(row->minimum), is_free_above = is_whole && !isfinite(row->maximum);
    write_limit(json, row->minimum_open ? "exclusiveMinimum" : "minimum", is_free_below ? -INT_MAX : row->minimum);
    write_limit(json, row->maximum_open ? "exclusiveMaximum" : "maximum", is_free_above ? INT_MAX : row->maximum);
}

/** A number, or one of the permitted words. */
static void write_number_or_word(json_writer *json, const evl_row *row)
{
    if (row->words[0] == '\0') {
        write_number(json, row);
        return;
    }
    json_open(json, "anyOf", '[');
    json_open(json, NULL, '{');
    write_number(json, row);
    json_close(json, '}');
    json_open(json, NULL, '{');
    write_words(json, "enum", row->words);
    json_close(json, '}');
    json_close(json, ']');
}

/** A list of `least` to `most` numbers; no upper limit if `most` is 0. */
static void write_numbers(json_writer *json, const evl_row *row, int least, int most)
{
    json_text(json, "type", "array");
    json_integer(json, "minItems", least);
    if (most > 0) {
        json_integer(json, "maxItems", most);
    }
    json_open(json, "items", '{');
    write_number(json, row);
    json_close(json, '}');
}

/** Blocks, in a list or by name, with the permitted number of elements. */
static void write_blocks(json_writer *json, const evl_row *row)
{
    const bool is_list = row->type == EVL_LIST;
    json_text(json, "type", is_list ? "array" : "object");
    json_integer(json, is_list ? "minItems" : "minProperties", (long)row->minimum);
    json_integer(json, is_list ? "maxItems" : "maxProperties", (long)row->maximum);
    if (is_list) {
        json_schema_reference(json, "items", row->holds);
        return;
    }
    json_open(json, "patternProperties", '{');
    json_schema_reference(json, NAME, row->holds);
    json_close(json, '}');
    json_truth(json, "additionalProperties", false);
}

/** Words without quotes: other readers take some of them for truth values, and some texts for numbers. */
static void write_text_types(json_writer *json, bool may_be_number)
{
    json_open(json, "type", '[');
    json_text(json, NULL, "string");
    json_text(json, NULL, "boolean");
    if (may_be_number) {
        json_text(json, NULL, "number");
    }
    json_close(json, ']');
}

static void write_names(json_writer *json, const evl_row *row)
{
    if (row->type == EVL_REFERENCES) {
        json_text(json, "type", "array");
        json_integer(json, "minItems", 2);
        json_integer(json, "maxItems", 2);
        json_open(json, "items", '{');
        write_text_types(json, false);
        json_close(json, '}');
        return;
    }
    write_text_types(json, row->type == EVL_TEXT);
    if (row->type == EVL_NAME) {
        json_text(json, "pattern", NAME);
        json_integer(json, "maxLength", NAME_BYTES);
    }
}

void json_schema_value(json_writer *json, const evl_row *row)
{
    switch (row->type) {
    case EVL_PAIR:
    case EVL_TRIPLE:
    case EVL_QUATERNION:
        write_numbers(json, row, row->type - EVL_PAIR + 2, row->type - EVL_PAIR + 2);
        break;
    case EVL_SERIES:
        write_numbers(json, row, 0, 0);
        break;
    case EVL_KNOTS:
    case EVL_AT_KNOTS:
        write_numbers(json, row, 2, 0);
        break;
    case EVL_NAMED:
        json_text(json, "type", "object");
        json_open(json, "additionalProperties", '{');
        write_number(json, row);
        json_close(json, '}');
        break;
    case EVL_CHOICE:
        write_words(json, "enum", row->words);
        break;
    case EVL_BLOCK:
        json_schema_reference(json, NULL, row->holds);
        break;
    case EVL_LIST:
    case EVL_MAP:
        write_blocks(json, row);
        break;
    case EVL_NUMBER:
    case EVL_INTEGER:
        write_number_or_word(json, row);
        break;
    default:
        write_names(json, row);
    }
}

/** Spellings of a unit as a regular expression: those that start with a digit require a preceding blank. */
static char *spellings_pattern(const char *key_unit, bool begin_with_digit)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    int n = 0, k = 0;
    const char **spellings = unit_spellings(key_unit, &arena, &n);
    for (int i = 0; i < n; i++) {
        const char *from = spellings[i];
        char *escaped = arena_calloc(&arena, 2 * strlen(from) + 1, 1), *to = escaped;
        for (; *from != '\0'; from++) {
            if (strchr("^$.*+?()[]{}|\\", *from) != NULL) {
                *to++ = '\\';
            }
            *to++ = *from;
        }
        if ((spellings[i][0] == '1') == begin_with_digit) {
            spellings[k++] = escaped;
        }
    }
    CLEANUP_FREE char *list = words_join(k, spellings, "|");
    return k == 0 ? xstrdup("") : xasprintf("%s(%s)", begin_with_digit ? "| +" : " *", list);
}

void json_schema_quantity(json_writer *json, const char *key_unit)
{
    CLEANUP_FREE char *name = quantity_name(key_unit), *usual = spellings_pattern(key_unit, false);
    CLEANUP_FREE char *fractions = spellings_pattern(key_unit, true);
    CLEANUP_FREE char *pattern = xasprintf("^" DECIMAL "(%s%s)$", usual, fractions);
    int n = 0;
    CLEANUP_FREE const char **units = unit_names(key_unit, NULL, &n);
    CLEANUP_FREE char *list = words_join(n, units, ", ");
    CLEANUP_FREE char *said = xasprintf("must be a number, also with a unit of %s: %s", unit_kind_name(key_unit), list);
    json_open(json, name, '{');
    json_open(json, "type", '[');
    json_text(json, NULL, "number");
    json_text(json, NULL, "string");
    json_close(json, ']');
    json_text(json, "pattern", pattern);
    json_text(json, "patternErrorMessage", said); /* editors show it in place of the pattern */
    json_close(json, '}');
}
