/** Which numbers of a case there are, made of the one table in number_table.h. */
#pragma once

#include "base/memory.h"
#include "model/model.h"
#include "simulate/mesh_numbers.h"
#include "simulate/number_table.h"

/** Quantities: outputs of which the same numbers are computed. */
enum {
    QUANTITY_none = -1,
#define QUANTITY(of, ...) QUANTITY_##of,
    NUMBER_QUANTITIES(QUANTITY) N_NUMBER_QUANTITIES
#undef QUANTITY
};

/** Rows: NUMBER_transmission_error_mean and so on, then NUMBER_share_no_contact and so on. */
enum {
#define ROW(of, key, ...) NUMBER_##of##_##key,
#define QUANTITY(of, ...) NUMBERS_OF_QUANTITY(ROW, of, , , )
    NUMBER_QUANTITIES(QUANTITY)
#undef QUANTITY
#undef ROW
#define ROW(key, ...) NUMBER_##key,
        NUMBERS_OF_MESH(ROW) N_NUMBER_ROWS
#undef ROW
};

typedef struct {
    const char *name, *dims;
    double least; /**< smaller values are rounding at the ends of steps */
} number_quantity;
extern const number_quantity number_quantities[N_NUMBER_QUANTITIES];

/** What a formula reads. */
typedef struct {
    const channel_window *window; /**< of an element of the row's quantity, if it has one */
    const mesh_numbers *mesh;     /**< the mesh, or that whose pitches the element's harmonics are of */
    int index;                    /**< of the mesh */
    const model *model;
} number_source;

typedef struct {
    const char *name, *units, *text, *dims;
    const char *group; /**< word that names it together with others */
    int quantity;      /**< that it reads; QUANTITY_none */
    unsigned outputs;  /**< NEEDS_PAIRS and so on */
    double (*formula)(const number_source *from, int n);
} number_row;
extern const number_row number_rows[N_NUMBER_ROWS];

/** The names of what has these dimensions: wheels, meshes or accelerometers. */
const name_list *number_elements(const char *dims, const model_names *names);
/** Number of values with these dimensions. */
int number_count(const char *dims, const model_names *names);
/** The rows for what has these names, with offsets in an array of all numbers.
 *  @param rows  [N_NUMBER_ROWS] @return the length of the array */
int number_rows_place(const model_names *names, model_output *rows);
/** Take the rows that words name: a row, a quantity, "contact", "all".
 *  @param taken  [N_NUMBER_ROWS] rows that are not named stay as they are. @return NULL, or the word that names none */
const char *number_rows_take(int n_words, const char *const *words, bool *taken);
/** All words that number_rows_take knows but the rows themselves: a new string. */
char *number_rows_words(void);
