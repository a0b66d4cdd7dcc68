/* The table of all keys: those of case_keys.c and those of the laws. */
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

static void add_law_parameter(case_schema *schema, const char *block, const char *law, const law_parameter *parameter)
{
    case_key key = {.block = block,
                    .variants = law,
                    .key = own(schema, xstrdup(parameter->name)),
                    .type = KEY_NUMBER,
                    .unit = strcmp(parameter->units, "1") == 0 ? "" : own(schema, xstrdup(parameter->units)),
                    .minimum = parameter->minimum,
                    .maximum = parameter->maximum,
                    .minimum_open = parameter->minimum_open,
                    .maximum_open = parameter->maximum_open,
                    .required = parameter->required,
                    .words = "",
                    .holds = "",
                    .text = own(schema, xstrdup(parameter->text))};
    if (!parameter->required && isfinite(parameter->default_value)) {
        char number[NUMBER_TEXT_LENGTH];
        number_write(number, parameter->default_value);
        key.default_text = own(schema, xstrdup(number));
    }
    /* the same parameter of several laws is one key only if it means the same in all of them: they stay apart */
    add_key(schema, key);
}

static void add_laws(case_schema *schema, law_family family, const law_tables *laws)
{
    const char *block = family_blocks[family];
    const int n = laws->count[family];
    const char **names = xcalloc((size_t)n, sizeof *names);
    for (int i = 0; i < n; i++) {
        names[i] = laws->laws[family][i].name;
    }
    char *words = words_join(n, names, " ");
    free(names);
    add_key(schema, (case_key){.block = block,
                               .variants = "",
                               .key = "law",
                               .type = KEY_CHOICE,
                               .unit = "",
                               .minimum = -HUGE_VAL,
                               .maximum = HUGE_VAL,
                               .default_text = default_law(schema, block),
                               .words = own(schema, words),
                               .holds = "",
                               .text = family_texts[family]});
    for (int i = 0; i < n; i++) {
        const law_info *law = &laws->laws[family][i];
        const char *name = own(schema, xstrdup(law->name));
        for (int k = 0; k < law->n_parameters; k++) {
            add_law_parameter(schema, block, name, &law->parameters[k]);
        }
    }
}

case_schema *schema_create(const law_tables *laws)
{
    case_schema *schema = xcalloc(1, sizeof *schema);
    for (int i = 0; i < n_case_keys; i++) {
        add_key(schema, case_keys[i]);
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
