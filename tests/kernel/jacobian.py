"""Comparison of the analytic Jacobian of a gearbox with extrapolated residual differences."""

from __future__ import annotations

import numpy as np

from kernel.gearbox import Gearbox, GearboxError, State
from kernel.gearbox_cases import worst


def column(
    gearbox: Gearbox, state: State, j: int, unit: float, largest: float = 1e4
) -> tuple[np.ndarray, np.ndarray]:
    """Compute dF/dy_j times unit by extrapolated central differences, and its uncertainty.

    For each entry, the value with the smallest change between steps and orders over a wide range of
    steps is taken, down to the rounding error of the residual. The first step is `largest` units.
    """
    eps = np.finfo(float).eps

    def difference(step: float) -> np.ndarray:
        values = []
        for sign in (1, -1):
            moved = state.copy()
            moved.y[j] += sign * step * unit
            values.append((moved.y[j], gearbox.residual(moved)))
        # the rounded step
        return (values[0][1] - values[1][1]) / (values[0][0] - values[1][0]) * unit

    best = np.full(len(state.y), np.nan)
    least = np.full(len(state.y), np.inf)
    before: list[np.ndarray] = []
    for step in largest * 0.5 ** np.arange(30):
        try:
            row = [difference(step)]
            rounding = eps * (abs(gearbox.residual(state)) + abs(state.yp)) / step
        except GearboxError:  # the model has no result at this distance
            before = []
            continue
        for order in range(1, min(4, len(before) + 1)):
            finer = row[-1] + (row[-1] - before[order - 1]) / (4.0**order - 1)
            error = np.maximum(abs(finer - row[-1]), abs(finer - before[order - 1])) + rounding
            better = error < least
            best[better], least[better] = finer[better], error[better]
            row.append(finer)
        before = row
    return best, least


def check_jacobian(gearbox: Gearbox, state: State, largest: float = 1e4) -> None:
    """Compare both parts, with rows and columns in their units."""
    scale, row = gearbox.scales()
    cj = 1e4
    analytic = gearbox.jacobian(state, 0.0) * scale / row[:, None]
    newton = gearbox.jacobian(state, cj) * scale / row[:, None]
    listed = gearbox.listed_jacobian(state, cj)
    if listed is not None:  # entries that are nonzero in any mode are in the list
        assert np.array_equal(listed, gearbox.jacobian(state, cj))
    columns = [column(gearbox, state, j, unit, largest) for j, unit in enumerate(scale)]
    numeric, doubt = (np.stack(part, axis=1) / row[:, None] for part in zip(*columns, strict=True))
    # the relevant matrix: of a step of 0.1 ms
    largest = abs(newton).max(axis=1, keepdims=True)
    tolerance = 1e-7 * abs(analytic) + 2 * doubt + 1e-12 * largest
    assert worst(analytic - numeric, tolerance) <= 1
    assert worst(doubt, 1e-6 * largest) <= 1
    # F is linear in y'
    rates = (newton - analytic) / cj
    for j, unit in enumerate(scale):
        moved = state.copy()
        moved.yp[j] += 1e6 * unit
        change = (gearbox.residual(moved) - gearbox.residual(state)) / (moved.yp[j] - state.yp[j])
        change *= unit / row
        # rounding of the residual beside the change, and of the difference of two Jacobians
        assert worst(rates[:, j] - change, 1e-9 * np.maximum(1, abs(change))) <= 1
