/** What IDA asks of an integration, as functions of the kinds that it wants; `data` is the ida_session. Private to integrate/. */
#pragma once

#include "integrate/ida_session.h"

int ida_residual(sunrealtype t, N_Vector y, N_Vector yp, N_Vector r, void *data);
int ida_jacobian(sunrealtype t, sunrealtype cj, N_Vector y, N_Vector yp, N_Vector r, SUNMatrix matrix, void *data,
                 N_Vector a, N_Vector b, N_Vector c);
int ida_roots(sunrealtype t, N_Vector y, N_Vector yp, sunrealtype *values, void *data);
int ida_weights(N_Vector y, N_Vector weight, void *data);

/** Let the observer look at the motion from where it has seen it to t, in the last step. */
void ida_watch_to(ida_session *s, double t, N_Vector y);
