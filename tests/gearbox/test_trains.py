"""Trains with shafts and discs: rotors, elastic shafts, speed ratios, rejected input."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from math import gcd, pi
from typing import Any

import numpy as np
import pytest

from gearbox.test_housing_jacobian import HOUSINGS, extrapolated
from kernel.gearbox import INITIAL, LOAD, MESH, OPEN, SHAFT, WHEEL, Gearbox, GearboxError, State
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEED,
    SPEEDS,
    STEADY,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    shaft,
    wheel,
)
from kernel.housing_description import HARMONIC, PRESCRIBED, TURN_Z, housing, term
from kernel.kernel import CONTACT, INVALID_INPUT, Floats, Kernel
from kernel.shaft_cases import (
    DRUM,
    GEAR,
    MOTOR,
    PINION,
    SECOND_GEAR,
    SECOND_PINION,
    stirred,
    two_stages,
)

MIDDLES = pytest.mark.parametrize("middle", [3e4, None], ids=["elastic", "rigid"])
DRIVERS = pytest.mark.parametrize("driven_by", ["torque", "motor", "gear", "drum"])


# ---- consistency of the equations


def jacobian_error(gearbox: Gearbox, state: State, cj: float = 37.0) -> float:
    """Largest error of the Jacobian against differences, over the largest entry of its row."""
    small = ("angle_deviation", "displacement", "turn", "zeta", "dr", "mu", "gradient", "speed_dev")
    columns = []
    for i, name in enumerate(gearbox.names):

        def along(which: str, i: int = i) -> Callable[[float], Floats]:
            def f(h: float) -> Floats:
                y, yp = state.y.copy(), state.yp.copy()
                (y if which == "y" else yp)[i] += h
                return gearbox.residual(replace(state, y=y, yp=yp))

            return f

        step = 1e-9 if name.startswith(small) else 1e-4
        columns.append(extrapolated(along("y"), step) + cj * extrapolated(along("yp"), 1e-3))
    numeric = np.column_stack(columns)
    analytic = gearbox.jacobian(state, cj)
    largest = abs(analytic).max(axis=1, keepdims=True)
    return float((abs(analytic - numeric) / largest).max())


@MIDDLES
@DRIVERS
@pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
def test_jacobian_of_a_train_with_shafts_is_the_derivative_of_the_residual(
    kernel: Kernel, middle: float | None, driven_by: str, tracking: str
):
    """Elastic and rigid shafts, discs, the prescribed speed of every kind of rotor."""
    gearbox = two_stages(kernel, middle=middle, driven_by=driven_by, tracking=tracking)
    state = stirred(gearbox, np.random.default_rng(3))
    state.yp += np.random.default_rng(4).normal(size=len(state.yp)) * 1e-3
    # 1e-16 of the radii, 0.1 m, over a step of 1e-9, and as much again from the extrapolation
    assert jacobian_error(gearbox, state) <= 5e-6


@MIDDLES
@pytest.mark.parametrize("against_housing", [False, True])
@DRIVERS
@pytest.mark.parametrize("kind", ["gravity", "prescribed", "mounted"])
def test_jacobian_of_shafts_in_a_moving_housing_is_the_derivative_of_the_residual(
    kernel: Kernel, kind: str, driven_by: str, against_housing: bool, middle: float | None
):
    options: dict[str, Any] = {"middle": middle, "housing": HOUSINGS[kind]}
    gearbox = two_stages(kernel, driven_by=driven_by, against_housing=against_housing, **options)
    state = stirred_like(kernel, gearbox, middle)
    state.yp += np.random.default_rng(4).normal(size=len(state.yp)) * 1e-3
    assert jacobian_error(gearbox, state) <= 5e-6


def stirred_like(kernel: Kernel, gearbox: Gearbox, middle: float | None) -> State:
    """State of a gearbox in a moving housing; its prescribed speed does not fit the start."""
    free = two_stages(kernel, middle=middle)
    like = stirred(free, np.random.default_rng(3))
    random = np.random.default_rng(5)
    sizes = gearbox.sizes
    state = State(
        1.0,
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_integers, np.int32),
        like.reals.copy(),
    )
    n_modes = len(like.integers)
    state.integers[:n_modes] = like.integers
    state.integers[n_modes:] = 2
    ratios = np.array([gearbox.wheel_geometry(i).speed_ratio for i in range(6)])
    pitch = gearbox.wheel_geometry(PINION).angular_pitch
    deviations = free.outputs(like)["angle_deviation"]
    deviations = deviations - ratios * deviations[reference(gearbox)]
    for i, name in enumerate(gearbox.names):
        if name in free.names:
            state.y[i] = like.y[free.index(name)]
        if name.startswith("angle_deviation"):
            state.y[i] = deviations[int(name.rsplit("_", 1)[1])]
        if name.startswith("speed_deviation"):
            state.y[i] = 1e-2 * random.normal()
        if name.startswith("housing"):
            state.y[i] = random.normal() * (1e-2 if "velocity" not in name else 0.5)
        if name == "housing_quaternion_w":
            state.y[i] = 1.0
    state.y[gearbox.index("reference_angle")] = -0.4 * pitch / ratios[PINION]
    state.y[gearbox.index("reference_speed")] = 4.0
    state.yp = gearbox.derivative(state)
    return state


def reference(gearbox: Gearbox) -> int:
    """Wheel whose angle is theta."""
    return next(i for i in range(6) if gearbox.wheel_geometry(i).is_reference)


# ---- invariants


@MIDDLES
@DRIVERS
@pytest.mark.parametrize("seed", range(4))
def test_energy_changes_by_the_work_of_the_loads_less_what_shafts_and_contacts_dissipate(
    kernel: Kernel, middle: float | None, driven_by: str, seed: int
):
    gearbox = two_stages(kernel, middle=middle, driven_by=driven_by)
    state = stirred(gearbox, np.random.default_rng(seed))

    def balance(h: float) -> Floats:
        moved = replace(state, t=state.t + h, y=state.y + h * state.yp)
        outputs = gearbox.outputs(moved)
        stored = outputs["kinetic_energy"] + outputs["potential_energy"]
        return stored + outputs["dissipated_energy"] - outputs["load_work"]

    rate = float(extrapolated(balance, 1e-7)[0])
    outputs = gearbox.outputs(state)
    powers = outputs["load_torque"] * outputs["angular_velocity"]
    flow = outputs["normal_force"].max() * 0.05 * abs(outputs["angular_velocity"]).max()
    # 1e-16 of the energy over the step, besides the transmitted power
    energy = float(outputs["kinetic_energy"][0] + outputs["potential_energy"][0])
    assert abs(rate) <= 1e-7 * max(flow, abs(powers).max()) + 4e-16 * energy / 1e-7


@MIDDLES
@DRIVERS
def test_torques_of_shafts_loads_and_meshes_accelerate_every_wheel(
    kernel: Kernel, middle: float | None, driven_by: str
):
    """Check J phi'' of each wheel alone, also of wheels that a rigid shaft joins to a rotor."""
    gearbox = two_stages(kernel, middle=middle, driven_by=driven_by)
    state = stirred(gearbox, np.random.default_rng(2))
    outputs = gearbox.outputs(state)
    torque = outputs["load_torque"].copy()
    for m in range(2):
        for side in ("driving", "driven"):
            torque[int(outputs[f"{side}_wheel"][m])] += outputs[f"mesh_torque_{side}"][m]
    for s in range(3):
        torque[int(outputs["shaft_wheel_first"][s])] -= outputs["shaft_torque"][s]
        torque[int(outputs["shaft_wheel_second"][s])] += outputs["shaft_torque"][s]
    needed = outputs["inertia"] * outputs["angular_acceleration"]
    assert abs(torque - needed).max() <= 1e-12 * abs(outputs["mesh_torque_driven"]).max()
    twist = outputs["angle_deviation"][GEAR] - outputs["angle_deviation"][SECOND_PINION]
    assert outputs["shaft_twist"][1] == twist
    if middle is None:
        assert twist == 0
        assert outputs["angular_velocity"][GEAR] == outputs["angular_velocity"][SECOND_PINION]


def test_without_loads_the_angular_momentum_of_two_discs_on_a_shaft_does_not_change(kernel: Kernel):
    discs = [wheel(teeth=0, pitch_radius=0.1), wheel(teeth=0, inertia=0.3, mass=4.0)]
    gearbox = Gearbox(kernel, discs, [], [], shafts=[shaft(0, 1, 1e3, 2.0)])
    state = gearbox.start(SPEEDS, speeds=[3.0, -1.0])
    state.y[gearbox.index("angle_deviation_1")] = 0.02
    outputs = gearbox.outputs(state)
    assert outputs["shaft_torque"][0] == pytest.approx(1e3 * -0.02 + 2.0 * 4.0, rel=1e-14)
    assert outputs["potential_energy"][0] == pytest.approx(1e3 * 0.02**2 / 2, rel=1e-14)
    momentum = float(outputs["inertia"] @ outputs["angular_acceleration"])
    assert abs(momentum) <= 1e-14 * abs(outputs["shaft_torque"][0])


def test_what_a_shaft_between_two_discs_loses_changes_by_twice_its_damping_torque(kernel: Kernel):
    """D = d w^2 of the rate of twist w: -2 d w by the one speed, 2 d w by the other."""
    discs = [wheel(teeth=0, pitch_radius=0.1), wheel(teeth=0, inertia=0.3, mass=4.0)]
    gearbox = Gearbox(kernel, discs, [], [], shafts=[shaft(0, 1, 1e3, 2.0)])
    state = gearbox.start(SPEEDS, speeds=[3.0, -1.0])
    row = gearbox.jacobian(state, 0.0)[gearbox.index("dissipated_energy")]
    # of y' - f, with the second disc's speed as its deviation from that of the first
    assert row[gearbox.index("speed_deviation_1")] == pytest.approx(2 * 2.0 * 4.0, rel=1e-14)


@pytest.mark.parametrize("rigid", [1, -1])
@pytest.mark.parametrize("elastic", [1, -1])
def test_rigid_shafts_hand_on_what_the_elastic_ones_beside_them_bring(
    kernel: Kernel, elastic: int, rigid: int
):
    """By hand calculation, discs 0 ~ 1 = 2 = 3 ~ 4: (J_1 + J_2 + J_3) phi'' = T_01 - T_34, and a
    rigid shaft carries the inertia beyond it and T_34. Each shaft is named from either end.
    """
    inertia = np.array([0.5, 0.3, 0.2, 0.4, 0.7])
    discs = [wheel(teeth=0, inertia=j, mass=4.0) for j in inertia]
    senses = np.array([elastic, rigid, rigid, elastic])
    ends = [(i, i + 1)[::sense] for i, sense in enumerate(senses)]
    laws: list[tuple[float, ...]] = [(1e3, 2.0), (), (), (5e2, 3.0)]
    shafts = [shaft(*wheels, *law) for wheels, law in zip(ends, laws, strict=True)]
    gearbox = Gearbox(kernel, discs, [], [], shafts=shafts)
    speeds = np.array([3.0, -1.0, -1.0, -1.0, 2.0])
    outputs = gearbox.outputs(gearbox.start(SPEEDS, speeds=speeds))
    first, last = 2.0 * (speeds[0] - speeds[1]), 3.0 * (speeds[3] - speeds[4])
    acceleration = (first - last) / inertia[1:4].sum()
    far = inertia[3] * acceleration + last
    near = inertia[2] * acceleration + far
    expected = senses * [first, near, far, last]
    np.testing.assert_allclose(outputs["shaft_torque"], expected, rtol=1e-13)


@pytest.mark.parametrize("driven", [0, 1])
def test_a_speed_held_against_a_housing_that_speeds_up_takes_the_inertia_of_all_discs_of_the_rotor(
    kernel: Kernel, driven: int
):
    """It rotates by 0.4 sin(4 pi t) about the axis, and the torque is (J_0 + J_1) Omega'."""
    inertia = np.array([0.2, 0.3])
    discs = [wheel(teeth=0, inertia=j, mass=4.0) for j in inertia]
    turns = housing(PRESCRIBED, terms=(term(TURN_Z, HARMONIC, 0.4, frequency=2.0),))
    loads = [load(driven, SPEED, -3.0, against_housing=True)]
    gearbox = Gearbox(kernel, discs, loads, [], turns, [shaft(0, 1)])
    state = gearbox.start(SPEEDS, speeds=[-3.0, -3.0], t=0.1)
    alpha = -0.4 * (4 * pi) ** 2 * np.sin(0.4 * pi)
    torque = gearbox.outputs(state)["load_torque"]
    assert torque[driven] == pytest.approx(inertia.sum() * alpha, rel=1e-13)
    assert torque[1 - driven] == 0
    # in the housing's frame all energies are constant: inertia absorbs the power of the load
    power = gearbox.derivative(state)[gearbox.index("load_work")]
    assert abs(power) <= 1e-13 * abs(torque[driven] * 3.0)


def test_a_steady_train_has_the_speeds_and_torques_of_its_teeth(kernel: Kernel):
    """Manual solution: 5 N m times 47/20 times 53/23 against 20 N m s, no friction; 1e-12."""
    middle = 5.0 * 47 / 20
    gearbox = two_stages_without_side_loads(kernel)
    outputs = gearbox.outputs(gearbox.start(STEADY))
    drum = middle * 53 / 23
    speed = drum / 20.0
    expected = -speed * np.array(
        [53 / 23 * 47 / 20, 53 / 23 * 47 / 20, -53 / 23, -53 / 23, 1.0, 1.0]
    )
    np.testing.assert_allclose(outputs["angular_velocity"], expected, rtol=1e-12)
    np.testing.assert_allclose(
        outputs["shaft_torque"], [-5.0, middle, drum], rtol=1e-12
    )  # the last shaft starts at the drum
    np.testing.assert_allclose(outputs["shaft_twist"][[0, 2]], [-5.0 / 5e4, drum / 1e5], rtol=1e-12)
    for m, (pinion, torque) in enumerate(((PINION, 5.0), (SECOND_PINION, middle))):
        force = torque / gearbox.wheel_geometry(pinion).base_radius
        assert outputs["normal_force"][m] == pytest.approx(force, rel=1e-12)


def two_stages_without_side_loads(kernel: Kernel) -> Gearbox:
    """Loads only on motor and drum, without friction."""
    wheels = [
        wheel(teeth=0, pitch_radius=0.08, width=0.05),
        wheel(teeth=20, pitch_radius=0.05, width=0.03),
        wheel(teeth=47, width=0.03),
        wheel(teeth=23, pitch_radius=0.06, width=0.03),
        wheel(teeth=53, width=0.03),
        wheel(teeth=0, inertia=0.8, mass=50.0, width=0.2),
    ]
    common = {"pressure_angle": 0.35, "damping": 1e3}
    return Gearbox(
        kernel,
        wheels,
        [load(MOTOR, TORQUE, -5.0), load(DRUM, VISCOUS, 20.0)],
        [
            mesh(kernel, PINION, GEAR, driving_rotation=-1, centre_line_angle=0.2, **common),
            mesh(
                kernel,
                *(SECOND_PINION, SECOND_GEAR),
                **{"driving_rotation": 1, "centre_line_angle": 0.9},
                **common,
            ),
        ],
        shafts=[
            shaft(MOTOR, PINION, 5e4, 1.0),
            shaft(GEAR, SECOND_PINION),
            shaft(DRUM, SECOND_GEAR, 1e5, 5.0),
        ],
    )


# ---- layout


def test_wheels_on_a_shaft_share_their_centre_and_speed_ratio(kernel: Kernel):
    gearbox = two_stages(kernel)
    geometry = [gearbox.wheel_geometry(i) for i in range(6)]
    for a, b in ((MOTOR, PINION), (GEAR, SECOND_PINION), (SECOND_GEAR, DRUM)):
        assert tuple(geometry[a].centre) == tuple(geometry[b].centre)
        assert geometry[a].speed_ratio == geometry[b].speed_ratio
    assert geometry[DRUM].speed_ratio == float(Fraction(20 * 23, 47 * 53))


@pytest.mark.parametrize("known", range(3))
def test_a_train_is_laid_out_from_whichever_wheel_has_a_centre(kernel: Kernel, known: int):
    radii, angles = np.array([0.1, 0.15, 0.2]), np.array([0.2, -0.9])
    lines = (radii[1:] + radii[:-1])[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    expected = np.concatenate([np.zeros((1, 2)), np.cumsum(lines, axis=0)])
    expected += np.array([0.3, -0.7]) - expected[known]
    wheels = [wheel(teeth=20, pitch_radius=0.1), wheel(teeth=30), wheel(teeth=40)]
    wheels[known].centre = (0.3, -0.7)
    meshes = [
        mesh(
            *(kernel, m, m + 1),
            **{"driving_rotation": 1 - 2 * m, "centre_line_angle": angle, "pressure_angle": 0.35},
        )
        for m, angle in enumerate(angles)
    ]
    gearbox = Gearbox(kernel, wheels, [], meshes)
    found = gearbox.outputs(gearbox.start())["centre"]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-15)


def test_a_disc_without_a_radius_has_that_of_a_solid_disc_of_its_mass_and_inertia(kernel: Kernel):
    disc = two_stages(kernel).wheel_geometry(DRUM)
    assert disc.pitch_radius == pytest.approx((2 * 0.8 / 50.0) ** 0.5, rel=1e-15)
    assert (disc.base_radius, disc.angular_pitch) == (0.0, 0.0)


@pytest.mark.parametrize("stages", [2, 4, 9])
@pytest.mark.parametrize("turns", [1, -7, 123456, 2_000_000_000])
def test_tooth_pairs_keep_their_place_after_any_number_of_turns(
    kernel: Kernel, stages: int, turns: int
):
    """Whole revolutions are converted to pitches in exact fractions of any size."""
    gearbox, teeth = many_stages(kernel, stages)
    state = gearbox.start()
    ratio = Fraction(1)
    rho = [gearbox.mesh_geometry(m).rho_start_driving for m in range(stages)]
    state.integers[0] = turns
    parts = []
    for m, (a, b) in enumerate(teeth):
        # pitches of the driving wheel in its nominal direction: whole ones are other tooth pairs
        pitches = abs(ratio) * a * turns
        whole = pitches.numerator // pitches.denominator
        whole = whole if abs(whole) < 2**31 else 0  # more teeth than can be counted
        parts.append(float(pitches - whole))
        gearbox.mode(state, m)[:2] = whole, OPEN
        ratio *= -Fraction(a, b)
    outputs = gearbox.outputs(state)
    for m in range(stages):
        pitch = gearbox.mesh_geometry(m).base_pitch
        arm = outputs["friction_arm_driving"][m]
        share = gearbox.mesh_geometry(m).elastic_share_driving
        # l_A = rho_A - w_A h, without load
        h = -outputs["gap"][m]
        assert (arm + share * h - rho[m]) / pitch == pytest.approx(parts[m], abs=1e-13, rel=1e-15)


def many_stages(kernel: Kernel, stages: int) -> tuple[Gearbox, list[tuple[int, int]]]:
    """Compound train whose numbers of teeth have no common divisor."""
    teeth = [(17, 41), (19, 43), (23, 47), (29, 53), (31, 59), (37, 61), (18, 67), (25, 71)]
    teeth = [*teeth, (16, 73)][:stages]
    assert all(gcd(a, b) == 1 for a, b in teeth)
    wheels, meshes, shafts = [], [], []
    for m, (a, b) in enumerate(teeth):
        wheels += [
            wheel(teeth=a, pitch_radius=0.0025 * a, width=0.01),
            wheel(teeth=b, width=0.01),
        ]
        sense = {"driving_rotation": 1 if m % 2 == 0 else -1, "centre_line_angle": 0.3 * m}
        meshes.append(mesh(kernel, 2 * m, 2 * m + 1, pressure_angle=0.35, **sense))
        if m > 0:
            shafts.append(shaft(2 * m - 1, 2 * m))
    gearbox = Gearbox(kernel, wheels, [load(0, TORQUE, 1.0)], meshes, shafts=shafts)
    return gearbox, teeth


# ---- rejected input


def refused(kernel: Kernel, **changes: Any) -> GearboxError:
    """Error of a small train with a shaft, changed."""
    parts: dict[str, Any] = {
        "wheels": [
            wheel(teeth=20, pitch_radius=0.05, centre=(0, 0)),
            wheel(teeth=40),
            wheel(teeth=30, pitch_radius=0.06),
            wheel(teeth=60),
        ],
        "loads": [load(0, TORQUE, -1.0)],
        "meshes": [
            mesh(kernel, 0, 1, centre_line_angle=0.0, pressure_angle=0.35),
            mesh(kernel, 2, 3, centre_line_angle=1.0, pressure_angle=0.35, driving_rotation=1),
        ],
        "shafts": [shaft(1, 2)],
    }
    parts |= changes
    with pytest.raises(GearboxError) as caught:
        Gearbox(kernel, **parts)
    error = caught.value
    assert error.code == INVALID_INPUT
    return error


def test_a_wheel_that_nothing_connects_with_the_others_is_refused(kernel: Kernel):
    error = refused(kernel, shafts=[])
    assert (error.subject, error.index) == (WHEEL, 2)
    assert "no mesh or shaft connects it" in error.message


def test_a_shaft_between_wheels_on_two_axes_is_refused(kernel: Kernel):
    error = refused(kernel, shafts=[shaft(1, 2), shaft(0, 3)])
    assert error.subject in (SHAFT, MESH)
    wheels = [wheel(teeth=20, pitch_radius=0.05, centre=(0, 0)), wheel(teeth=40)]
    wheels += [wheel(teeth=30, pitch_radius=0.06, centre=(0.1, 0.0)), wheel(teeth=60)]
    error = refused(kernel, wheels=wheels)
    assert (error.subject, error.index, error.field) == (SHAFT, 0, "wheels")
    assert "0.05 m apart" in error.message


def test_a_loop_whose_wheels_would_have_to_turn_at_two_speeds_is_refused(kernel: Kernel):
    wheels = [
        wheel(teeth=20, pitch_radius=0.05, centre=(0, 0)),
        wheel(teeth=40),
        wheel(teeth=20, pitch_radius=0.05),
        wheel(teeth=40),
    ]
    meshes = [
        mesh(kernel, 0, 1, centre_line_angle=0.0, pressure_angle=0.35),
        mesh(kernel, 2, 3, centre_line_angle=np.pi, pressure_angle=0.35, driving_rotation=1),
    ]
    # the second stage ends on the axis of the first wheel, but has a quarter of its speed
    error = refused(kernel, wheels=wheels, meshes=meshes, shafts=[shaft(1, 2), shaft(3, 0)])
    assert (error.subject, error.index) == (MESH, 1)
    assert "cannot turn" in error.message
    assert "0.25 times" in error.message


def test_a_ring_of_rigid_shafts_is_refused(kernel: Kernel):
    error = refused(kernel, shafts=[shaft(1, 2), shaft(2, 1)])
    assert (error.subject, error.index, error.field) == (SHAFT, 1, "wheels")
    error = refused(kernel, shafts=[shaft(1, 2, 1e3), shaft(2, 1)])
    assert (error.subject, error.index) == (SHAFT, 0)


@pytest.mark.parametrize(
    ("description", "field"),
    [
        (shaft(1, 9), "wheels"),
        (shaft(-1, 2), "wheels"),
        (shaft(2, 2), "wheels"),
        (shaft(1, 2, -1.0), "stiffness"),
        (shaft(1, 2, float("inf")), "stiffness"),
        (shaft(1, 2, 1e3, -1.0), "damping"),
        (shaft(1, 2, 1e3, float("nan")), "damping"),
    ],
)
def test_a_shaft_that_makes_no_sense_is_refused(kernel: Kernel, description: Any, field: str):
    error = refused(kernel, shafts=[description])
    assert (error.subject, error.index, error.field) == (SHAFT, 0, field)


def test_a_disc_that_has_no_size_or_meshes_is_refused(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.05), wheel(teeth=40), wheel(teeth=0, mass=1.0)]
    meshes = [mesh(kernel, 0, 1, centre_line_angle=0.0)]
    error = refused(kernel, wheels=wheels, meshes=meshes)
    assert (error.subject, error.index) == (WHEEL, 2)
    wheels[2] = wheel(teeth=0, pitch_radius=0.1)
    meshes.append(mesh(kernel, 2, 1, centre_line_angle=0.0))
    error = refused(kernel, wheels=wheels, meshes=meshes)
    assert (error.subject, error.index, error.field) == (MESH, 1, "driving")


def test_two_prescribed_speeds_of_one_rotor_are_refused(kernel: Kernel):
    error = refused(kernel, loads=[load(1, SPEED, 2.0), load(2, SPEED, 2.0)])
    assert (error.subject, error.index) == (LOAD, 1)


def test_two_initial_speeds_of_one_rotor_are_refused(kernel: Kernel):
    gearbox = two_stages(kernel, middle=None)
    with pytest.raises(GearboxError, match="on the same rigid shaft") as caught:
        gearbox.start(SPEEDS, speeds=[0, 0, 1.0, 2.0, 0, 0])
    assert caught.value.index == SECOND_PINION
    assert caught.value.subject in (WHEEL, INITIAL)


def test_a_ring_of_rigid_contacts_and_shafts_is_refused(kernel: Kernel):
    """Two equal parallel stages between two shafts: their forces are indeterminate."""
    wheels = [wheel(teeth=20, pitch_radius=0.05), wheel(teeth=40)]
    wheels += [wheel(teeth=20, pitch_radius=0.05), wheel(teeth=40)]
    law = {"contact": kernel.law(CONTACT, "rigid"), "damping": None}
    meshes = [mesh(kernel, a, a + 1, centre_line_angle=pi / 3, **law) for a in (0, 2)]
    error = refused(kernel, wheels=wheels, meshes=meshes, shafts=[shaft(0, 2), shaft(1, 3)])
    assert (error.subject, error.index) == (MESH, 1)
