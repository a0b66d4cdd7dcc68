/* Case after case of one base, each made from the one before, beside the same case made from nothing: every key of every block of
 * the examples, and of every variant of these blocks, with good values and bad ones. What to try follows from the table of rows, so
 * that a new key is tried too. */
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/memory.h"
#include "base/number.h"
#include "base/words.h"
#include "case/case.h"
#include "case/case_tree.h"
#include "case_entries_at.h"
#include "simulate/case_start.h"
#include "wheel_stand_in.h"

enum { MOST_OPTIONS = 6, MOST_ROWS = 512, MOST_VALUES = 32 };

/* A sanitizer makes a case ten times as slow: there each key has a third of the values, another third than its neighbours. The build
 * without compares all. */
#ifdef __SANITIZE_ADDRESS__
enum { EVERY = 3 };
#else
enum { EVERY = 1 };
#endif

/* ---- a base and what was tried of it ---- */

typedef struct {
    case_base *base;
    case_plan kept; /* goes from case to case */
    evl_wheel_store wheels;
    bool varies;         /* blocks are tried in all their variants */
    int n_start;         /* options that the base begins with */
    bool *tried;         /* [rows] in some case that is good, of all bases */
    int n_cases, n_good; /* of all bases */
    int n_in_place;
} trial;

static void assert_same_text(const char *what, const char *options, const char *one, const char *other)
{
    if (strcmp(one, other) != 0) {
        fail_msg("%s: %s is\n%s\nand, made from nothing,\n%s", options, what, one, other);
    }
}

static uint64_t bits_of(double number)
{
    uint64_t bits = 0;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static void assert_same_bits(const char *what, const char *options, int n, const double *one, const double *other)
{
    for (int i = 0; i < n; i++) {
        if (bits_of(one[i]) != bits_of(other[i])) {
            fail_msg("%s: number %d of %s is %.17g, and %.17g made from nothing", options, i, what, one[i], other[i]);
        }
    }
}

/** All values at the start, and all that were given. */
static void assert_same_models(const char *options, const case_plan *one, const case_plan *other)
{
    evl_error error, other_error;
    dae_state state, other_state;
    evl_parameter parameter, other_parameter;
    ARENA_SCOPE memory_arena arena = {NULL};
    const int n = model_about(other->model)->n_values;
    double *values = arena_calloc(&arena, (size_t)n, sizeof *values);
    double *other_values = arena_calloc(&arena, (size_t)n, sizeof *values);
    assert_int_equal(model_about(one->model)->n_values, n);
    double *given = NULL;
    for (int i = 0; (given = model_parameter_at(other->model, i, &other_parameter)) != NULL; i++) {
        double *own = model_parameter_at(one->model, i, &parameter);
        assert_non_null(own);
        assert_string_equal(parameter.path, other_parameter.path);
        assert_same_bits(parameter.path, options, parameter.n, own, given);
        free(own);
        free(given);
    }
    model_constants(one->model, values);
    model_constants(other->model, other_values);
    assert_same_bits("constants", options, n, values, other_values);
    const bool starts = case_start(other, NULL, &other_state, NULL, &other_error);
    assert_int_equal(case_start(one, NULL, &state, NULL, &error), starts);
    if (!starts) {
        assert_same_text("the refused start", options, error.message, other_error.message);
        assert_same_text("its place", options, error.location, other_error.location);
        return;
    }
    char message[DAE_MESSAGE_LENGTH];
    assert_same_bits("start", options, model_about(one->model)->dae.n, state.y, other_state.y);
    assert_int_equal(model_outputs(one->model, &state, values, message),
                     model_outputs(other->model, &other_state, other_values, message));
    assert_same_bits("outputs", options, n, values, other_values);
    dae_state_free(&state);
    dae_state_free(&other_state);
}

static void assert_same_simulation(const char *options, const simulation_description *a,
                                   const simulation_description *b)
{
    const double one[] = {a->duration,       a->output_interval, a->tolerance,    a->accuracy,
                          a->max_step,       a->metrics.from,    a->metrics.to,   a->output_by.number,
                          a->output_by.mesh, a->output_by.wheel, a->metrics.mesh, a->metrics.wheel,
                          a->integrator,     a->initial.kind,    a->most_steps};
    const double other[] = {b->duration,       b->output_interval, b->tolerance,    b->accuracy,
                            b->max_step,       b->metrics.from,    b->metrics.to,   b->output_by.number,
                            b->output_by.mesh, b->output_by.wheel, b->metrics.mesh, b->metrics.wheel,
                            b->integrator,     b->initial.kind,    b->most_steps};
    assert_same_bits("simulation", options, sizeof one / sizeof *one, one, other);
}

/** Make a case from the one before, and from nothing. @return whether it is good */
static bool try_case(trial *trial, int n, const char *const *options)
{
    CLEANUP_FREE char *label = words_join(n, options, ", ");
    evl_error error, other_error;
    case_plan anew = {0};
    const case_file *before = trial->kept.file;
    const bool good = case_plan_make(
        &anew, &(plan_request){.base = trial->base, .n_set = n, .set = options, .wheels = &trial->wheels},
        &other_error);
    if (case_plan_make(&trial->kept,
                       &(plan_request){.base = trial->base, .n_set = n, .set = options, .wheels = &trial->wheels},
                       &error) != good) {
        fail_msg("%s: is %s, but made from nothing %s: %s", label, good ? "refused" : "good", good ? "good" : "refused",
                 good ? error.message : other_error.message);
    }
    if (good) {
        CLEANUP_FREE char *text = tree_text(case_root(trial->kept.file)), *other = tree_text(case_root(anew.file));
        CLEANUP_FREE char *warnings = case_plan_warnings(&trial->kept, NULL, "; "),
                          *other_warnings = case_plan_warnings(&anew, NULL, "; ");
        assert_same_text("the tree", label, text, other);
        assert_same_text("the warnings", label, warnings, other_warnings);
        assert_same_entries(trial->kept.file, anew.file);
        assert_same_simulation(label, &trial->kept.description->simulation, &anew.description->simulation);
        assert_same_models(label, &trial->kept, &anew);
        trial->n_good++;
        trial->n_in_place += trial->kept.file == before;
    } else {
        assert_same_text("the message", label, error.message, other_error.message);
        assert_same_text("the place", label, error.location, other_error.location);
        assert_int_equal(error.code, other_error.code);
    }
    trial->n_cases++;
    case_plan_free(&anew);
    return good;
}

/* ---- values of a row ---- */

static const char *text_of(memory_arena *arena, double value)
{
    char text[NUMBER_TEXT_LENGTH];
    number_write(text, value);
    return arena_copy(arena, text);
}

/** A number that the row accepts. */
static double sample_of(const evl_row *row)
{
    const double low = row->minimum, high = row->maximum;
    const double middle = isfinite(low) && isfinite(high) ? (low + high) / 2 : isfinite(low) ? low + 1 : 1;
    return row->type == EVL_INTEGER ? ceil(middle) : middle;
}

/** Values for a single number of the row: near `value`, at the ends of the range and beyond, and what is none. */
static int values_of(const evl_row *row, double value, memory_arena *arena, const char *values[MOST_VALUES])
{
    const double numbers[] = {
        value * (1 + 1e-4), value + 1,       -value, 0, 1.5, 1e300, -1e300, row->minimum, row->minimum - 1, 1e-9,
        row->maximum,       row->maximum + 1};
    static const char *const others[] = {".nan", "much", "[1, 2]", "{a: 1}", "'1'", "", "1 kg", "0.5 mm", "none"};
    int n = 0;
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        values[n++] = text_of(arena, numbers[i]);
    }
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        values[n++] = others[i];
    }
    char **words = NULL;
    const int n_words = words_split(row->words, &words);
    for (int i = 0; i < n_words && n < MOST_VALUES; i++) {
        values[n++] = arena_copy(arena, words[i]);
    }
    free(words);
    return n;
}

/* ---- keys ---- */

/** Options that go before, so that a case has the block. */
typedef struct {
    int n;
    const char *options[MOST_OPTIONS];
} prefix;

static prefix prefix_and(const prefix *first, const char *option)
{
    prefix longer = *first;
    assert_true(longer.n < MOST_OPTIONS - 2);
    longer.options[longer.n++] = option;
    return longer;
}

/** Try a place that takes one number, or a word: from one good case to each of the values, beside another number that goes to and fro. */
static void try_values(trial *trial, const prefix *before, const char *path, const evl_row *row, double start)
{
    static const char *const other[] = {"simulation.duration=3", "simulation.duration=4"};
    ARENA_SCOPE memory_arena arena = {NULL};
    const char *values[MOST_VALUES];
    const int n = values_of(row, start, &arena, values);
    const bool has_other = strncmp(path, "simulation", strlen("simulation")) != 0;
    const char *good = arena_printf(&arena, "%s=%s", path, text_of(&arena, start));
    const int index = (int)(row - model_schema()->rows);
    for (int i = -1; i < n; i++) {
        if (i >= 0 && (i + index) % EVERY != 0) {
            continue;
        }
        prefix options = prefix_and(before, good);
        options.options[options.n] = other[0];
        const bool is_good = try_case(trial, options.n + has_other, options.options);
        assert_true(is_good || i < 0);
        if (!is_good) {
            return;
        }
        if (i >= 0) {
            options.options[options.n - 1] = arena_printf(&arena, "%s=%s", path, values[i]);
            options.options[options.n] = other[i % 2];
            (void)try_case(trial, options.n + has_other, options.options);
        }
    }
    trial->tried[index] = true;
}

/** Several numbers of a row, [1, 2, 3]: those of a node that has some, else others that increase, as knots do. */
static const char *list_of(const evl_row *row, const case_node *node, memory_arena *arena, int *n)
{
    const int counts[] = {[EVL_PAIR] = 2, [EVL_TRIPLE] = 3, [EVL_QUATERNION] = 4};
    const bool is_given = node != NULL && node->n > 1;
    *n = is_given ? node->n : row->type <= EVL_QUATERNION ? counts[row->type] : 2;
    const char *list = "[";
    for (int i = 0; i < *n; i++) {
        const double number = is_given ? node_number(node->entries[i].value) : sample_of(row) + 0.25 * i;
        list = arena_printf(arena, "%s%s%s", list, i == 0 ? "" : ", ", text_of(arena, number));
    }
    return arena_printf(arena, "%s]", list);
}

static void try_key(trial *trial, const prefix *before, const char *path, const evl_row *row, const case_node *node)
{
    ARENA_SCOPE memory_arena arena = {NULL};
    if (trial->tried[row - model_schema()->rows] || row->type > EVL_NAMED) {
        return;
    }
    if (row->type <= EVL_INTEGER) {
        try_values(trial, before, path, row, node != NULL && node_is_number(node) ? node_number(node) : sample_of(row));
    } else if (row->type == EVL_NAMED && node != NULL && node->n > 0) {
        const case_entry *last = &node->entries[node->n - 1];
        try_values(trial, before, arena_printf(&arena, "%s.%s", path, last->key), row, node_number(last->value));
    } else if (row->type != EVL_NAMED) {
        int n = 0;
        const char *list = list_of(row, node, &arena, &n);
        const prefix whole = prefix_and(before, arena_printf(&arena, "%s=%s", path, list));
        const char *last = strrchr(list, ' ') + 1;
        try_values(trial, &whole, arena_printf(&arena, "%s.%d", path, n - 1), row, strtod(last, NULL));
    }
}

/* ---- blocks ---- */

static void try_block(trial *trial, const prefix *before, const char *path, const char *block, const case_node *node);

/** A value that a key takes: of a number or several, a word, a name; "" of what has no such. */
static const char *value_of(const evl_row *row, memory_arena *arena)
{
    int n = 0;
    return row->type <= EVL_INTEGER  ? text_of(arena, sample_of(row))
           : row->type < EVL_NAMED   ? list_of(row, NULL, arena, &n)
           : row->type == EVL_NAME   ? "made"
           : row->type == EVL_CHOICE ? arena_printf(arena, "%.*s", (int)strcspn(row->words, " "), row->words)
                                     : "";
}

/** A block as an option, with what it requires, each value good by itself. @param word  of its variant, NULL: it has none */
static const char *block_option(const char *path, const char *block, const char *word, memory_arena *arena)
{
    const evl_row *selector = schema_selector(model_schema(), block);
    const char *text = arena_printf(arena, "%s={", path), *comma = "";
    int n = 0;
    const evl_row *rows = schema_block(model_schema(), block, &n);
    for (int i = 0; i < n; i++) {
        const evl_row *row = &rows[i];
        const bool is_required = row->required && row_in_variant(row, word == NULL ? "" : word);
        const char *value = row == selector ? word : is_required ? value_of(row, arena) : "";
        if (value != NULL && value[0] != '\0') {
            text = arena_printf(arena, "%s%s%s: %s", text, comma, row->key, value);
            comma = ", ";
        }
    }
    return arena_printf(arena, "%s}", text);
}

/** Try a block that an option makes, if that is good. */
static void try_made(trial *trial, const prefix *before, const char *option, const char *path, const char *block)
{
    const prefix options = prefix_and(before, option);
    evl_error error;
    case_plan made = {0};
    (void)try_case(trial, options.n, options.options);
    if (case_plan_make(
            &made,
            &(plan_request){.base = trial->base, .n_set = options.n, .set = options.options, .wheels = &trial->wheels},
            &error)) {
        const case_node *node = case_root(made.file);
        char *copy = xstrdup(path), *rest = NULL;
        for (char *step = strtok_r(copy, ".", &rest); step != NULL; step = strtok_r(NULL, ".", &rest)) {
            node = node->entries[node_step(node, step)].value;
        }
        free(copy);
        try_block(trial, &options, path, block, node);
    }
    case_plan_free(&made);
}

/** A block in each of its variants, whatever it is in the base. */
static void try_variants(trial *trial, const prefix *before, const char *path, const char *block, bool is_given)
{
    const evl_row *selector = schema_selector(model_schema(), block);
    char **words = NULL;
    const int n = selector == NULL ? 0 : words_split(selector->words, &words);
    ARENA_SCOPE memory_arena arena = {NULL};
    for (int i = 0; i < n; i++) {
        try_made(trial, before, block_option(path, block, words[i], &arena), path, block);
    }
    if (selector == NULL && !is_given) {
        try_made(trial, before, block_option(path, block, NULL, &arena), path, block);
    }
    free(words);
}

/** What stands in a block as a block, a list or a map. */
static void try_inner(trial *trial, const prefix *before, const char *path, const evl_row *row, const case_node *value)
{
    const bool varies = trial->varies && before->n - trial->n_start < 2; /* deep enough for all that there is */
    if (row->type == EVL_BLOCK) {
        if (value != NULL) {
            try_block(trial, before, path, row->holds, value);
        }
        if (varies) {
            try_variants(trial, before, path, row->holds, value != NULL);
        }
        return;
    }
    const int n = value == NULL ? 0 : value->n;
    ARENA_SCOPE memory_arena arena = {NULL};
    for (int k = 0; k < n; k++) {
        const char *key = value->entries[k].key;
        try_block(trial, before, arena_printf(&arena, "%s.%s", path, key == NULL ? arena_printf(&arena, "%d", k) : key),
                  row->holds, value->entries[k].value);
    }
    if (varies && row->type == EVL_LIST) {
        try_variants(trial, before, arena_printf(&arena, "%s.0", path), row->holds, n > 0);
    }
}

/** @param node  the block, checked */
static void try_block(trial *trial, const prefix *before, const char *path, const char *block, const case_node *node)
{
    int n = 0;
    const evl_row *rows = schema_block(model_schema(), block, &n);
    for (int i = 0; i < n; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        const case_node *value = node_get(node, rows[i].key);
        const char *inner = arena_printf(&arena, "%s%s%s", path, path[0] == '\0' ? "" : ".", rows[i].key);
        try_key(trial, before, inner, &rows[i], value);
        if (rows[i].type >= EVL_BLOCK) {
            try_inner(trial, before, inner, &rows[i], value);
        }
    }
}

/** @param option  that the base begins with; NULL: none */
static void try_example(trial *trial, const char *path, const char *option, bool varies)
{
    evl_error error;
    const prefix start = {.n = option == NULL ? 0 : 1, .options = {option}};
    trial->varies = varies;
    trial->n_start = start.n;
    trial->base = case_base_read(path, model_schema(), &error);
    case_file *plain = case_read(path, start.n, start.options, model_schema(), &error);
    if (plain == NULL) {
        fail_msg("%s: %s: %s", path, error.location, error.message);
    }
    try_block(trial, &start, "", CASE_ROOT, case_root(plain));
    case_plan_free(&trial->kept);
    case_delete(&plain);
    case_base_delete(&trial->base);
}

static void every_key_edited_in_place_gives_the_case_that_is_made_from_nothing(void **state)
{
    (void)state;
    enum { VARIED = 5 }; /* the first bases, whose blocks are tried in all their variants */
    static const struct {
        const char *example, *option;
    } starts[] = {
        {"paper-friction", NULL},
        {"rattle", NULL},
        {"paper-rigid", NULL},
        /* their steady starts take long, and others have been tried by now */
        {"two-stage", "simulation.initial={kind: rest}"},
        {"tutorial-pair", "simulation.initial={kind: rest}"},
        /* what no example has and no required value makes */
        {"paper-friction", "gravity=[0, -9.81, 0]"},
        {"paper-friction", "wheels.0.loads.0={kind: harmonic, mean: 1, amplitude: 1, frequency: 3, phase: 20}"},
        {"paper-friction", "wheels.0.loads.0={kind: harmonic, amplitude: 1, order: 3}"},
        {"paper-friction", "simulation={duration: 1, output: {interval: 0.1}}"},
        {"paper-friction", "simulation={duration: 1, output: {per_turn: 20, wheel: pinion}}"},
        {"tip-relief", "wheels.0.eccentricity={amount: 1e-5, phase: 10}"},
        {"tutorial-pair", "wheels.pinion.tip_diameter=0.076"},
        {"tutorial-pair", "wheels.pinion.compliance={hub_diameter: 0.04}"},
        {"tutorial-pair",
         "wheels.pinion.compliance={model: table, rho: [0, 0.05], c: [1e-11, 2e-11], c_1: [0, 1e-12]}"},
        {"tutorial-pair",
         "wheels.pinion.pitch_errors=[0, 1e-6, 0, 1e-6, 0, 1e-6, 0, 1e-6, 0, 1e-6, 0, 1e-6, 0, 1e-6, 0, 1e-6, 0, "
         "1e-6, 0, 1e-6, 0, 1e-6, 0]"},
    };
    wheel_stand_in wheel = {0};
    bool tried[MOST_ROWS] = {false};
    trial trial = {.tried = tried, .wheels = wheel_stand_in_store(&wheel)};
    assert_true(model_schema()->n <= MOST_ROWS);
    for (size_t i = 0; i < sizeof starts / sizeof *starts; i++) {
        ARENA_SCOPE memory_arena arena = {NULL};
        try_example(&trial, arena_printf(&arena, "examples/%s.yaml", starts[i].example), starts[i].option, i < VARIED);
    }
    int left = 0;
    for (int i = 0; i < model_schema()->n; i++) {
        const evl_row *row = &model_schema()->rows[i];
        if (row->type <= EVL_NAMED && !tried[i]) {
            print_message("not tried: %s.%s %s\n", row->block, row->key, row->variants);
            left++;
        }
    }
    print_message("%d cases, %d good, %d in place, %d not tried\n", trial.n_cases, trial.n_good, trial.n_in_place,
                  left);
    wheel_stand_in_free(&wheel);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_edited_in_place_gives_the_case_that_is_made_from_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
