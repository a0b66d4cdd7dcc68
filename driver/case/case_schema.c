/* The table of all keys: those of case_keys.c and those of the laws, loads and supports. */
#include "case/case_schema.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/words.h"
#include "case/case_keys.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const family_blocks[LAWS_FAMILIES] = {
    [LAWS_CONTACT] = "contact", [LAWS_DAMPING] = "damping", [LAWS_FRICTION] = "friction"};
static const char *const family_texts[LAWS_FAMILIES] = {[LAWS_CONTACT] = "law of the normal elastic force",
                                                        [LAWS_DAMPING] = "law of the normal viscous force",
                                                        [LAWS_FRICTION] = "law of the tangential force"};

/** Keep a text as long as the schema. */
static const char *own(case_schema *schema, char *text)
{
    schema->owned = xrealloc(schema->owned, (size_t)schema->n_owned + 1, sizeof *schema->owned);
    schema->owned[schema->n_owned++] = text;
    return text;
}

static void add_key(case_schema *schema, case_key key)
{
    schema->keys = xrealloc(schema->keys, (size_t)schema->n + 1, sizeof *schema->keys);
    schema->keys[schema->n++] = key;
}

/** The default of a block's `law`: the one in the mesh's default {law: NAME} for the block. */
static const char *default_law(case_schema *schema, const char *block)
{
    const char *text = schema_find(schema, "mesh", "", block)->default_text;
    const char *name = strchr(text, ' ') + 1;
    return own(schema, xasprintf("%.*s", (int)strcspn(name, "}"), name));
}

static key_type type_of_shape(parameter_shape shape)
{
    static const key_type types[] = {[SHAPE_NUMBER] = KEY_NUMBER,
                                     [SHAPE_KNOTS] = KEY_SERIES,
                                     [SHAPE_AT_KNOTS] = KEY_SERIES,
                                     [SHAPE_PAIR] = KEY_PAIR};
    return types[shape];
}

static const char *default_of(case_schema *schema, const parameter_row *parameter)
{
    if (parameter->required || !isfinite(parameter->default_value)) {
        return NULL;
    }
    char number[NUMBER_TEXT_LENGTH];
    number_write(number, parameter->default_value);
    return own(schema, parameter->shape == SHAPE_PAIR ? xasprintf("[%s, %s]", number, number) : xstrdup(number));
}

static void add_parameter(case_schema *schema, const char *block, const char *kind, const parameter_row *parameter)
{
    add_key(schema, (case_key){.block = block,
                               .variants = kind,
                               .key = own(schema, xstrdup(parameter->name)),
                               .type = type_of_shape(parameter->shape),
                               .unit = strcmp(parameter->units, "1") == 0 ? "" : own(schema, xstrdup(parameter->units)),
                               .minimum = parameter->minimum,
                               .maximum = parameter->maximum,
                               .minimum_open = parameter->minimum_open,
                               .maximum_open = parameter->maximum_open,
                               .required = parameter->required,
                               .default_text = default_of(schema, parameter),
                               .words = "",
                               .holds = "",
                               .text = own(schema, xstrdup(parameter->text))});
}

/** The key of an earlier kind that means the same; NULL if there is none. */
static case_key *same_key(const case_schema *schema, const char *block, const parameter_row *parameter)
{
    for (int i = 0; i < schema->n; i++) {
        case_key *key = &schema->keys[i];
        if (strcmp(key->block, block) == 0 && strcmp(key->key, parameter->name) == 0 &&
            strcmp(key->text, parameter->text) == 0 && key->type == type_of_shape(parameter->shape) &&
            key->required == parameter->required) {
            return key;
        }
    }
    return NULL;
}

/** The parameters of all kinds of a block. Those of laws stay apart, each with its law. */
static void add_parameters(case_schema *schema, const char *block, int n, const kind_info *kinds, bool join)
{
    for (int i = 0; i < n; i++) {
        const char *name = own(schema, xstrdup(kinds[i].name));
        for (int k = 0; k < kinds[i].n_parameters; k++) {
            case_key *same = join ? same_key(schema, block, &kinds[i].parameters[k]) : NULL;
            if (same == NULL) {
                add_parameter(schema, block, name, &kinds[i].parameters[k]);
            } else {
                same->variants = own(schema, xasprintf("%s %s", same->variants, name));
            }
        }
    }
}

/** The names of all kinds, or what they are, in one text. */
static const char *join_kinds(case_schema *schema, int n, const kind_info *kinds, bool names, const char *separator)
{
    const char **words = xcalloc((size_t)n, sizeof *words);
    for (int i = 0; i < n; i++) {
        words[i] = names ? kinds[i].name : kinds[i].text;
    }
    char *text = words_join(n, words, separator);
    free(words);
    return own(schema, text);
}

static void add_laws(case_schema *schema, law_family family, const law_tables *laws)
{
    const char *block = family_blocks[family];
    const int n = laws->count[family];
    add_key(schema, (case_key){.block = block,
                               .variants = "",
                               .key = "law",
                               .type = KEY_CHOICE,
                               .unit = "",
                               .minimum = -HUGE_VAL,
                               .maximum = HUGE_VAL,
                               .default_text = default_law(schema, block),
                               .words = join_kinds(schema, n, laws->laws[family], true, " "),
                               .holds = "",
                               .text = family_texts[family]});
    add_parameters(schema, block, n, laws->laws[family], false);
}

/** A key of a block of kinds; behind the last of those that all kinds have stand those of each. */
static void add_kind_key(case_schema *schema, int n, const kind_info *kinds, const case_key *key, bool is_last)
{
    case_key copy = *key;
    if (strcmp(key->key, "kind") == 0) {
        copy.words = join_kinds(schema, n, kinds, true, " ");
        copy.text = join_kinds(schema, n, kinds, false, "; ");
    }
    add_key(schema, copy);
    if (is_last) {
        add_parameters(schema, key->block, n, kinds, true);
    }
}

case_schema *schema_create(const law_tables *laws)
{
    case_schema *schema = xcalloc(1, sizeof *schema);
    for (int i = 0; i < n_case_keys; i++) {
        const case_key *key = &case_keys[i];
        const bool is_last = i + 1 == n_case_keys || strcmp(case_keys[i + 1].block, key->block) != 0;
        if (strcmp(key->block, "load") == 0) {
            add_kind_key(schema, laws->n_loads, laws->loads, key, is_last);
        } else if (strcmp(key->block, "support") == 0) {
            add_kind_key(schema, laws->n_supports, laws->supports, key, is_last);
        } else {
            add_key(schema, *key);
        }
    }
    for (int family = 0; family < LAWS_FAMILIES; family++) {
        add_laws(schema, (law_family)family, laws);
    }
    return schema;
}

void schema_delete(case_schema **schema)
{
    if (*schema == NULL) {
        return;
    }
    for (int i = 0; i < (*schema)->n_owned; i++) {
        free((*schema)->owned[i]);
    }
    free((*schema)->owned);
    free((*schema)->keys);
    free(*schema);
    *schema = NULL;
}

const char *key_needs(const case_key *key)
{
    return key->variants[0] == '+' ? key->variants + 1 : NULL;
}

bool key_in_variant(const case_key *key, const char *variant)
{
    return key->variants[0] == '\0' || key_needs(key) != NULL || words_contain(key->variants, variant);
}

const case_key *schema_find(const case_schema *schema, const char *block, const char *variant, const char *key)
{
    for (int i = 0; i < schema->n; i++) {
        const case_key *row = &schema->keys[i];
        if (strcmp(row->block, block) == 0 && strcmp(row->key, key) == 0 && key_in_variant(row, variant)) {
            return row;
        }
    }
    return NULL;
}

void key_range_text(const case_key *key, char text[128])
{
    const bool is_bounded_below = isfinite(key->minimum), is_bounded_above = isfinite(key->maximum);
    const char *low = key->minimum_open ? "greater than" : "at least";
    const char *high = key->maximum_open ? "less than" : "at most";
    text[0] = '\0';
    if (is_bounded_below && is_bounded_above && !key->minimum_open && !key->maximum_open) {
        (void)snprintf(text, 128, "from %g to %g", key->minimum, key->maximum);
    } else if (is_bounded_below && is_bounded_above) {
        (void)snprintf(text, 128, "%s %g and %s %g", low, key->minimum, high, key->maximum);
    } else if (is_bounded_below) {
        (void)snprintf(text, 128, "%s %g", low, key->minimum);
    } else if (is_bounded_above) {
        (void)snprintf(text, 128, "%s %g", high, key->maximum);
    }
}
