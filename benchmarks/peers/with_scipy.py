"""scipy's solve_ivp, f compiled by numba, events located by scipy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from paper_case import N_ROOTS, Array, depths, rhs, root_directions, roots
from pieces import Piece, in_pieces
from scipy.integrate import solve_ivp

SMALLEST_RTOL = 2.3e-14  # of scipy; next to the absolute tolerance it does not count


def solver(method: str, friction: float, tolerance: float) -> Callable[[], Array]:
    """Return what integrates the case once and gives h at the outputs [m]."""

    def piece(t: float, y: Array, times: Array, p: Array, first_step: float) -> Piece:
        values = np.empty(N_ROOTS)

        def f(_t: float, y: Array) -> Array:
            dy = np.empty(y.size)
            rhs(y, p, dy)
            return dy

        def event(index: int, direction: int) -> Callable[[float, Array], float]:
            def function(_t: float, y: Array) -> float:
                roots(y, p, values)
                return float(values[index])

            function.terminal, function.direction = True, direction  # type: ignore[attr-defined]
            return function

        directions = root_directions(p)
        watched = range(N_ROOTS if friction > 0 else 2)
        solution = solve_ivp(
            f,
            (t, times[-1]),
            y,
            method=method,
            t_eval=times,
            events=[event(i, directions[i]) for i in watched],
            first_step=min(first_step, times[-1] - t),
            rtol=SMALLEST_RTOL,
            atol=tolerance,
        )
        if solution.status < 0:
            raise RuntimeError(solution.message)
        outputs = solution.y.T if solution.y.size else np.empty((0, y.size))
        if solution.status == 0:
            return Piece(outputs, None, times[-1], outputs[-1])
        root = next(i for i in watched if solution.t_events[i].size)
        return Piece(outputs, root, solution.t_events[root][0], solution.y_events[root][0])

    return lambda: depths(in_pieces(piece, friction))
