/* Check of single values against their key: type, choice, lists of numbers; and the text of a refusal. */
#include "base/memory.h"
#include "base/number.h"
#include "base/suggest.h"
#include "base/utf8.h"
#include "base/words.h"
#include "case/case_check.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

checker checker_at(const checker *above, const char *step)
{
    checker inner = *above;
    inner.above = above;
    inner.step = step;
    inner.index = -1;
    return inner;
}

checker checker_at_element(const checker *above, const char *name, int index)
{
    checker inner = checker_at(above, name);
    inner.index = name == NULL ? index : -1;
    return inner;
}

size_t checker_label(const checker *checker, char label[LABEL_LENGTH])
{
    size_t length = checker->above == NULL ? 0 : checker_label(checker->above, label);
    const char *dot = length == 0 ? "" : ".";
    if (checker->step != NULL) {
        (void)snprintf(label + length, LABEL_LENGTH - length, "%s%s", dot, checker->step);
    } else if (checker->above != NULL) {
        (void)snprintf(label + length, LABEL_LENGTH - length, "%s%d", dot, checker->index);
    }
    return length + strlen(label + length);
}

bool checker_refuse(const checker *checker, case_location location, const char *format, ...)
{
    char message[EVL_ERROR_MESSAGE_LENGTH], where[EVL_ERROR_LOCATION_LENGTH], label[LABEL_LENGTH] = "";
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    location_text(checker->path, location, where);
    (void)checker_label(checker, label);
    return evl_error_set(checker->error, EVL_EXIT_CASE, where, "%s%s%s", label, label[0] == '\0' ? "" : ": ", message);
}

bool refuse_type(const checker *checker, const case_node *node, const char *expected, const char *unit)
{
    char found[64];
    node_describe(node, found);
    return checker_refuse(checker, node->location, "must be %s%s%s%s, not %s%s", expected, unit[0] == '\0' ? "" : " [",
                          unit, unit[0] == '\0' ? "" : "]", found,
                          node->kind == NODE_SCALAR && !node->plain ? ", which is text because of its quotes" : "");
}

static bool refuse_word(const checker *checker, const evl_row *key, const case_node *node)
{
    CLEANUP_FREE char **words = NULL;
    const int n = words_split(key->words, &words);
    CLEANUP_FREE char *hint = suggest_phrase(node->text, n, (const char *const *)words);
    CLEANUP_FREE char *list = words_join(n, (const char *const *)words, ", ");
    char found[64];
    node_describe(node, found);
    return key->type == EVL_NUMBER ? checker_refuse(checker, node->location, "must be a number [%s] or %s, not %s%s",
                                                    key->unit, list, found, hint)
                                   : checker_refuse(checker, node->location, "must be %s%s, not %s%s",
                                                    n > 1 ? "one of " : "", list, found, hint);
}

/** Check a list of `n` numbers; `expected` describes it. */
static bool check_components(const checker *checker, const evl_row *key, const case_node *node, int n,
                             const char *expected)
{
    if (node->kind != NODE_SEQUENCE) {
        return refuse_type(checker, node, expected, key->unit);
    }
    if (node->n != n) {
        return checker_refuse(checker, node->location, "has %d %s, must be %s", node->n,
                              node->n == 1 ? "value" : "values", expected);
    }
    bool good = true;
    for (int i = 0; i < n && good; i++) {
        good = check_number(checker, key, node->entries[i].value);
    }
    return good;
}

static bool check_numbers(const checker *checker, const evl_row *key, const case_node *node)
{
    const bool is_series = row_is_series(key);
    if (node->kind != (is_series ? NODE_SEQUENCE : NODE_MAPPING)) {
        return refuse_type(checker, node, is_series ? "a list of numbers" : "numbers by name, {name: number}",
                           key->unit);
    }
    for (int i = 0; i < node->n; i++) {
        const struct checker inner = checker_at_element(checker, is_series ? NULL : node->entries[i].key, i);
        if (!check_number(&inner, key, node->entries[i].value)) {
            return false;
        }
    }
    return true;
}

/** Quote text in the output that another YAML reader would take for a number, a truth value or null. */
static void quote_if_special(case_node *node)
{
    static const char *const words[] = {"true", "false", "yes", "no", "on", "off", "y", "n", NULL};
    double value = 0;
    bool is_special = node_is_null(node) || number_read(node->text, &value) != NUMBER_NONE;
    for (int i = 0; words[i] != NULL && !is_special; i++) {
        const char *nearest = suggest_nearest(node->text, 1, &words[i]);
        is_special = nearest != NULL && strlen(node->text) == strlen(nearest);
    }
    node->plain = node->plain && !is_special;
}

static bool check_text(const checker *checker, case_node *node)
{
    if (node->kind != NODE_SCALAR || node_is_null(node)) {
        return refuse_type(checker, node, "text", "");
    }
    quote_if_special(node);
    return true;
}

bool check_name(const checker *checker, case_location location, const char *name)
{
    double value = 0;
    if (name[0] == '\0') {
        return checker_refuse(checker, location, "the name is empty");
    }
    if (strlen(name) > NAME_BYTES) {
        return checker_refuse(checker, location, "the name is longer than %d bytes", NAME_BYTES);
    }
    if (number_read(name, &value) != NUMBER_NONE) {
        return checker_refuse(checker, location, "the name '%s' is a number; paths would take it for an index", name);
    }
    for (const char *c = name; *c != '\0'; c++) {
        if (strchr(".=/", *c) != NULL || (unsigned char)*c <= ' ' || *c == 0x7f) {
            return checker_refuse(checker, location,
                                  "the name '%s' contains '%c'; blanks, '.', '=' and '/' are not allowed", name,
                                  (unsigned char)*c < ' ' ? ' ' : *c);
        }
        if (utf8_is_control(c)) {
            return checker_refuse(checker, location,
                                  "the name '%s' contains an invisible character, such as the end of a line", name);
        }
    }
    return true;
}

bool check_choice(const checker *checker, const evl_row *key, const case_node *node)
{
    if (node->kind != NODE_SCALAR || node_is_null(node)) {
        return refuse_type(checker, node, "a word", "");
    }
    return words_contain(key->words, node->text) || refuse_word(checker, key, node);
}

static bool check_two_names(const checker *checker, case_node *node)
{
    if (node->kind != NODE_SEQUENCE || node->n != 2) {
        return refuse_type(checker, node, "two names [a, b]", "");
    }
    return check_text(checker, node->entries[0].value) && check_text(checker, node->entries[1].value);
}

bool check_single_value(const checker *checker, const evl_row *key, case_node *node)
{
    switch (key->type) {
    case EVL_NUMBER:
        if (key->words[0] != '\0' && node->kind == NODE_SCALAR && !node_is_null(node) &&
            !looks_like_number(key, node)) {
            return words_contain(key->words, node->text) || refuse_word(checker, key, node);
        }
        return check_number(checker, key, node);
    case EVL_INTEGER:
        return check_number(checker, key, node);
    case EVL_PAIR:
        return check_components(checker, key, node, 2, "a pair [x, y]");
    case EVL_TRIPLE:
        return check_components(checker, key, node, 3, "a vector [x, y, z]");
    case EVL_QUATERNION:
        return check_components(checker, key, node, 4, "a quaternion [w, x, y, z]");
    case EVL_SERIES:
    case EVL_KNOTS:
    case EVL_AT_KNOTS:
    case EVL_NAMED:
        return check_numbers(checker, key, node);
    case EVL_TEXT:
    case EVL_REFERENCE:
        return check_text(checker, node);
    case EVL_REFERENCES:
        return check_two_names(checker, node);
    case EVL_NAME:
        return check_text(checker, node) && check_name(checker, node->location, node->text);
    case EVL_CHOICE:
        return check_choice(checker, key, node);
    default:
        return checker_refuse(checker, node->location, "must be a single value");
    }
}
