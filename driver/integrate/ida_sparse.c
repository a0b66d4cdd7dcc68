#include "integrate/ida_sparse.h"

#ifdef EVOLVENT_KLU

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

/* For rows of wheels, 26 states take the same time with a dense matrix, 50 a third more, 74 twice as long. */
enum { LEAST_STATES = 50 };

struct ida_sparse {
    memory_arena arena; /**< owns the arrays, and this struct */
    const dae *model;
    void *pattern;
    int n_entries;
    int *columns;
    sunindextype *starts; /**< [n + 1] first entry of each column */
    sunindextype *rows;   /**< [n_entries] */
};

static void set_pattern(ida_sparse *sparse)
{
    const size_t n_entries = (size_t)sparse->n_entries;
    CLEANUP_FREE int *rows = xcalloc(n_entries, sizeof *rows);
    sparse->columns = arena_calloc(&sparse->arena, n_entries, sizeof *sparse->columns);
    sparse->rows = arena_calloc(&sparse->arena, n_entries, sizeof *sparse->rows);
    sparse->starts = arena_calloc(&sparse->arena, (size_t)sparse->model->n + 1, sizeof *sparse->starts);
    sparse->model->pattern->indices(sparse->pattern, rows, sparse->columns);
    for (int i = 0; i < sparse->n_entries; i++) {
        sparse->rows[i] = rows[i];
        sparse->starts[sparse->columns[i] + 1] = i + 1;
    }
}

ida_sparse *ida_sparse_open(const dae *model, N_Vector like, SUNContext context, SUNMatrix *matrix,
                            SUNLinearSolver *solver)
{
    if (model->n < LEAST_STATES || model->pattern == NULL) {
        return NULL;
    }
    int n_entries = 0;
    void *pattern = model->pattern->create(model->self, &n_entries);
    if (pattern == NULL) {
        return NULL;
    }
    ida_sparse *sparse = xcalloc(1, sizeof *sparse);
    *sparse = (ida_sparse){.model = model, .pattern = pattern, .n_entries = n_entries};
    set_pattern(sparse);
    *matrix = SUNSparseMatrix(model->n, model->n, n_entries, CSC_MAT, context);
    *solver = *matrix ? SUNLinSol_KLU(like, *matrix, context) : NULL;
    if (!*solver) {
        SUNMatDestroy(*matrix);
        *matrix = NULL;
        ida_sparse_close(&sparse);
    }
    return sparse;
}

void ida_sparse_close(ida_sparse **pointer)
{
    ida_sparse *sparse = *pointer;
    *pointer = NULL;
    if (sparse != NULL) {
        sparse->model->pattern->destroy(sparse->pattern);
        arena_free(&sparse->arena);
        free(sparse);
    }
}

/* IDA also clears the sparsity pattern before the call. */
int ida_sparse_jacobian(const ida_sparse *sparse, const dae_state *state, double cj, const double *row_units,
                        SUNMatrix matrix, char message[DAE_MESSAGE_LENGTH])
{
    const dae *model = sparse->model;
    double *entries = SUNSparseMatrix_Data(matrix);
    const size_t n_columns = (size_t)model->n;
    memcpy(SUNSparseMatrix_IndexPointers(matrix), sparse->starts, (n_columns + 1) * sizeof *sparse->starts);
    memcpy(SUNSparseMatrix_IndexValues(matrix), sparse->rows, (size_t)sparse->n_entries * sizeof *sparse->rows);
    const int code = model->pattern->jacobian(sparse->pattern, state, cj, entries, message);
    for (int i = 0; i < sparse->n_entries; i++)
        entries[i] *= row_units[sparse->rows[i]] * model->scale[sparse->columns[i]];
    return code;
}

void ida_sparse_add_sizes(const ida_sparse *sparse, SUNMatrix matrix, const double *y, double *sums)
{
    const double *entries = SUNSparseMatrix_Data(matrix);
    for (int i = 0; i < sparse->n_entries; i++)
        sums[sparse->rows[i]] += fabs(entries[i] * y[sparse->columns[i]]);
}

#else

ida_sparse *ida_sparse_open(const dae *model, N_Vector like, SUNContext context, SUNMatrix *matrix,
                            SUNLinearSolver *solver)
{
    (void)model, (void)like, (void)context, (void)matrix, (void)solver;
    return NULL;
}

void ida_sparse_close(ida_sparse **pointer)
{
    *pointer = NULL;
}

int ida_sparse_jacobian(const ida_sparse *sparse, const dae_state *state, double cj, const double *row_units,
                        SUNMatrix matrix, char message[DAE_MESSAGE_LENGTH])
{
    (void)sparse, (void)state, (void)cj, (void)row_units, (void)matrix, (void)message;
    return DAE_FATAL;
}

void ida_sparse_add_sizes(const ida_sparse *sparse, SUNMatrix matrix, const double *y, double *sums)
{
    (void)sparse, (void)matrix, (void)y, (void)sums;
}

#endif
