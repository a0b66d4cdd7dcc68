/* Check of numbers against their key: unit, finite value, range, integer. */
#include "base/memory.h"
#include "base/words.h"
#include "case/case_check.h"
#include "case/unit.h"

#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <string.h>

static bool is_in_range(const evl_row *key, double value)
{
    return (key->minimum_open ? value > key->minimum : value >= key->minimum) &&
           (key->maximum_open ? value < key->maximum : value <= key->maximum);
}

/** Read a scalar as a number of the key. A quoted number is text; a quoted number with a unit is accepted, since YAML
 *  reads it as text anyway. */
static quantity_kind read_node(const evl_row *key, const case_node *node, double *value, const char **unit)
{
    if (node->kind != NODE_SCALAR) {
        return QUANTITY_NONE;
    }
    const quantity_kind kind = quantity_read(node->text, key->type == EVL_INTEGER ? NULL : key->unit, value, unit);
    return kind == QUANTITY_NUMBER && !node->plain ? QUANTITY_NONE : kind;
}

bool looks_like_number(const evl_row *key, const case_node *node)
{
    double value = 0;
    const char *unit = NULL;
    return read_node(key, node, &value, &unit) != QUANTITY_NONE;
}

static bool refuse_unit(const checker *checker, const evl_row *key, const case_node *node, const char *unit)
{
    CLEANUP_FREE char *why = unit_refusal(key->unit, unit);
    return checker_refuse(checker, node->location, "is %.*s, but %s", words_cut(node->text, 64), node->text, why);
}

static bool refuse_range(const checker *checker, const evl_row *key, const case_node *node)
{
    char range[128];
    row_range_text(key, range);
    CLEANUP_FREE char *found = node_quantity(node, key->unit);
    return checker_refuse(checker, node->location, "is %s, must be %s%s%s%s", found,
                          key->type == EVL_INTEGER ? "a whole number " : "", range, key->unit[0] == '\0' ? "" : " ",
                          key->unit);
}

static bool refuse_fraction(const checker *checker, const evl_row *key, const case_node *node)
{
    char range[128];
    row_range_text(key, range);
    return checker_refuse(checker, node->location, "is %s, must be a whole number%s%s", node->text,
                          range[0] == '\0' ? "" : " ", range);
}

static bool refuse_text(const checker *checker, const evl_row *key, const case_node *node)
{
    const char *expected = key->type == EVL_INTEGER ? "a whole number" : "a number";
    const char *comma = node->kind == NODE_SCALAR ? strchr(node->text, ',') : NULL;
    const bool is_decimal = comma != NULL && comma > node->text && isdigit((unsigned char)comma[-1]) &&
                            isdigit((unsigned char)comma[1]) && key->type != EVL_INTEGER;
    return refuse_type(checker, node, is_decimal ? "a number with a decimal point, no comma" : expected, key->unit);
}

bool check_number(const checker *checker, const evl_row *key, case_node *node)
{
    double value = 0;
    const char *unit = NULL;
    switch (read_node(key, node, &value, &unit)) {
    case QUANTITY_NONE:
        return refuse_text(checker, key, node);
    case QUANTITY_NOT_FINITE:
        return checker_refuse(checker, node->location, "is %s, which is not a finite number", node->text);
    case QUANTITY_OTHER_UNIT:
        return refuse_unit(checker, key, node, unit);
    case QUANTITY_CONVERTED:
        node_convert(node, value);
        break;
    default:
        break;
    }
    if (!is_in_range(key, value)) {
        return refuse_range(checker, key, node);
    }
    const bool is_good = key->type != EVL_INTEGER || (value == floor(value) && fabs(value) <= INT_MAX);
    return is_good || refuse_fraction(checker, key, node);
}
