/* Successive cases of one base. A case that differs from the previous one only in numbers is made from it in place: a
 * checked tree remains valid if each new number is one that its key allows. */
#include "case/case.h"

#include "base/memory.h"
#include "base/number.h"
#include "case/case_check.h"
#include "case/case_file.h"

#include <stdlib.h>
#include <string.h>

/* ---- locations of the numbers ---- */

static bool holds_numbers(int type)
{
    return type <= EVL_NAMED;
}

/** Follow the path of an option through a checked tree. Values of the simulation block depend on each other and are
 *  read as a whole; all other single numbers are independent. */
static case_number find_number(const case_schema *schema, case_node *root, const char *option)
{
    CLEANUP_FREE char *path = xasprintf("%.*s", (int)strcspn(option, "="), option);
    case_number number = {.node = NULL};
    number.row = row_at_path(schema, root, path, &number.node);
    const bool is_value = number.row != NULL && number.node != NULL && number.node->kind == NODE_SCALAR;
    const bool is_number = is_value && number.node->location.option == option && holds_numbers(number.row->type);
    const bool is_alone = is_number && (number.row->type == EVL_NUMBER || number.row->type == EVL_INTEGER) &&
                          strchr(path, '.') != NULL && strncmp(path, "simulation.", strlen("simulation.")) != 0;
    number.index = is_alone ? case_number_index(schema, root, number.node) : -1;
    return is_number ? number : (case_number){NULL, NULL, -1};
}

/** Record the nodes set by the options of a case, and reserve space for other numbers in them. */
static void find_numbers(const case_schema *schema, case_file *file)
{
    file->numbers = arena_calloc(&file->arena, (size_t)file->n_options, sizeof *file->numbers);
    for (int i = 0; i < file->n_options; i++) {
        case_number *number = &file->numbers[i];
        *number = find_number(schema, file->root, file->options[i]);
        if (number->node != NULL) {
            const size_t length = strlen(number->node->text);
            char *wider = arena_calloc(&file->arena, length + NUMBER_TEXT_LENGTH, 1);
            number->node->text = memcpy(wider, number->node->text, length);
        }
    }
}

/* ---- replacement of numbers ---- */

/** Text of the number in an option that differs from `option` only in that number; NULL if the options differ
 *  otherwise. */
static const char *other_number(const char *option, const char *other)
{
    const size_t path_length = strcspn(option, "=") + 1;
    double value = 0;
    if (strncmp(option, other, path_length) != 0) {
        return NULL;
    }
    const char *text = other + path_length;
    return strlen(text) < NUMBER_TEXT_LENGTH && number_read(text, &value) == NUMBER_FINITE ? text : NULL;
}

static bool differs_in_numbers_only(const case_file *file, int n_set, const char *const *set_options)
{
    bool good = file->n_options == n_set;
    for (int i = 0; i < n_set && good; i++) {
        good = file->numbers[i].node == NULL ? strcmp(file->options[i], set_options[i]) == 0
                                             : other_number(file->options[i], set_options[i]) != NULL;
    }
    return good;
}

/** @return false if a number, or their combination, is refused: a new case gives the better message, and the numbers in
 *          `file` are inconsistent */
static bool exchange_numbers(const case_base *base, case_file *file, const char *const *set_options)
{
    evl_error ignored = {.code = EVL_EXIT_OK};
    const checker checker = {.schema = base->schema, .path = file->path, .error = &ignored};
    for (int i = 0; i < file->n_options; i++) {
        const case_number *number = &file->numbers[i];
        if (number->node != NULL) {
            const char *text = other_number(file->options[i], set_options[i]);
            const size_t size = strlen(text) + 1;
            memcpy(file->options[i] + (text - set_options[i]), text, size);
            memcpy(number->node->text, text, size);
            number->node->plain = true;
            number->node->written = NULL;
        }
    }
    bool good = true, are_alone = true;
    for (int i = 0; i < file->n_options && good; i++) {
        const case_number *number = &file->numbers[i];
        good = number->node == NULL || check_number(&checker, number->row, number->node);
        are_alone = are_alone && (number->node == NULL || number->index >= 0);
    }
    for (int i = 0; i < file->n_options && good && are_alone; i++) {
        const case_number *number = &file->numbers[i];
        if (number->node != NULL) {
            file->description.numbers[number->index] = node_number(number->node);
        }
    }
    if (!good || are_alone) {
        file->description.simulation = file->as_read;
        return good;
    }
    description_clear(&file->description);
    good = good && case_file_check_format(file, &ignored) &&
           case_resolve(base->schema, file->path, file->root, &file->description, &ignored);
    if (good) {
        case_lay_out(base->schema, file->root, &file->description);
        file->as_read = file->description.simulation;
    }
    return good;
}

bool case_override(const case_base *base, int n_set, const char *const *set_options, case_file **file, evl_error *error)
{
    memset(error, 0, sizeof *error);
    if (*file != NULL && differs_in_numbers_only(*file, n_set, set_options) &&
        exchange_numbers(base, *file, set_options)) {
        return true;
    }
    case_file *made = case_file_create(base->name, n_set, set_options);
    made->root = node_copy(&made->arena, base->root);
    if (!case_file_resolve(made, base->schema, error)) {
        case_delete(&made);
        return false;
    }
    find_numbers(base->schema, made);
    case_lay_out(base->schema, made->root, &made->description); /* from here on the texts remain at their addresses */
    made->as_read = made->description.simulation;
    case_delete(file);
    *file = made;
    return true;
}
