/** Metrics of a case, derived from the table in metric_table.h. */
#pragma once

#include "base/memory.h"
#include "model/model.h"
#include "simulate/mesh_metrics.h"
#include "simulate/metric_table.h"
#include "simulate/output_extremes.h"
#include "simulate/root_ranges.h"

/** Quantities: outputs with the same set of metrics. */
enum {
    QUANTITY_none = -1,
#define QUANTITY(of, ...) QUANTITY_##of,
    METRIC_QUANTITIES(QUANTITY) N_METRIC_QUANTITIES
#undef QUANTITY
};

/** Rows: METRIC_transmission_error_mean and so on, METRIC_share_no_contact and so on, METRIC_root_stress_max and so on. */
enum {
#define ROW(of, key, ...) METRIC_##of##_##key,
#define QUANTITY(of, ...) METRICS_OF_QUANTITY(ROW, of, , , )
    METRIC_QUANTITIES(QUANTITY)
#undef QUANTITY
#undef ROW
#define ROW(key, ...) METRIC_##key,
        METRICS_OF_MESH(ROW) METRICS_OF_ROOT(ROW) METRICS_OF_TEMPERATURE(ROW) N_METRIC_ROWS,
#undef ROW
    METRICS_OF_ALL_MODELS = METRIC_root_stress_max /**< number of the rows before those that are only on request */
};

/** Outputs that a row requires and that only models to which they are added have. */
typedef enum { METRIC_OF_ALL_MODELS, METRIC_OF_ROOTS, METRIC_OF_TEMPERATURES, N_METRIC_REQUESTS } metric_request;

/** Extremes of these outputs. */
enum { ROOT_HIGH, ROOT_LOW, N_ROOT_EXTREMES };
extern const sought_extreme root_extremes_sought[N_ROOT_EXTREMES];
enum { TEMPERATURE_FLASH, TEMPERATURE_CONTACT, N_TEMPERATURE_EXTREMES };
extern const sought_extreme temperature_extremes_sought[N_TEMPERATURE_EXTREMES];

typedef struct {
    const char *name, *dims;
    double least; /**< lower bound; smaller values are rounding errors at the ends of steps */
} metric_quantity;
extern const metric_quantity metric_quantities[N_METRIC_QUANTITIES];

typedef struct {
    double high, low; /**< [Pa] */
} root_extremes;

typedef struct {
    double flash, contact; /**< largest values [K] */
} temperature_extremes;

/** Input of a formula. */
typedef struct {
    const channel_window *window; /**< of an element of the row's quantity, if it has one */
    const mesh_metrics *mesh; /**< the mesh, or the one that defines the element's harmonics; of a wheel all meshes */
    int index;                /**< of the mesh */
    const model *model;
    int wheel;
    root_extremes root;               /**< of the wheel */
    double root_range;                /**< of the wheel [Pa] */
    temperature_extremes temperature; /**< of the mesh */
} metric_source;

typedef struct {
    const char *name, *units, *text, *dims;
    const char *group; /**< name of a group of metrics */
    int quantity;      /**< quantity evaluated; QUANTITY_none */
    unsigned outputs;  /**< NEEDS_PAIRS and so on */
    metric_request request;
    double (*formula)(const metric_source *from, int n);
} metric_row;
extern const metric_row metric_rows[N_METRIC_ROWS];

/** Names of the elements with these dimensions: wheels, meshes or accelerometers. */
const name_list *metric_elements(const char *dims, const model_names *names);
/** Number of values with these dimensions. */
int metric_count(const char *dims, const model_names *names);
/** The rows of a model with these names, with offsets in an array of all metrics.
 *  @param rows  [N_METRIC_ROWS] @return the length of the array */
int metric_rows_lay_out(const model_names *names, model_output *rows);
/** Whether a model has the outputs of a row. */
bool metric_row_exists(const model *model, int row);
/** Whether the selected rows require the outputs of a request. @param taken  [N_METRIC_ROWS] */
bool metric_rows_request(const bool *taken, metric_request request);
/** Select the rows named by words: a row, a quantity, "contact", "root_stress", "temperature", or "all", which excludes
 *  those that are only on request.
 *  @param taken  [N_METRIC_ROWS] other rows are not changed. @return NULL, or the first unknown word */
const char *metric_rows_select(int n_words, const char *const *words, bool *taken);
/** All words accepted by metric_rows_select except the rows themselves: a new string. */
char *metric_rows_words(void);
