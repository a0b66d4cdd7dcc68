#include "respond/value_range.h"

#include "base/memory.h"
#include "base/number.h"
#include "base/suggest.h"

#include <math.h>
#include <string.h>

static const char HOW[] = "it must be PATH=FROM:TO[:STEPS], a parameter of the case, two values of it, and the number "
                          "of values from 2 to 100000, such as 'wheels.pinion.loads.0.value=-500 rpm:-12000 rpm:116'";

static bool refuse(const char *text, const char *why, evl_error *error)
{
    CLEANUP_FREE char *location = xasprintf("--over %s", text);
    return evl_error_set(error, EVL_EXIT_USAGE, location, "%s", why);
}

static bool read_steps(const char *text, int *n)
{
    double value = RANGE_USUAL_STEPS;
    const bool good = text == NULL || (number_read(text, &value) == NUMBER_FINITE && value >= 2 &&
                                       value <= RANGE_MOST_STEPS && value == floor(value));
    *n = good ? (int)value : 0;
    return good;
}

/** Read a value in the unit of its key. */
static bool read_value(value_range *range, const char *value, const char *text, const case_base *base, double *number,
                       evl_error *error)
{
    CLEANUP_FREE char *option = xasprintf("%s=%s", range->path, value);
    case_quantity quantity;
    if (!case_base_convert(base, option, &quantity, error)) {
        CLEANUP_FREE char *location = xasprintf("--over %s", text), *why = xstrdup(error->message);
        return evl_error_set(error, error->code, location, "%s", why);
    }
    if (!quantity.is_number || !isfinite(quantity.value)) {
        return refuse(text, HOW, error);
    }
    *number = quantity.value;
    if (range->unit == NULL) {
        range->unit = xstrdup(quantity.unit);
    }
    return true;
}

bool value_range_read(value_range *range, const char *text, const case_base *base, evl_error *error)
{
    *range = (value_range){.n = 0};
    CLEANUP_FREE char *copy = xstrdup(text);
    char *equals = strchr(copy, '=');
    char *first = equals == NULL ? NULL : equals + 1, *second = first == NULL ? NULL : strchr(first, ':');
    if (second == NULL || equals == copy) {
        return refuse(text, HOW, error);
    }
    *equals = '\0';
    *second++ = '\0';
    char *steps = strchr(second, ':');
    if (steps != NULL) {
        *steps++ = '\0';
    }
    if (!read_steps(steps, &range->n)) {
        return refuse(text, HOW, error);
    }
    range->is_counted = steps != NULL;
    range->path = xstrdup(copy);
    if (!read_value(range, first, text, base, &range->from, error) ||
        !read_value(range, second, text, base, &range->to, error)) {
        return false;
    }
    return range->from != range->to || refuse(text, "both ends are the same value; give a range", error);
}

/** Whether a parameter of the case can be varied continuously. */
static bool check(const evl_parameter *parameter, evl_error *error)
{
    static const char simulation[] = "simulation.";
    if (model_schema()->rows[parameter->row].type == EVL_INTEGER) {
        return refuse(parameter->path,
                      "a whole number changes the structure of the gearbox, so the motion cannot be transferred "
                      "between values; use a sweep",
                      error);
    }
    if (strncmp(parameter->path, simulation, sizeof simulation - 1) == 0) {
        return refuse(parameter->path, "it is a setting of the simulation, not a parameter of the gearbox", error);
    }
    return parameter->n == 1 || refuse(parameter->path, "a list of numbers is not a parameter with one value", error);
}

bool value_range_check(const value_range *range, const model *model, bool is_there, evl_error *error)
{
    evl_parameter parameter;
    ARENA_SCOPE memory_arena arena = {NULL};
    const char **paths = NULL;
    int n = 0;
    for (double *numbers = NULL; (numbers = model_parameter_at(model, n, &parameter)) != NULL; n++) {
        free(numbers);
        if (strcmp(parameter.path, range->path) == 0) {
            return check(&parameter, error);
        }
        paths = arena_grow(&arena, paths, (size_t)n, (size_t)n + 1, sizeof *paths);
        paths[n] = arena_copy(&arena, parameter.path);
    }
    if (!is_there) {
        return true;
    }
    CLEANUP_FREE char *meant = suggest_phrase(range->path, n, paths);
    CLEANUP_FREE char *why =
        xasprintf("it is not a parameter of the gearbox%s; 'evolvent show --parameters' lists them", meant);
    return refuse(range->path, why, error);
}

double value_range_at(const value_range *range, int index)
{
    return index == range->n - 1 ? range->to : range->from + (range->to - range->from) * index / (range->n - 1);
}

char *value_range_option(const value_range *range, double value)
{
    char number[NUMBER_TEXT_LENGTH];
    number_write(number, value);
    return xasprintf("%s=%s", range->path, number);
}

void value_range_free(value_range *range)
{
    free(range->path);
    free(range->unit);
    *range = (value_range){.n = 0};
}
