"""numbalsoda: everything compiled, no events. Switches and kinks are left to the error control."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numba import carray, cfunc
from numbalsoda import dop853, lsoda, lsoda_sig
from paper_case import SCALES, Array, depths, grid, parameters, rhs

N_STATES, N_PARAMETERS = SCALES.size, 4


@cfunc(lsoda_sig)
def f(_t, y_pointer, dy_pointer, p_pointer):  # type: ignore[no-untyped-def]
    rhs(carray(y_pointer, N_STATES), carray(p_pointer, N_PARAMETERS), carray(dy_pointer, N_STATES))


def solver(method: str, friction: float, tolerance: float) -> Callable[[], Array]:
    """Return what integrates the case once and gives h at the outputs [m]."""
    p = parameters(friction, located=False)
    times, start = grid(), np.zeros(N_STATES)
    integrate = {"LSODA": lsoda, "DOP853": dop853}[method]

    def run() -> Array:
        states, success = integrate(
            f.address, start, times, p, rtol=1e-15, atol=tolerance, mxstep=1_000_000
        )
        if not success:
            raise RuntimeError(f"{method} of numbalsoda gave up")
        return depths(states)

    return run
