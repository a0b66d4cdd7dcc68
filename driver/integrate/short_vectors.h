/** What IDA does most often with vectors and matrices of ten rows, compiled with the program.
 *
 *  Distributions ship SUNDIALS without optimisation (Debian 12 does): its loops then take half of a run's time. These give the
 *  same results to the bit, unless SUNDIALS was compiled to fuse multiplications with additions, which x86-64 does not do by
 *  default. */
#pragma once

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>

/** Give a serial vector, and all that are cloned from it, the operations of this file. */
void short_vectors_use(N_Vector vector);

/** Let a dense solver solve by the procedure of this file; it goes on factorising by its own. */
void short_vectors_solve(SUNLinearSolver solver);
