"""Rigid contact: multipliers, rejected input, the rows of the constraints and their Jacobian."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from gearbox.test_gearbox_jacobian import put
from kernel.gearbox import LOADED, MESH, OPEN, Gearbox, State
from kernel.gearbox_cases import PAIRS
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEED,
    STEADY,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.housing import Pair
from kernel.jacobian import check_jacobian
from kernel.kernel import CONTACT, INVALID_INPUT, Kernel
from kernel.rigid_cases import FRICTION, KNEE, refusal, rigid, rigid_train

TRACKINGS = pytest.mark.parametrize(
    "tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL], ids=["closed", "algebraic", "differential"]
)
FLANKS = pytest.mark.parametrize("sigma", [1, -1])
EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())


# ---- multipliers


@TRACKINGS
@FLANKS
def test_the_normal_force_at_rest_is_that_of_the_torques(kernel: Kernel, tracking: str, sigma: int):
    """Fixed axes, no sliding: kappa'' = 0 with the torques M_A and M_B alone."""
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    description = mesh(kernel, driving_rotation=-sigma, tracking=tracking, **rigid(kernel))
    torques = [-3.0 * sigma, -0.5 * sigma]
    loads = [load(i, TORQUE, torque) for i, torque in enumerate(torques)]
    gearbox = Gearbox(kernel, wheels, loads, [description])
    state = gearbox.start()
    geometry = [gearbox.wheel_geometry(i) for i in (0, 1)]
    r = np.array([g.base_radius for g in geometry])
    inertia = np.array([g.inertia for g in geometry])
    force = -(sigma * r * torques / inertia).sum() / (r**2 / inertia).sum()
    assert gearbox.outputs(state)["normal_force"][0] == pytest.approx(force, rel=1e-13)
    _, row = gearbox.scales()
    assert np.abs(gearbox.residual(state) / row).max() <= 1e-12


@pytest.mark.parametrize("before", [-7.0, 0.0, 40.0])
@TRACKINGS
def test_an_event_finds_the_normal_force_of_the_torques_whatever_it_was(
    kernel: Kernel, tracking: str, before: float
):
    """Earlier compressive or adhesive forces open no contact: all forces are recomputed."""
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    description = mesh(kernel, tracking=tracking, **rigid(kernel))
    loads = [load(0, TORQUE, -3.0), load(1, TORQUE, -0.5)]
    gearbox = Gearbox(kernel, wheels, loads, [description])
    state = gearbox.start()
    multiplier = gearbox.index("multiplier_0")
    force = state.y[multiplier]
    assert force > 0
    state.y[multiplier] = before
    after, events = gearbox.apply_all(state, [])
    assert events == []
    assert gearbox.mode(after)[1] == LOADED
    assert after.y[multiplier] == pytest.approx(force, rel=1e-13)


def test_torques_that_part_the_flanks_open_the_contact_at_the_start(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    gearbox = Gearbox(kernel, wheels, [load(0, TORQUE, 1.0)], [mesh(kernel, **rigid(kernel))])
    state = gearbox.start()
    assert gearbox.mode(state)[1] == OPEN
    assert gearbox.outputs(state)["normal_force"][0] == 0


# ---- rejected input


def test_damping_of_a_rigid_contact_is_refused(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    contact = kernel.law(CONTACT, "rigid")
    error = refusal(lambda: Gearbox(kernel, wheels, [], [mesh(kernel, contact=contact)]))
    assert (error.code, error.subject, error.index) == (INVALID_INPUT, MESH, 0)
    assert error.field == "damping.law"
    assert "choose the damping law none" in error.message


@pytest.mark.parametrize(
    ("parameter", "value"),
    [("restitution", -0.1), ("restitution", 1.1), ("restitution", np.nan), ("rest_velocity", 0.0)],
)
def test_parameters_out_of_range_are_refused(kernel: Kernel, parameter: str, value: float):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    contact = kernel.law(CONTACT, "rigid", **{parameter: value})
    make = lambda: Gearbox(kernel, wheels, [], [mesh(kernel, contact=contact, damping=None)])  # noqa: E731
    assert refusal(make).field == f"contact.{parameter}"


def ring(kernel: Kernel, rigid_meshes: tuple[int, ...], loads: tuple[Any, ...] = ()) -> Gearbox:
    """Four equal wheels in a square."""
    corners = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.4), (0.0, 0.4)]
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=corner) for corner in corners]
    meshes = [
        mesh(
            kernel,
            m,
            (m + 1) % 4,
            driving_rotation=-1 if m % 2 == 0 else 1,
            centre_line_angle=None,
            pressure_angle=0.35,
            **(rigid(kernel) if m in rigid_meshes else {}),
        )
        for m in range(4)
    ]
    return Gearbox(kernel, wheels, loads, meshes)


def test_a_ring_of_rigid_contacts_is_refused(kernel: Kernel):
    error = refusal(lambda: ring(kernel, (0, 1, 2, 3)))
    assert (error.subject, error.field) == (MESH, "contact.law")
    assert "overdetermined" in error.message


@pytest.mark.parametrize("meshes", [(0,), (3,), (1, 3), (0, 1, 3)])
def test_a_ring_with_one_elastic_contact_is_not_overdetermined(
    kernel: Kernel, meshes: tuple[int, ...]
):
    gearbox = ring(kernel, meshes, (load(0, TORQUE, -1.0),))
    gearbox.start()
    assert sum(name.startswith("multiplier") for name in gearbox.names) == len(meshes)


def test_rigid_contacts_between_two_prescribed_speeds_are_refused(kernel: Kernel):
    def train(*restitutions: float | None) -> Gearbox:
        loads = (load(0, SPEED, 1.0), load(2, SPEED, 1.0))
        return rigid_train(kernel, 3, restitutions=restitutions, loads=loads)

    error = refusal(lambda: train(0.0, 0.0))
    assert (error.subject, error.field) == (MESH, "contact.law")
    assert "prescribed" in error.message
    train(0.0, None)  # an elastic contact is compliant


def test_a_start_with_penetration_is_refused(kernel: Kernel):
    gearbox = rigid_train(kernel, 2, restitutions=(0.0,))
    error = refusal(lambda: gearbox.start(gaps=[-1e-9]))
    assert (error.code, error.field) == (INVALID_INPUT, "gaps")
    assert "1E-09 m" in error.message
    assert gearbox.outputs(gearbox.start(gaps=[1e-9]))["gap"][0] == pytest.approx(1e-9, rel=1e-12)


# ---- rows of the system


MODES = pytest.mark.parametrize(
    "mode",
    [(OPEN, 0), (LOADED, 0), (LOADED, 1), (LOADED, -1)],
    ids=["open", "sticking", "sliding forward", "sliding back"],
)
LOADS = (load(0, TORQUE, -7.0), load(0, VISCOUS, 0.3))


def press_by(gearbox: Gearbox, state: State, random: np.random.Generator) -> State:
    """Set the multipliers of all closed contacts."""
    for m in range(gearbox.sizes.n_meshes):
        if f"multiplier_{m}" in gearbox.names:
            state.y[gearbox.index(f"multiplier_{m}")] = random.uniform(1.0, 100.0)
    return state


@MODES
@TRACKINGS
@FLANKS
@pytest.mark.parametrize(
    "restitutions", [(0.0,), (0.0, 0.0), (0.0, None), (None, 0.0), (0.0, None, 0.0)]
)
def test_jacobian_of_trains_with_rigid_contacts(
    kernel: Kernel,
    restitutions: tuple[float | None, ...],
    sigma: int,
    tracking: str,
    mode: tuple[int, int],
):
    random = np.random.default_rng(21)
    n = len(restitutions) + 1
    gearbox = rigid_train(kernel, n, tracking, sigma, restitutions, loads=LOADS)
    check_jacobian(gearbox, press_by(gearbox, put(gearbox, random, mode), random))


@MODES
@TRACKINGS
@EVERY_PAIR
def test_jacobian_of_a_pair_with_rigid_contact(
    kernel: Kernel, pair: Pair, tracking: str, mode: tuple[int, int]
):
    random = np.random.default_rng(22)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=FRICTION, **rigid(kernel))
    for size in (1e-9, 1e-6):
        check_jacobian(gearbox, press_by(gearbox, put(gearbox, random, mode, size), random))


def test_jacobian_of_a_rigid_contact_whose_line_turns_fast(kernel: Kernel):
    """Axes at 30 m/s: kappa'' contains the square of the speed along the line, over its length."""
    random = np.random.default_rng(23)
    gearbox = rigid_train(kernel, 2, restitutions=(0.0,), loads=LOADS)
    state = press_by(gearbox, put(gearbox, random, (LOADED, 1)), random)
    for i, name in enumerate(gearbox.names):
        if name.startswith("displacement") and "_rate" in name:
            state.y[i] = random.choice([-30.0, 30.0]) * random.uniform(0.5, 1.0)
    check_jacobian(gearbox, state)


@pytest.mark.parametrize("friction", [0.0, 0.2])
@TRACKINGS
def test_a_steady_start_accelerates_nothing(kernel: Kernel, tracking: str, friction: float):
    loads = (load(0, TORQUE, -7.0), load(2, VISCOUS, 5.0))
    gearbox = rigid_train(kernel, 3, tracking, loads=loads, friction=(friction, KNEE))
    state = gearbox.start(STEADY)
    values = gearbox.outputs(state)
    scale, _ = gearbox.scales()
    still = [i for i, name in enumerate(gearbox.names) if "rate" in name or "speed_dev" in name]
    # 1 rad/s^2 is the effect of the torque; the scales of the rates are those of a vibration
    assert np.abs(state.yp[still] / scale[still]).max() <= 1e-5
    assert np.abs(values["gap"]).max() <= 1e-18
    assert (values["normal_force"] > 0).all()
    if friction == 0:
        force = 7.0 / gearbox.wheel_geometry(0).base_radius
        np.testing.assert_allclose(values["normal_force"], force, rtol=1e-12)
