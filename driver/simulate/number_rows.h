/** Metrics of a case, derived from the table in number_table.h. */
#pragma once

#include "base/memory.h"
#include "model/model.h"
#include "simulate/mesh_numbers.h"
#include "simulate/number_table.h"

/** Quantities: outputs with the same set of metrics. */
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
    double least; /**< lower bound; smaller values are rounding errors at the ends of steps */
} number_quantity;
extern const number_quantity number_quantities[N_NUMBER_QUANTITIES];

/** Input of a formula. */
typedef struct {
    const channel_window *window; /**< of an element of the row's quantity, if it has one */
    const mesh_numbers *mesh;     /**< the mesh, or the one that defines the element's harmonics */
    int index;                    /**< of the mesh */
    const model *model;
} number_source;

typedef struct {
    const char *name, *units, *text, *dims;
    const char *group; /**< name of a group of metrics */
    int quantity;      /**< quantity evaluated; QUANTITY_none */
    unsigned outputs;  /**< NEEDS_PAIRS and so on */
    double (*formula)(const number_source *from, int n);
} number_row;
extern const number_row number_rows[N_NUMBER_ROWS];

/** Names of the elements with these dimensions: wheels, meshes or accelerometers. */
const name_list *number_elements(const char *dims, const model_names *names);
/** Number of values with these dimensions. */
int number_count(const char *dims, const model_names *names);
/** The rows of a model with these names, with offsets in an array of all metrics.
 *  @param rows  [N_NUMBER_ROWS] @return the length of the array */
int number_rows_place(const model_names *names, model_output *rows);
/** Select the rows named by words: a row, a quantity, "contact", "all".
 *  @param taken  [N_NUMBER_ROWS] other rows are not changed. @return NULL, or the first unknown word */
const char *number_rows_take(int n_words, const char *const *words, bool *taken);
/** All words accepted by number_rows_take except the rows themselves: a new string. */
char *number_rows_words(void);
