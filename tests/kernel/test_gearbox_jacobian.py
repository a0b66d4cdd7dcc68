"""The analytic Jacobian against extrapolated differences of the residual."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kernel.gearbox import APART, LOADED, OPEN, UNLOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import (
    PAIRS,
    chain,
    in_mode,
    prescribed,
    press,
    scatter,
    worst,
)
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.kernel import Kernel

TRACKINGS = pytest.mark.parametrize(
    "tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL], ids=["closed", "algebraic", "differential"]
)
FLANKS = pytest.mark.parametrize("sigma", [1, -1])
# contact mode, friction branch
MODES = {
    "open": (OPEN, 0),
    "sticking": (LOADED, 0),
    "sliding forward": (LOADED, 1),
    "sliding back": (LOADED, -1),
    "unloaded": (UNLOADED, 0),
}
EVERY_MODE = pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
MAKERS: dict[str, Callable[[Kernel, int, int], Gearbox]] = {
    "pair with a prescribed speed": prescribed,
    "two wheels": lambda kernel, tracking, sigma: chain(kernel, 2, tracking, sigma),
    "three wheels": lambda kernel, tracking, sigma: chain(kernel, 3, tracking, sigma),
    "four wheels": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma),
    "ring": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma, closed=True),
}


def put(
    gearbox: Gearbox, random: np.random.Generator, mode: tuple[int, int], size: float = 1e-6
) -> State:
    """State with every mesh in a mode, the tracked points displaced, and any rates."""
    state = in_mode(gearbox, random, mode, size)
    for m in range(gearbox.sizes.n_meshes):
        if f"turn_{m}" in gearbox.names:
            # off the flanks as within a Newton iteration, and with rates so large that all that
            # they multiply stands out of the rounding
            track = gearbox.tracked(m)
            state.y[track] += random.normal(size=6) * [1e-6, 1e-8, 1e-8, 1e-8, 1e-3, 1e-9]
            state.yp[track] = random.normal(size=6) * [1.0, 0.1, 0.1, 0.1, 1.0, 0.1]
    return state


def column(gearbox: Gearbox, state: State, j: int, unit: float) -> tuple[np.ndarray, np.ndarray]:
    """dF/dy_j times unit, by central differences extrapolated to step 0, and how sure it is.

    Over a wide range of steps, and of each entry the value that changes least from one step and one
    order to the next, as far as the rounding of the residual lets one tell.
    """
    eps = np.finfo(float).eps

    def difference(step: float) -> np.ndarray:
        values = []
        for sign in (1, -1):
            moved = state.copy()
            moved.y[j] += sign * step * unit
            values.append((moved.y[j], gearbox.residual(moved)))
        # the step as it was rounded
        return (values[0][1] - values[1][1]) / (values[0][0] - values[1][0]) * unit

    best = np.full(len(state.y), np.nan)
    least = np.full(len(state.y), np.inf)
    before: list[np.ndarray] = []
    for step in 1e4 * 0.5 ** np.arange(30):
        try:
            row = [difference(step)]
            rounding = eps * (abs(gearbox.residual(state)) + abs(state.yp)) / step
        except GearboxError:  # so far from here the model has no answer
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


def check_jacobian(gearbox: Gearbox, state: State) -> None:
    """Compare both parts, rows and columns in their units."""
    scale, row, _ = gearbox.scales()
    cj = 1e4
    analytic = gearbox.jacobian(state, 0.0) * scale / row[:, None]
    newton = gearbox.jacobian(state, cj) * scale / row[:, None]
    columns = [column(gearbox, state, j, unit) for j, unit in enumerate(scale)]
    numeric, doubt = (np.stack(part, axis=1) / row[:, None] for part in zip(*columns, strict=True))
    # the matrix that matters: of a step of 0.1 ms
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


@EVERY_MODE
@TRACKINGS
@FLANKS
@pytest.mark.parametrize("maker", MAKERS.values(), ids=MAKERS.keys())
def test_jacobian_of_trains_is_the_derivative_of_the_residual(
    kernel: Kernel,
    maker: Callable[[Kernel, int, int], Gearbox],
    sigma: int,
    tracking: int,
    mode: tuple[int, int],
):
    """All supports and all loads; wheels of different material, width and size."""
    gearbox = maker(kernel, tracking, sigma)
    check_jacobian(gearbox, put(gearbox, np.random.default_rng(11), mode))


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
@EVERY_MODE
@TRACKINGS
def test_jacobian_of_a_pair_is_the_derivative_of_the_residual(
    kernel: Kernel, pair, tracking: int, mode: tuple[int, int]
):
    """Both flanks, any centre line, both axles on bearings; penetrations from 1e-10 to 1e-5 m."""
    random = np.random.default_rng(12)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=(0.3, 1e-3))
    for size in (1e-9, 1e-7, 1e-5):
        check_jacobian(gearbox, put(gearbox, random, mode, size))


def test_a_mesh_whose_flanks_are_apart_rests(kernel: Kernel):
    """Its tracked variables keep their value: rows y' = 0."""
    random = np.random.default_rng(13)
    for tracking in (ALGEBRAIC, DIFFERENTIAL):
        gearbox = PAIRS["tilted"].gearbox(kernel, tracking=tracking)
        state = scatter(gearbox, random)
        press(gearbox, state, 0, APART)
        state.yp[:] = random.normal(size=len(state.yp))
        track = gearbox.tracked()
        np.testing.assert_array_equal(gearbox.residual(state)[track], state.yp[track])
        matrix = gearbox.jacobian(state, 7.0)
        np.testing.assert_array_equal(matrix[track], 7.0 * np.eye(len(matrix))[track])
        assert not gearbox.derivative(state)[track].any()
