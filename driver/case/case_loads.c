#include "case/case_loads.h"

#include "base/memory.h"

/** The lists `time` and `key` make a table. */
static bool check_table(checker *checker, const case_node *block, const char *key)
{
    const case_node *time = node_get(block, "time"), *values = node_get(block, key);
    if (time->n < 2) {
        (void)checker_enter(checker, "time");
        return checker_refuse(checker, time->place, "has %d %s, needs at least 2", time->n,
                              time->n == 1 ? "value" : "values");
    }
    if (values->n != time->n) {
        (void)checker_enter(checker, key);
        return checker_refuse(checker, values->place, "has %d values, but time has %d; they need the same number",
                              values->n, time->n);
    }
    for (int i = 1; i < time->n; i++) {
        const case_node *knot = time->entries[i].value, *before = time->entries[i - 1].value;
        if (node_number(knot) <= node_number(before)) {
            (void)checker_enter(checker, "time");
            return checker_refuse(checker, knot->place, "the times of a table must increase: %s s follows %s s",
                                  knot->text, before->text);
        }
    }
    return true;
}

static void take_series(const case_node *list, double *numbers)
{
    for (int i = 0; i < list->n; i++) {
        numbers[i] = node_number(list->entries[i].value);
    }
}

bool case_resolve_table(checker *checker, const case_node *block, const char *key, case_table *table)
{
    if (!check_table(checker, block, key)) {
        return false;
    }
    const case_node *time = node_get(block, "time");
    table->n = time->n;
    table->time = xcalloc((size_t)time->n, sizeof *table->time);
    table->values = xcalloc((size_t)time->n, sizeof *table->values);
    take_series(time, table->time);
    take_series(node_get(block, key), table->values);
    return true;
}

bool case_resolve_kind(checker *checker, const case_node *block, int n_kinds, const kind_info *kinds,
                       kind_choice *choice)
{
    while (choice->kind < n_kinds - 1 && !node_get_is(block, "kind", kinds[choice->kind].name)) {
        choice->kind++;
    }
    const kind_info *kind = &kinds[choice->kind];
    int n = 0;
    for (int i = 0; i < kind->n_parameters; i++) {
        const parameter_row *row = &kind->parameters[i];
        const case_node *node = node_get(block, row->name);
        choice->counts[i] = node == NULL ? 0 : row->shape == SHAPE_NUMBER ? 1 : node->n;
        n += choice->counts[i];
        if (row->shape == SHAPE_AT_KNOTS && node != NULL && node_get(block, "time") != NULL &&
            !check_table(checker, block, row->name)) {
            return false;
        }
    }
    choice->numbers = xcalloc((size_t)n, sizeof *choice->numbers);
    double *next = choice->numbers;
    for (int i = 0; i < kind->n_parameters; next += choice->counts[i], i++) {
        const case_node *node = node_get(block, kind->parameters[i].name);
        if (node != NULL && kind->parameters[i].shape == SHAPE_NUMBER) {
            *next = node_number(node);
        } else if (node != NULL) {
            take_series(node, next);
        }
    }
    return true;
}

bool case_resolve_loads(checker *checker, const case_node *list, const law_tables *laws, wheel_description *wheel)
{
    wheel->loads = xcalloc((size_t)list->n, sizeof *wheel->loads);
    wheel->n_loads = list->n;
    for (int i = 0; i < list->n; i++) {
        char step[32];
        (void)snprintf(step, sizeof step, "loads.%d", i);
        const size_t above = checker_enter(checker, step);
        const case_node *block = list->entries[i].value;
        wheel->loads[i].against_housing = node_get_is(block, "against", "housing");
        if (!case_resolve_kind(checker, block, laws->n_loads, laws->loads, &wheel->loads[i].choice)) {
            return false;
        }
        checker_leave(checker, above);
    }
    return true;
}
