"""Analytic Jacobian, against extrapolated differences of the residual."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kernel.gearbox import APART, LOADED, OPEN, UNLOADED, Gearbox, State
from kernel.gearbox_cases import PAIRS, chain, in_mode, prescribed, press, scatter
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.jacobian import check_jacobian
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
    "two wheels": lambda kernel, tracking, sigma: chain(kernel, 2, tracking, sigma=sigma),
    "three wheels": lambda kernel, tracking, sigma: chain(kernel, 3, tracking, sigma=sigma),
    "four wheels": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma=sigma),
    "ring": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma=sigma, closed=True),
}


def put(
    gearbox: Gearbox, random: np.random.Generator, mode: tuple[int, int], size: float = 1e-6
) -> State:
    """State with every mesh in a mode, the tracked points displaced, and arbitrary rates."""
    state = in_mode(gearbox, random, mode, size)
    for m in range(gearbox.sizes.n_meshes):
        if f"turn_{m}" in gearbox.names:
            # off the flanks as within a Newton iteration, and with rates so large that all their
            # products exceed rounding
            track = gearbox.tracked(m)
            state.y[track] += random.normal(size=6) * [1e-6, 1e-8, 1e-8, 1e-8, 1e-3, 1e-9]
            state.yp[track] = random.normal(size=6) * [1.0, 0.1, 0.1, 0.1, 1.0, 0.1]
    return state


@EVERY_MODE
@TRACKINGS
@FLANKS
@pytest.mark.parametrize("maker", MAKERS.values(), ids=MAKERS.keys())
def test_jacobian_of_trains_is_the_derivative_of_the_residual(
    kernel: Kernel,
    maker: Callable[[Kernel, int, int], Gearbox],
    sigma: int,
    tracking: str,
    mode: tuple[int, int],
):
    """All supports and all loads; wheels of different material, width and size."""
    gearbox = maker(kernel, tracking, sigma)
    check_jacobian(gearbox, put(gearbox, np.random.default_rng(11), mode))


@pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
@EVERY_MODE
@TRACKINGS
def test_jacobian_of_a_pair_is_the_derivative_of_the_residual(
    kernel: Kernel, pair, tracking: str, mode: tuple[int, int]
):
    """Both flanks, any centre line, both axes on bearings; penetrations from 1e-10 to 1e-5 m."""
    random = np.random.default_rng(12)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=(0.3, 1e-3))
    for size in (1e-9, 1e-7, 1e-5):
        check_jacobian(gearbox, put(gearbox, random, mode, size))


def test_a_mesh_whose_flanks_are_apart_rests(kernel: Kernel):
    """Its tracked variables are constant: rows y' = 0."""
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
