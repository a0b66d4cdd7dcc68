/** Which numbers of a case there are: the one table. */
#pragma once

#include "base/memory.h"
#include "model/model.h"

/** What is told of a quantity: one row each. */
typedef enum {
    TELLS_MEAN,
    TELLS_DEVIATION,
    TELLS_RMS,
    TELLS_RANGE,
    TELLS_HIGH,
    TELLS_LOW,
    TELLS_CREST,
    TELLS_KURTOSIS,
    TELLS_AMPLITUDE,
    TELLS_PHASE,
    N_TELLS
} number_tells;

/** Quantities of which all that is told; they are outputs. */
enum { NUMBER_ERROR, NUMBER_FORCE, NUMBER_SPIN, NUMBER_AXLE, NUMBER_ACCELEROMETER, N_NUMBER_QUANTITIES };

/** What is told once of a mesh. */
typedef enum {
    NUMBER_NO_CONTACT,
    NUMBER_ONE_PAIR,
    NUMBER_TWO_PAIRS,
    NUMBER_MORE_PAIRS,
    NUMBER_COAST,
    NUMBER_DYNAMIC,
    NUMBER_PAIR_FORCE,
    NUMBER_PAIR_DYNAMIC,
    NUMBER_IMPACTS,
    NUMBER_IMPACT_SPEED,
    NUMBER_IMPACT_ENERGY,
    NUMBER_ENERGY,
    NUMBER_RATTLE,
    N_OF_CONTACT
} number_of_contact;

enum { N_NUMBER_ROWS = N_NUMBER_QUANTITIES * N_TELLS + N_OF_CONTACT };

/** Row of what is told of a quantity, and of a mesh. */
static inline int number_row(int quantity, number_tells tells)
{
    return quantity * N_TELLS + (int)tells;
}
static inline int number_row_of_contact(number_of_contact what)
{
    return N_NUMBER_QUANTITIES * N_TELLS + (int)what;
}

/** The output that a quantity is. */
const char *number_quantity(int quantity);
/** Number of elements of a quantity: of each wheel, mesh or accelerometer one, or one an axis. */
int number_quantity_elements(const model_names *names, int quantity);
/** Where the first value of each row stands. @return values of all */
int number_rows_offsets(const model_names *names, int offsets[N_NUMBER_ROWS]);
/** The rows for what has these names, with places in an array of all numbers. Texts are in the pool.
 *  @param rows  [N_NUMBER_ROWS] @return the length of the array */
int number_rows_place(memory_pool *pool, const model_names *names, model_output *rows);
/** The names of what a row is of: wheels, meshes or accelerometers. */
const name_list *number_row_elements(const model_output *row, const model_names *names);
/** Take the rows that words name: a row, a quantity, "contact", "all".
 *  @param taken  [N_NUMBER_ROWS] rows that are not named stay as they are. @return NULL, or the word that names none */
const char *number_rows_take(int n_words, const char *const *words, bool *taken);
/** All words that number_rows_take knows but the rows themselves: a new string. */
char *number_rows_words(void);
