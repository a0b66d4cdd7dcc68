"""Gearboxes with compliant teeth and wheels, separate or coupled: Jacobian, lanes, energy."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from gearbox.lanes.lane_cases import DEVIATIONS, real_gears, real_state
from gearbox.lanes.test_lanes import around, check
from gearbox.test_gearbox_forces import axle_accelerations, rate_along_flow
from kernel.gearbox import LOADED, UNLOADED, Gearbox, State
from kernel.gearbox_cases import chain, in_mode, worst
from kernel.gearbox_description import CLOSED_FORM
from kernel.jacobian import check_jacobian
from kernel.kernel import Kernel, _at

E = 2.06e11
# as in made_up_wheel.f90: E c from 4 at the root to 12 at the tip, E c_1 of 1.5; other wheels have
# 0.8 of it
MADE_UP = np.array([3.1 / E, 0.9 / E, 1.7 / E, 2.5 / E, 0.5, 0.02, 0.01, 0.03])
OTHER = MADE_UP * [0.8, 0.8, 0.8, 0.8, 1, 1, 1, 1]
every_deviation = pytest.mark.parametrize("name", DEVIATIONS)
both_kinds = pytest.mark.parametrize("couples", [False, True], ids=["alone", "coupled"])


def bend(
    gearbox: Gearbox,
    couples: bool,
    *,
    scale: float = 0.02,
    by: float = 1.0,
    k_difference: float = 2e-13,
) -> Gearbox:
    """Make the teeth of all wheels of a gearbox compliant; two materials by default."""
    influence = np.stack([MADE_UP, OTHER])
    influence[:, :4] *= by
    gearbox.library.test_flank_bend(
        gearbox.handle,
        int(couples),
        ctypes.c_double(scale),
        _at(influence),
        ctypes.c_double(k_difference),
    )
    return gearbox


def loaded_state(gearbox: Gearbox, random: np.random.Generator) -> State:
    """All pairs in contact with small displacements, axes and wheels at arbitrary rates."""
    state, _ = real_state(gearbox, random)
    return around(state, random, size=1e-6)[0]


@both_kinds
@every_deviation
def test_jacobian_is_the_derivative_of_the_residual(kernel: Kernel, couples: bool, name: str):
    gearbox = bend(real_gears(kernel, name), couples)
    random = np.random.default_rng(7)
    for _ in range(2):
        state = loaded_state(gearbox, random)
        state.yp = gearbox.derivative(state)
        check_jacobian(gearbox, state)


@both_kinds
@pytest.mark.parametrize("mode", [(LOADED, 0), (LOADED, 1), (UNLOADED, 0)])
@pytest.mark.parametrize("sigma", [1, -1])
def test_jacobian_of_trains_is_the_derivative_of_the_residual(
    kernel: Kernel, couples: bool, sigma: int, mode: tuple[int, int]
):
    """All supports and loads; wheels of different size; flanks that overlap without force."""
    gearbox = bend(chain(kernel, 3, CLOSED_FORM, sigma=sigma), couples, scale=0.2)
    state = in_mode(gearbox, np.random.default_rng(11), mode, 1e-6)
    check_jacobian(gearbox, state)


@both_kinds
@pytest.mark.parametrize("fixed", [False, True], ids=["moving axles", "fixed axles"])
@every_deviation
def test_eight_states_at_once_are_the_bits_of_each(
    kernel: Kernel, couples: bool, name: str, fixed: bool
):
    gearbox = bend(real_gears(kernel, name, fixed=fixed), couples)
    random = np.random.default_rng(3)
    for _ in range(6):
        state, _ = real_state(gearbox, random)
        check(gearbox, around(state, random, size=1e-6))


@both_kinds
@pytest.mark.parametrize("mode", [(LOADED, 0), (LOADED, 1), (UNLOADED, 0)])
@pytest.mark.parametrize("sigma", [1, -1])
def test_energy_changes_by_the_work_of_the_loads_less_what_is_dissipated(
    kernel: Kernel, couples: bool, sigma: int, mode: tuple[int, int]
):
    """Check d/dt (T + V + D - W) = 0 along the flow, with moving axes."""
    gearbox = bend(chain(kernel, 3, CLOSED_FORM, sigma=sigma), couples, scale=0.2, by=10.0)
    for seed in range(8):
        state = in_mode(gearbox, np.random.default_rng(seed), mode)
        state.yp = gearbox.derivative(state)
        o = gearbox.outputs(state)
        masses = o["mass"] + 2.0 + np.arange(gearbox.sizes.n_wheels)  # of the supports of `chain`
        d_kinetic = np.concatenate(
            [
                o["inertia"] * o["angular_velocity"] * o["angular_acceleration"],
                masses * (o["centre_velocity"] * axle_accelerations(gearbox, state)).sum(axis=1),
            ]
        )
        d_potential = rate_along_flow(gearbox, state, "potential_energy")
        d_dissipated = state.yp[gearbox.index("dissipated_energy")]
        parts = [*d_kinetic, d_potential, d_dissipated, -state.yp[gearbox.index("load_work")]]
        # Richardson differences of V over 1e-3 of h: 1e-10 of the largest power
        assert worst(np.sum(parts), 1e-10 * np.abs(parts).max()) <= 1
