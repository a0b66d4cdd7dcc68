#include "case/case_names.h"

#include "base/memory.h"
#include "base/suggest.h"
#include "base/words.h"

#include <stdlib.h>
#include <string.h>

const char **case_names(const case_node *node)
{
    const char **names = xcalloc((size_t)node->n, sizeof *names);
    for (int i = 0; i < node->n; i++) {
        names[i] = node->kind == NODE_MAPPING ? node->entries[i].key : node_get_text(node->entries[i].value, "name");
    }
    return names;
}

int case_name_index(const char *name, int n, const char *const *names)
{
    for (int i = 0; i < n; i++) {
        if (strcmp(names[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

bool case_find_name(checker *checker, const case_node *node, const char *key, const char *what, const case_node *among,
                    int *index)
{
    const char **names = case_names(among);
    *index = case_name_index(node->text, among->n, names);
    if (*index < 0) {
        char *hint = suggest_phrase(node->text, among->n, names);
        char *list = words_join(among->n, names, ", ");
        (void)checker_enter(checker, key);
        (void)checker_refuse(checker, node->place, "there is no %s '%.64s'%s; the case has %s", what, node->text, hint,
                             list);
        free(list);
        free(hint);
    }
    free(names);
    return *index >= 0;
}

bool case_find_reference(checker *checker, const case_node *block, const char *key, const char *what,
                         const case_node *among, int *index)
{
    return case_find_name(checker, node_get(block, key), key, what, among, index);
}

bool case_check_unique(checker *checker, const case_node *list, const char *what, const char *plural)
{
    const char **names = case_names(list);
    bool good = true;
    for (int i = 1; i < list->n && good; i++) {
        if (case_name_index(names[i], i, names) >= 0) {
            const case_node *node = node_get(list->entries[i].value, "name");
            good = checker_refuse(checker, node->place, "%s: the name '%s' is given to two %s; give each %s its own",
                                  plural, names[i], plural, what);
        }
    }
    free(names);
    return good;
}
