"""Supports with moving reference positions: deviations of the axes, and inertia forces."""

from __future__ import annotations

import ctypes
import math

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import (
    BEARING,
    CLOSED_FORM,
    DIFFERENTIAL,
    SLIDER,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.housing_cases import HOUSINGS
from kernel.housing_description import HARMONIC, HOUSING_FIXED, PRESCRIBED, X, Y, housing, term
from kernel.jacobian import check_jacobian
from kernel.kernel import Kernel

AMPLITUDE = (3e-4, -2e-4)  # m
FREQUENCY = 40.0  # Hz


def make(kernel: Kernel, described: Block | None = None, tracking: int = CLOSED_FORM) -> Gearbox:
    """Return a pair on a bearing and a slider."""
    wheels = [
        wheel(
            teeth=20,
            pitch_radius=0.2,
            centre=(0.0, 0.0),
            support_kind=BEARING,
            support_mass=4.0,
            support_stiffness=(3e8, 2e8),
            support_damping=(1e4, 2e4),
        ),
        wheel(
            teeth=30,
            support_kind=SLIDER,
            support_direction=0.3,
            support_stiffness=(1e8, 0.0),
            support_damping=(1e4, 0.0),
        ),
    ]
    loads = [load(0, TORQUE, -40.0), load(1, VISCOUS, 7.0)]
    return Gearbox(kernel, wheels, loads, [mesh(kernel, tracking=tracking)], described)


def shaken(gearbox: Gearbox) -> Gearbox:
    """Move the carriers of the axes."""
    amplitude = (ctypes.c_double * 2)(*AMPLITUDE)
    w = ctypes.c_double(2 * math.pi * FREQUENCY)
    gearbox.library.support_shake(gearbox.handle, amplitude, w)
    return gearbox


def moving(gearbox: Gearbox, t: float = 0.0137) -> State:
    """Return a state in contact in which everything moves and accelerates."""
    state = gearbox.start(gaps=[-2e-6], t=t)
    random = np.random.default_rng(5)
    scale = gearbox.scales()[0]
    state.y += 0.1 * scale * random.uniform(-1, 1, len(state.y))
    state.yp[:] = scale * random.uniform(-1, 1, len(state.y))
    return state


def alike(kernel: Kernel) -> tuple[Gearbox, Gearbox, State]:
    """Return a gearbox with moving carriers, one with a moving housing, and a state of both."""
    described = housing(
        PRESCRIBED,
        terms=[
            term(axis, HARMONIC, a, frequency=FREQUENCY)
            for axis, a in zip((X, Y), AMPLITUDE, strict=True)
        ],
    )
    supports, carried = shaken(make(kernel)), make(kernel, described)
    return supports, carried, moving(carried)


def test_axles_whose_carriers_are_shaken_alike_move_as_in_a_housing_that_is_shaken(kernel: Kernel):
    """Equations, powers and Jacobian: only the position in the ground frame differs."""
    supports, carried, state = alike(kernel)
    for one, other in (
        (supports.residual(state), carried.residual(state)),
        (supports.jacobian(state, 1e3), carried.jacobian(state, 1e3)),
    ):
        # rounding of sums whose largest term is that of the springs
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-14 * abs(other).max())
    at_rest = make(kernel).residual(state)
    assert abs(at_rest - carried.residual(state)).max() > 1  # the motion has an effect


def test_outputs_of_shaken_carriers_are_those_of_a_shaken_housing_but_for_the_places(
    kernel: Kernel,
):
    supports, carried, state = alike(kernel)
    expected = carried.outputs(state)
    outputs = supports.outputs(state)
    shift = math.sin(2 * math.pi * FREQUENCY * state.t) * np.array(AMPLITUDE)
    for name, values in outputs.items():
        right = expected[name]
        if name.startswith("contact_point"):  # in the housing frame
            right = right + shift
        np.testing.assert_allclose(
            values, right, rtol=1e-11, atol=1e-14 * np.nanmax(abs(right), initial=0.1), err_msg=name
        )


@pytest.mark.parametrize("tracking", [CLOSED_FORM, DIFFERENTIAL])
@pytest.mark.parametrize("body", HOUSINGS)
def test_jacobian_is_the_residuals_where_supports_move_in_a_housing(
    kernel: Kernel, body: str, tracking: int
):
    gearbox = shaken(make(kernel, HOUSINGS[body], tracking))
    check_jacobian(gearbox, moving(gearbox))


def test_axles_in_a_housing_at_rest_fall_with_gravity_as_far_as_they_are_free(kernel: Kernel):
    """At the start, without spring deflection and forces: by g, or by its part along the slider."""
    gravity = np.array([1.0, -9.0, 2.0])
    gearbox = make(kernel, housing(HOUSING_FIXED, gravity=list(gravity)))
    found = gearbox.outputs(gearbox.start(gaps=[1e-6]))["centre_acceleration"]
    along = np.array([math.cos(0.3), math.sin(0.3)])
    expected = [gravity[:2], (gravity[:2] @ along) * along]
    np.testing.assert_allclose(found, expected, rtol=1e-14)
