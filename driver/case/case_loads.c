#include "case/case_loads.h"

#include "base/memory.h"

bool case_resolve_table(checker *checker, const case_node *block, const char *key, case_table *table)
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
    table->time = xcalloc((size_t)time->n, sizeof *table->time);
    table->values = xcalloc((size_t)time->n, sizeof *table->values);
    table->n = time->n;
    for (int i = 0; i < time->n; i++) {
        const case_node *knot = time->entries[i].value;
        table->time[i] = node_number(knot);
        table->values[i] = node_number(values->entries[i].value);
        if (i > 0 && table->time[i] <= table->time[i - 1]) {
            (void)checker_enter(checker, "time");
            return checker_refuse(checker, knot->place, "the times of a table must increase: %s s follows %s s",
                                  knot->text, time->entries[i - 1].value->text);
        }
    }
    return true;
}

static bool resolve_table(checker *checker, const case_node *block, const char *key, load_description *load)
{
    case_table table = {0};
    const bool good = case_resolve_table(checker, block, key, &table);
    load->n = table.n;
    load->time = table.time;
    load->values = table.values;
    return good;
}

/** A prescribed speed is one value, or a table of time and speed. */
static bool resolve_speed(checker *checker, const case_node *block, load_description *load)
{
    const bool has_value = node_get(block, "value") != NULL;
    const bool has_time = node_get(block, "time") != NULL, has_speed = node_get(block, "speed") != NULL;
    if (has_value && !has_time && !has_speed) {
        load->value = node_get_number(block, "value");
        return true;
    }
    if (!has_value && has_time && has_speed) {
        return resolve_table(checker, block, "speed", load);
    }
    return checker_refuse(checker, block->place, "a prescribed speed needs either 'value' or both 'time' and 'speed'");
}

static bool resolve_load(checker *checker, const case_node *block, load_description *load)
{
    static const char *const kinds[] = {
        [LOAD_TORQUE] = "torque", [LOAD_VISCOUS] = "viscous", [LOAD_TABLE] = "table", [LOAD_SPEED] = "speed"};
    load->against_housing = node_get_is(block, "against", "housing");
    load->kind = (load_kind)node_get_choice(block, "kind", 4, kinds);
    switch (load->kind) {
    case LOAD_TORQUE:
        load->value = node_get_number(block, "value");
        return true;
    case LOAD_VISCOUS:
        load->value = node_get_number(block, "coefficient");
        return true;
    case LOAD_TABLE:
        return resolve_table(checker, block, "torque", load);
    case LOAD_SPEED:
        return resolve_speed(checker, block, load);
    }
    return false;
}

bool case_resolve_loads(checker *checker, const case_node *list, wheel_description *wheel)
{
    wheel->loads = xcalloc((size_t)list->n, sizeof *wheel->loads);
    wheel->n_loads = list->n;
    int n_speeds = 0;
    for (int i = 0; i < list->n; i++) {
        char step[32];
        (void)snprintf(step, sizeof step, "loads.%d", i);
        const size_t above = checker_enter(checker, step);
        const case_node *block = list->entries[i].value;
        if (!resolve_load(checker, block, &wheel->loads[i])) {
            return false;
        }
        n_speeds += wheel->loads[i].kind == LOAD_SPEED ? 1 : 0;
        if (n_speeds > 1) {
            return checker_refuse(checker, block->place,
                                  "a second prescribed speed for one wheel; it can have only one");
        }
        checker_leave(checker, above);
    }
    return true;
}
