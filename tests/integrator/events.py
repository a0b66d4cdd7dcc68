"""Integrations whose events are kept."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from integrator.radau import Solver

Floats = NDArray[np.float64]


class Recorded:
    """Events as they come: (time, state before, fired)."""

    def __init__(self, change: Callable[[Floats, NDArray[np.int32]], Floats] | None = None) -> None:
        self.change = change
        self.list: list[tuple[float, Floats, list[int]]] = []

    def __call__(self, t: float, y: Floats, fired: NDArray[np.int32]) -> Floats:
        self.list.append((t, y.copy(), fired.tolist()))
        return self.change(y, fired) if self.change else y

    @property
    def times(self) -> Floats:
        return np.array([t for t, _, _ in self.list])

    @property
    def fired(self) -> list[list[int]]:
        return [fired for _, _, fired in self.list]


def run(library, problem, y, t_end, change=None, tolerance=1e-9) -> tuple[Recorded, Solver, Floats]:
    events = Recorded(change)
    solver = Solver(library, problem, tolerance)
    end = solver.end(0, y, t_end, event=events)
    return events, solver, end
