"""Consistency of the equations of a moving housing: Jacobian, residual, derivative."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import (
    BEARING,
    CLOSED_FORM,
    DIFFERENTIAL,
    SLIDER,
    SPEED,
    TORQUE,
    VISCOUS,
    load,
    load_like,
    mesh,
    wheel,
)
from kernel.housing_cases import BODY, HOUSINGS
from kernel.kernel import CONTACT, Floats, Kernel
from load_samples import SAMPLES

RIGID = -1  # instead of a tracking: a rigid contact


def loads(kernel: Kernel, kind: str) -> list[Block]:
    """Return loads against ground and housing, on both wheels, and one of a kind."""
    common = [
        load(0, TORQUE, -40.0, against_housing=True),
        load(1, VISCOUS, 7.0),
        load(1, VISCOUS, 3.0, against_housing=True),
        load(1, TORQUE, 5.0),
    ]
    if kind.endswith((GROUND, HOUSING)):
        sample = SAMPLES[kind.removesuffix(GROUND).removesuffix(HOUSING)]
        common.append(load_like(kernel, 1, sample, against_housing=kind.endswith(HOUSING)))
        return common
    driver = {
        "free": [],
        "speed against ground": [load(1, SPEED, 2.0)],
        "speed against housing": [load(1, SPEED, 2.0, against_housing=True)],
        "reference driven from the housing": [load(0, SPEED, -3.0, against_housing=True)],
    }[kind]
    return common + driver


GROUND, HOUSING = " against ground", " against housing"
LOADS = (
    "free",
    "speed against ground",
    "speed against housing",
    "reference driven from the housing",
    *(name + against for name in SAMPLES for against in (GROUND, HOUSING) if name != "speed"),
)


def make(kernel: Kernel, body: str, driven_by: str, tracking: str) -> Gearbox:
    wheels = [
        wheel(
            teeth=20,
            pitch_radius=0.2,
            centre=(0.0, 0.0),
            support_kind=BEARING,
            support_stiffness=(3e8, 2e8),
            support_damping=(1e4, 2e4),
            axial_position=0.02,
        ),
        wheel(
            teeth=30,
            width=0.12,
            support_kind=SLIDER,
            support_direction=0.3,
            support_mass=10.0,
            support_stiffness=(1e9, 0.0),
            support_damping=(1e5, 0.0),
        ),
    ]
    if tracking == RIGID:
        law = kernel.law(CONTACT, "rigid")
        contact = mesh(kernel, friction=0.3, damping=None, contact=law)
    else:
        contact = mesh(kernel, friction=0.3, tracking=tracking)
    return Gearbox(kernel, wheels, loads(kernel, driven_by), [contact], HOUSINGS[body])


def somewhere(kernel: Kernel, body: str, driven_by: str, tracking: str) -> tuple[Gearbox, State]:
    """Return a state in contact in which everything moves, with inconsistent rates."""
    gearbox = make(kernel, body, driven_by, tracking)
    gaps = None if tracking == RIGID else [-3e-7]
    start = make(kernel, body, "free", tracking).start(gaps=gaps)
    random = np.random.default_rng(1)
    names = gearbox.names
    y = start.y.copy()
    turn = -1.0 if "angle_deviation_1" in names else 2 / 3  # which wheel is the reference
    if turn > 0:  # penetration by the other wheel's angle
        y[names.index("angle_deviation_0")] *= 30 / 20
    for i, name in enumerate(names):
        if name == "reference_angle":
            y[i] = 0.01 * turn
        elif name == "reference_speed":
            y[i] = 4.0 * turn
        elif name.startswith("speed_deviation"):
            y[i] += 1e-4
        elif name.startswith("displacement"):
            y[i] += 1e-5 * (name.endswith("rate") + 1e-2) * random.uniform(0.5, 1.0)
    yp = np.array(
        [
            random.normal()
            * (1e-3 if name.startswith(("angle", "turn", "zeta", "dr", "mu")) else 1)
            for name in names
        ]
    )
    knots = gearbox.sizes.n_integers - len(start.integers)  # of tables: the first is passed
    integers = np.append(start.integers, np.ones(knots, np.int32))
    return gearbox, State(0.3, y, yp, integers, start.reals)


def steps(names: list[str]) -> Floats:
    """Return steps of the differences below: small against the nonlinearity of the equations."""
    small = ("angle_deviation", "displacement", "turn", "zeta", "dr", "mu", "gradient", "speed_dev")
    return np.array([1e-9 if n.startswith(small) else 1e-4 for n in names])


def extrapolated(f: Callable[[float], Floats], step: float) -> Floats:
    """Return the derivative of f at 0 by central differences, extrapolated twice (Richardson)."""
    table = [(f(h) - f(-h)) / (2 * h) for h in (step, step / 2, step / 4)]
    once = [(4 * b - a) / 3 for a, b in pairwise(table)]
    return (16 * once[1] - once[0]) / 15


@pytest.mark.parametrize("tracking", [CLOSED_FORM, DIFFERENTIAL, RIGID])
@pytest.mark.parametrize("driver", LOADS)
@pytest.mark.parametrize("kind", ["gravity", "prescribed", "mounted"])
def test_jacobian_is_the_derivative_of_the_residual(
    kernel: Kernel, kind: str, driver: str, tracking: str
) -> None:
    gearbox, state = somewhere(kernel, kind, driver, tracking)
    names = gearbox.names
    n, cj = len(names), 37.0
    jacobian = gearbox.jacobian(state, cj)

    def moved(i: int, which: str) -> Callable[[float], Floats]:
        def f(h: float) -> Floats:
            y, yp = state.y.copy(), state.yp.copy()
            (y if which == "y" else yp)[i] += h
            return gearbox.residual(replace(state, y=y, yp=yp))

        return f

    h = steps(names)
    numeric = np.column_stack(
        [
            extrapolated(moved(i, "y"), h[i]) + cj * extrapolated(moved(i, "yp"), 1.0)
            for i in range(n)
        ]
    )
    # Rounding of the residual over the step, and of the largest entry of the row.
    scale = np.abs(gearbox.residual(state)) + np.abs(state.yp)
    rounding = 5e-15 * (scale[:, None] / h + np.abs(numeric).max(axis=1, keepdims=True))
    excess = np.abs(jacobian - numeric) - 1e-7 * np.abs(numeric) - 100 * rounding
    i, j = np.unravel_index(np.argmax(excess), excess.shape)
    assert excess.max() <= 0, f"{names[i]} by {names[j]}: {jacobian[i, j]}, {numeric[i, j]}"
    assert (np.abs(numeric) > 100 * rounding).sum() > 2 * n  # the test is significant


@pytest.mark.parametrize("tracking", [CLOSED_FORM, DIFFERENTIAL])
@pytest.mark.parametrize("driver", LOADS)
@pytest.mark.parametrize("kind", ["gravity", "prescribed", "mounted"])
def test_derivative_solves_the_residual(
    kernel: Kernel, kind: str, driver: str, tracking: str
) -> None:
    gearbox, state = somewhere(kernel, kind, driver, tracking)
    yp = gearbox.derivative(state)
    left = gearbox.residual(replace(state, yp=yp))
    # Rounding of terms as large as the rows' Jacobian times the rates.
    size = np.abs(gearbox.jacobian(state, 1.0)) @ np.abs(yp)
    assert (np.abs(left) <= 1e-13 * (size + 1e-2 * np.abs(yp).max())).all()


@pytest.mark.parametrize("driver", LOADS)
def test_bearing_reactions_and_mount_balance_the_momentum_of_the_housing(
    kernel: Kernel, driver: str
) -> None:
    """Newton and Euler for the housing alone, with contact forces, from the outputs."""
    gearbox, state = somewhere(kernel, "mounted", driver, CLOSED_FORM)
    out = gearbox.outputs(state)
    p, omega, alpha = (
        out[f"housing_{name}"]
        for name in ("orientation", "angular_velocity", "angular_acceleration")
    )
    p0, q = p[0], p[1:]
    cross = np.cross
    rotation = (p0**2 - q @ q) * np.eye(3) + 2 * np.outer(q, q) + 2 * p0 * cross(np.eye(3), q)
    body = {name: np.array(value) for name, value in BODY.items()}
    c, arm = body["centre_of_mass"], body["mount_point"]
    a = rotation.T @ (out["housing_acceleration"] - body["gravity"])
    at_centre = a + cross(alpha, c) + cross(omega, cross(omega, c))
    deflection = out["housing_position"] + rotation @ arm - arm
    speed = out["housing_velocity"] + rotation @ cross(omega, arm)
    mount = rotation.T @ (-body["stiffness"] * deflection - body["damping"] * speed)
    k_q = body["rotational_stiffness"] * q
    turn = -2 * (p0 * k_q + cross(k_q, q)) - body["rotational_damping"] * omega
    outside = rotation.T @ body["force"]
    xy, yz, xz = body["products_of_inertia"]
    tensor = np.diag(body["inertia"]) + np.array([[0, xy, xz], [xy, 0, yz], [xz, yz, 0]])
    centres = np.column_stack([out["centre"], out["axial_position"]])
    centres[:, :2] += out["centre_displacement"]
    force = out["bearing_force"].sum(axis=0) + mount + outside
    np.testing.assert_allclose(force, body["mass"] * at_centre, rtol=0, atol=1e-11 * 3e4)
    moment = (
        out["bearing_moment"].sum(axis=0)
        + cross(centres, out["bearing_force"]).sum(axis=0)
        + cross(arm, mount)
        + turn
        + cross(c, outside)
        + rotation.T @ body["moment"]
    )
    spin = tensor @ alpha + cross(omega, tensor @ omega) + cross(c, body["mass"] * at_centre)
    # The forces are of the order of 3e4 N.
    np.testing.assert_allclose(moment, spin, rtol=0, atol=1e-11 * 3e4)
