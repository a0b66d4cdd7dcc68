#include "case_entries_at.h"

#include "base/memory.h"
#include "model/model.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/** Index of the entry of a segment among those of a level that follow entry `above`; -1 if there is none. */
static int step(const description *description, int above, int level, const char *key, const char *element)
{
    int count = 0;
    for (int i = above + 1; i < description->n_entries && description->entries[i].level >= level; i++) {
        const evl_entry *entry = &description->entries[i];
        if (entry->level != level || strcmp(model_schema()->rows[entry->row].key, key) != 0) {
            continue;
        }
        if (element == NULL || (entry->name != NULL && strcmp(entry->name, element) == 0) ||
            (strspn(element, "0123456789") == strlen(element) && atoi(element) == count)) {
            return i;
        }
        count++;
    }
    return -1;
}

const evl_entry *entry_at(const case_file *file, const char *path)
{
    const description *description = case_description(file);
    char *copy = xstrdup(path), *rest = NULL;
    int i = -1, level = 1;
    for (char *key = strtok_r(copy, ".", &rest); key != NULL; key = strtok_r(NULL, ".", &rest), level++) {
        const int first = step(description, i, level, key, NULL);
        const int type = first < 0 ? EVL_NUMBER : model_schema()->rows[description->entries[first].row].type;
        const bool has_elements = type == EVL_LIST || type == EVL_MAP || type == EVL_NAMED;
        i = first < 0 ? -1 : step(description, i, level, key, has_elements ? strtok_r(NULL, ".", &rest) : NULL);
        if (i < 0) {
            break;
        }
    }
    free(copy);
    return i < 0 ? NULL : &description->entries[i];
}

double number_at(const case_file *file, const char *path)
{
    const evl_entry *entry = entry_at(file, path);
    return entry == NULL || entry->n == 0 ? NAN : entry->numbers[0];
}

const char *word_at(const case_file *file, const char *path)
{
    const evl_entry *entry = entry_at(file, path);
    return entry == NULL || entry->name == NULL ? "" : entry->name;
}

void assert_same_entries(const case_file *one, const case_file *other)
{
    const description *a = case_description(one), *b = case_description(other);
    assert_int_equal(a->n_entries, b->n_entries);
    for (int i = 0; i < a->n_entries; i++) {
        const evl_entry *x = &a->entries[i], *y = &b->entries[i];
        assert_int_equal(x->row, y->row);
        assert_int_equal(x->level, y->level);
        assert_string_equal(x->name == NULL ? "" : x->name, y->name == NULL ? "" : y->name);
        assert_int_equal(x->n, y->n);
        for (int k = 0; k < x->n; k++) {
            assert_true(x->numbers[k] == y->numbers[k]);
        }
    }
}
