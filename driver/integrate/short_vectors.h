/** Most frequent operations of IDA on vectors and matrices of about ten rows, compiled with the program.
 *
 *  Some distributions ship SUNDIALS without optimisation (such as Debian 12): its loops then take half of a run's time.
 *  These give bitwise the same results, unless SUNDIALS was compiled with fused multiply-add, which is not the default
 *  on x86-64. */
#pragma once

#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>

/** Use the operations of this file for a serial vector and all its clones. */
void short_vectors_use(N_Vector vector);

/** Use the solve procedure of this file in a dense solver; its factorisation remains. */
void short_vectors_solve(SUNLinearSolver solver);
