"""scikit-sundae: CVODE (BDF) and IDA, f compiled by numba, events located by SUNDIALS."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numba import njit
from paper_case import N_ROOTS, Array, depths, rhs, root_directions, roots
from pieces import Piece, in_pieces
from sksundae.cvode import CVODE
from sksundae.ida import IDA


@njit(cache=True, error_model="numpy")
def residual(y, dy, p, r):  # type: ignore[no-untyped-def]
    rhs(y, p, r)
    for i in range(r.size):
        r[i] = dy[i] - r[i]


def solver(method: str, friction: float, tolerance: float) -> Callable[[], Array]:
    """Return what integrates the case once and gives h at the outputs [m]."""
    n_roots = N_ROOTS if friction > 0 else 2

    def piece(t: float, y: Array, times: Array, p: Array, first_step: float) -> Piece:
        values = np.empty(N_ROOTS)
        options: dict[str, Any] = {
            "rtol": 1e-15,
            "atol": tolerance,
            "first_step": first_step,
            "max_num_steps": 1_000_000,
            "num_events": n_roots,
        }
        span = np.concatenate([[t], times])

        def look(y: Array, events: Array) -> None:
            roots(y, p, values)
            events[:] = values[:n_roots]

        if method == "CVODE":

            def f(_t: float, y: Array, dy: Array) -> None:
                rhs(y, p, dy)

            def events(_t: float, y: Array, g: Array) -> None:
                look(y, g)

            mark(events, p, n_roots)
            solution = CVODE(f, eventsfn=events, **options).solve(span, y)
        else:

            def f_ida(_t: float, y: Array, dy: Array, r: Array) -> None:
                residual(y, dy, p, r)

            def events_ida(_t: float, y: Array, _dy: Array, g: Array) -> None:
                look(y, g)

            mark(events_ida, p, n_roots)
            slope = np.empty(y.size)
            rhs(y, p, slope)
            solution = IDA(f_ida, eventsfn=events_ida, **options).solve(span, y, slope)
        if solution.status < 0:
            raise RuntimeError(solution.message)
        if solution.t_events is None or len(solution.t_events) == 0:
            return Piece(solution.y[1:], None, times[-1], solution.y[-1])
        t_event, y_event = solution.t_events[-1], solution.y_events[-1]
        root = int(np.flatnonzero(solution.i_events[-1])[0])
        return Piece(solution.y[1 : 1 + np.sum(times < t_event)], root, t_event, y_event)

    return lambda: depths(in_pieces(piece, friction))


def mark(function: Any, p: Array, n_roots: int) -> None:
    """Say which crossings end a piece."""
    function.terminal = [True] * n_roots
    function.direction = root_directions(p)[:n_roots]
