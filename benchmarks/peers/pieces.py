"""From one located event to the next, with programs that stop at events and can start anew."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from paper_case import DURATION, SCALES, Array, grid, parameters, pass_event


class Piece(NamedTuple):
    """Results of a program between two events."""

    outputs: Array  # states at the outputs that were reached, shape (n, 6)
    root: int | None  # that ended the piece; None: the end of the case
    t: float  # [s]
    y: Array  # there


# (t, y, times of outputs after t with the end of the case, parameters, first step) -> Piece
Solver = Callable[[float, Array, Array, Array, float], Piece]

FIRST_STEP = 1e-7  # at the start, and after each event [s]


def in_pieces(solve: Solver, friction: float) -> Array:
    """States at all outputs, shape (N_OUTPUTS, 6), from rest."""
    times = grid()
    p = parameters(friction, located=True)
    t, y = 0.0, np.zeros(SCALES.size)
    rows = [y[None, :]]
    while True:
        piece = solve(t, y, times[times > t], p, FIRST_STEP)
        rows.append(piece.outputs)
        if piece.root is None:
            return np.concatenate(rows)
        t, y = piece.t, np.array(piece.y)
        pass_event(y, p, piece.root)
        if not t < DURATION:
            raise RuntimeError("the case ends at an event")
