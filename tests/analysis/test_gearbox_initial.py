"""State at the start: rest, speeds, gaps, steady; and invalid starts."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import INITIAL, LOAD, LOADED, MESH, OPEN, UNLOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import chain, paper_gearbox, prescribed
from kernel.gearbox_description import (
    ALGEBRAIC,
    BEARING,
    CLOSED_FORM,
    DIFFERENTIAL,
    EQUILIBRIUM,
    FIXED,
    REST,
    SLIDER,
    SPEED,
    SPEEDS,
    STEADY,
    TABLE,
    TORQUE,
    VISCOUS,
    load,
    load_like,
    mesh,
    wheel,
)
from kernel.housing_description import PRESCRIBED, RATE, TURN_Z, housing, term
from kernel.kernel import CONTACT, FRICTION, INVALID_INPUT, NO_SOLUTION, Kernel

TRACKINGS = pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
FLANKS = pytest.mark.parametrize("sigma", [1, -1])


def two_wheels(kernel: Kernel, *loads: Block, **fields) -> Gearbox:
    """Pair on a slider with the loads of the test."""
    support = {"support_kind": SLIDER, "support_stiffness": (1e9, 0), "support_damping": (1e5, 0)}
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30, **support)]
    return Gearbox(kernel, wheels, loads, [mesh(kernel, **fields)])


def accelerations(gearbox: Gearbox, state: State) -> np.ndarray:
    """Rates of all speeds, relative to those of the loads alone."""
    indices = [i for i, n in enumerate(gearbox.names) if "speed" in n or "rate" in n]
    o = gearbox.outputs(state)
    largest = abs(o["load_torque"]).max() / o["inertia"].min()
    return state.yp[indices] / largest


# ---- rest


@TRACKINGS
@FLANKS
def test_at_rest_nothing_moves_and_the_flanks_touch(kernel: Kernel, tracking: str, sigma: int):
    gearbox = chain(kernel, 4, tracking, sigma=sigma)
    state = gearbox.start()
    moving = [n for n, y in zip(gearbox.names, state.y, strict=True) if y != 0]
    assert all(n.startswith("gradient_ratio") for n in moving)
    outputs = gearbox.outputs(state)
    np.testing.assert_array_equal(outputs["gap"], 0)
    np.testing.assert_array_equal(outputs["normal_force"], 0)
    np.testing.assert_array_equal(state.yp, gearbox.derivative(state))
    for m in range(3):
        points = [outputs[f"contact_point_{n}"][m] for n in ("driving", "driven")]
        np.testing.assert_array_equal(*points)
        # the start of the path of contact
        np.testing.assert_allclose(points[0], gearbox.mesh_geometry(m).point_a, rtol=0, atol=1e-15)


@TRACKINGS
def test_touching_flanks_are_loaded_if_the_loads_press_them_together(kernel: Kernel, tracking: str):
    for torque, mode in ((-1.0, LOADED), (1.0, OPEN), (0.0, LOADED)):
        gearbox = two_wheels(kernel, load(0, TORQUE, torque), tracking=tracking)
        state = gearbox.start()
        assert gearbox.mode(state).tolist() == [0, mode, 0]
        assert state.yp[1] == torque / gearbox.wheel_geometry(0).inertia


# ---- speeds and gaps


@TRACKINGS
@FLANKS
def test_given_speeds_and_gaps_are_those_of_the_state(kernel: Kernel, tracking: str, sigma: int):
    gearbox = chain(kernel, 4, tracking, sigma=sigma)
    speeds = np.array([-3.0, 1.9, -2.2, 3.1]) * sigma
    gaps = [2e-6, -3e-8, 0.0]
    state = gearbox.start(SPEEDS, speeds, gaps)
    outputs = gearbox.outputs(state)
    np.testing.assert_allclose(outputs["angular_velocity"], speeds, rtol=4e-16)
    np.testing.assert_allclose(outputs["gap"], gaps, rtol=1e-13, atol=1e-21)
    r_b = outputs["base_radius"]
    approach = [
        -outputs["flank"][m] * (r_b[m] * speeds[m] + r_b[m + 1] * speeds[m + 1]) for m in range(3)
    ]
    for m, (gap, speed) in enumerate(zip(gaps, approach, strict=True)):
        if gap > 0:
            expected = OPEN
        elif gap < 0:
            assert abs(speed) > 1e-3
            expected = LOADED if outputs["normal_force"][m] > 0 else UNLOADED
        else:
            expected = LOADED if speed > 0 else OPEN
        assert gearbox.mode(state, m)[1] == expected
        v_0 = max(speed, 0) if expected == LOADED else 0
        assert state.reals[m] == pytest.approx(v_0, rel=1e-12)
    np.testing.assert_array_equal(state.yp, gearbox.derivative(state))


@pytest.mark.parametrize("rotation", [1, -1])
@pytest.mark.parametrize("parts", [(0.3, 0.7), (0.7, 0.3), (0.95, 0.05), (0.05, 0.95), (0.0, 0.0)])
def test_gaps_leave_every_pair_of_a_mesh_that_hands_over_within_its_pitch(
    kernel: Kernel, rotation: int, parts: tuple[float, float]
):
    """Coast flanks start at the end of their path: after a rotation by a gap they are beyond it,
    and the next pair is used. `parts`: of the backlash.
    """
    backlash = 7.17e-5
    # with these teeth, coast flanks start 0.9993 pitches from the start of their path
    wheels = [wheel(teeth=20, pitch_radius=0.043), wheel(teeth=25), wheel(teeth=55)]
    meshes = [
        mesh(
            *(kernel, m, m + 1),
            **{"backlash": backlash, "pressure_angle": 0.30372},
            driving_rotation=rotation * (-1) ** m,
        )
        for m in (0, 1)
    ]
    gearbox = Gearbox(kernel, wheels, [load(0, TORQUE, -1.0)], meshes)
    gaps = [part * backlash for part in parts]
    state = gearbox.start(SPEEDS, [0.0] * 3, gaps)
    gearbox.check_modes(state)
    outputs = gearbox.outputs(state)
    np.testing.assert_allclose(outputs["gap"], gaps, rtol=1e-12, atol=1e-19)
    coast = [backlash - gap for gap in gaps]
    np.testing.assert_allclose(outputs["coast_gap"], coast, rtol=1e-9, atol=1e-18)


def test_a_penetration_gives_its_force_at_once(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    state = gearbox.start(REST, gaps=[-5e-9])
    geometry = gearbox.mesh_geometry()
    force = kernel.law_elastic_force(
        kernel.law(CONTACT, "johnson"),
        h=5e-9,
        rho_a=geometry.line_of_action_length,
        rho_b=5e-9,
        e_star=geometry.effective_modulus,
        width=geometry.common_width,
    ).force[0]
    assert gearbox.outputs(state)["normal_force"][0] == pytest.approx(force, rel=1e-13)


def test_overlapping_flanks_that_part_fast_start_without_force(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    state = gearbox.start(SPEEDS, speeds=[0.1, 0.0], gaps=[-1e-9])
    assert gearbox.mode(state)[1] == UNLOADED
    assert gearbox.outputs(state)["normal_force"][0] == 0


@TRACKINGS
def test_gaps_in_a_ring_have_to_close(kernel: Kernel, tracking: str):
    """On these flanks they add up to zero."""
    gearbox = chain(kernel, 4, tracking, closed=True)
    gaps = [1e-8, -1e-8, 3e-8, -3e-8]
    outputs = gearbox.outputs(gearbox.start(REST, gaps=gaps))
    np.testing.assert_allclose(outputs["gap"], gaps, rtol=1e-12)
    with pytest.raises(GearboxError, match=r"gap 1E-08 m does not agree with -3E-08 m") as error:
        gearbox.start(REST, gaps=[1e-8] * 4)
    e = error.value
    assert (e.code, e.subject, e.index, e.field) == (INVALID_INPUT, MESH, 3, "gaps")


# ---- steady


@TRACKINGS
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_paper_s_steady_state(kernel: Kernel, tracking: str, friction: float):
    gearbox = paper_gearbox(kernel, tracking=tracking, friction=friction)
    state = gearbox.start(EQUILIBRIUM)
    o = gearbox.outputs(state)
    assert worst_acceleration(gearbox, state) < 1e-9
    assert gearbox.mode(state)[1] == LOADED
    if friction == 0:
        geometry = gearbox.mesh_geometry()
        force = 1 / gearbox.wheel_geometry(0).base_radius
        assert o["normal_force"][0] == pytest.approx(force, rel=1e-12)
        assert o["angular_velocity"][1] == pytest.approx(0.15, rel=1e-12)
        # the values of the paper's figures, as far as its inputs are known
        assert o["penetration"][0] == pytest.approx(2.96653e-9, rel=1e-5)
        assert o["normal_force"][0] == pytest.approx(5.0434, rel=1e-5)
        # the axis yields along the centre line
        pushed = force * np.sin(geometry.working_pressure_angle) / 1e9
        assert o["centre_displacement"][1, 0] == pytest.approx(pushed, rel=1e-6)
    else:
        assert 0 < o["angular_velocity"][1] != pytest.approx(0.15, rel=1e-3)
        factor = np.clip(o["sliding_velocity"][0] / 1e-4, -1, 1)
        assert o["friction_force"][0] == pytest.approx(-0.3 * o["normal_force"][0] * factor)


def worst_acceleration(gearbox: Gearbox, state: State) -> float:
    return float(abs(accelerations(gearbox, state)).max())


@TRACKINGS
@FLANKS
@pytest.mark.parametrize("n", [2, 3, 4])
def test_in_the_steady_state_of_a_train_nothing_accelerates_and_every_flank_pushes(
    kernel: Kernel, n: int, tracking: str, sigma: int
):
    wheels = [
        wheel(
            teeth=teeth,
            pitch_radius=0.005 * teeth,
            support_kind=BEARING if teeth > 20 else FIXED,
            support_stiffness=(1e8, 3e8),
            support_damping=(1e4, 1e4),
        )
        for teeth in (20, 33, 27, 41)[:n]
    ]
    meshes = [
        mesh(
            kernel,
            m,
            m + 1,
            driving_rotation=-sigma * (-1) ** m,
            centre_line_angle=0.5 - 1.1 * m,
            pressure_angle=0.35,
            friction=0.1,
            tracking=tracking,
        )
        for m in range(n - 1)
    ]
    loads = [load(0, TORQUE, -7.0 * sigma), load(n - 1, VISCOUS, 5.0), load(0, VISCOUS, 0.1)]
    gearbox = Gearbox(kernel, wheels, loads, meshes)
    state = gearbox.start(EQUILIBRIUM)
    assert worst_acceleration(gearbox, state) < 1e-9
    o = gearbox.outputs(state)
    assert (o["penetration"] > 0).all()
    assert (o["normal_force"] > 0).all()
    # power of the loads equals the losses by friction and damping
    power = o["load_torque"] @ o["angular_velocity"]
    lost = state.yp[gearbox.index("dissipated_energy")]
    assert power == pytest.approx(lost, rel=1e-9, abs=1e-9 * 7 * abs(o["angular_velocity"][0]))


def test_friction_alone_settles_the_steady_speed_of_torques_that_hardly_balance(kernel: Kernel):
    """By hand calculation: the two moments give F_t/F_n, the law mu tanh(v/delta) the speed.

    The search starts in a flat part of the law, where full corrections would diverge.
    """
    mu, delta = 0.2, 0.07
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    law = kernel.law(FRICTION, "tanh", coefficient=mu, regularisation_velocity=delta)
    loads = [load(0, TORQUE, -7.0), load(1, TORQUE, -10.5 * 0.99)]
    gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel, friction=law)])
    o = gearbox.outputs(gearbox.start(EQUILIBRIUM))
    r, torque = o["base_radius"], o["load_torque"]
    arm_a, arm_b = (o[f"friction_arm_{side}"][0] for side in ("driving", "driven"))
    # M_A + F_n r_A + F_t l_A = 0 = M_B + F_n r_B + F_t l_B
    share = (torque[0] * r[1] - torque[1] * r[0]) / (torque[1] * arm_a - torque[0] * arm_b)
    assert o["friction_force"][0] == pytest.approx(share * o["normal_force"][0], rel=1e-9)
    assert o["sliding_velocity"][0] == pytest.approx(delta * np.arctanh(-share / mu), rel=1e-9)


@pytest.mark.parametrize("name", ["tanh", "coulomb", "stribeck"])
def test_light_torques_that_balance_press_the_flanks_with_their_force(kernel: Kernel, name: str):
    """In the ratio of the teeth there is no sliding, and F_n = M_A/r_A.

    The rounding of the torques changes the speed by more than a billionth of the speed that they
    would reach in a second, so corrections do not converge to that.
    """
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    terms = {"kinetic_coefficient": 0.1, "static_coefficient": 0.12, "stribeck_velocity": 0.01}
    terms = terms if name == "stribeck" else {"coefficient": 0.1}
    law = kernel.law(FRICTION, name, **terms, regularisation_velocity=1e-4)
    for torque in np.geomspace(1e-13, 1e-7, 121):
        loads = [load(0, TORQUE, -torque), load(1, TORQUE, -1.5 * torque)]
        gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel, friction=law)])
        o = gearbox.outputs(gearbox.start(STEADY))
        assert o["normal_force"][0] == pytest.approx(torque / o["base_radius"][0], rel=1e-12)
        assert abs(o["sliding_velocity"][0]) < 1e-4 * 1e-9  # of the regularisation


@pytest.mark.parametrize("name", ["tanh", "coulomb", "stribeck"])
@pytest.mark.parametrize("teeth", [(20, 30), (23, 41)])
def test_torques_in_the_ratio_of_the_teeth_rest_in_every_friction(
    kernel: Kernel, teeth: tuple[int, int], name: str
):
    """At the speed that they would reach in a second friction no longer depends on the speed."""
    wheels = [wheel(teeth=teeth[0], pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=teeth[1])]
    terms = {"kinetic_coefficient": 0.1, "static_coefficient": 0.12, "stribeck_velocity": 0.01}
    terms = terms if name == "stribeck" else {"coefficient": 0.1}
    law = kernel.law(FRICTION, name, **terms, regularisation_velocity=1e-4)
    for torque in np.geomspace(1e-6, 1e6, 25):
        other = torque * teeth[1] / teeth[0]
        loads = [load(0, TORQUE, -torque), load(1, TORQUE, -other)]
        gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel, friction=law)])
        o = gearbox.outputs(gearbox.start(STEADY))
        assert o["normal_force"][0] == pytest.approx(torque / o["base_radius"][0], rel=1e-9)
        assert abs(o["sliding_velocity"][0]) < 1e-4 * 1e-9  # of the regularisation


def test_a_prescribed_speed_is_the_steady_speed_and_its_torque_is_reported(kernel: Kernel):
    gearbox = two_wheels(kernel, load(0, TORQUE, -50.0), load(1, SPEED, 2.0))
    o = gearbox.outputs(gearbox.start(STEADY))
    assert o["angular_velocity"][1] == 2.0
    assert o["angular_velocity"][0] == pytest.approx(-3.0, rel=1e-12)
    assert o["normal_force"][0] == pytest.approx(50 / o["base_radius"][0], rel=1e-10)
    assert o["load_torque"][1] == pytest.approx(-75.0, rel=1e-10)


def test_a_table_enters_the_steady_state_with_its_torque_at_the_start(kernel: Kernel):
    table = load(0, TABLE, table=[(0.0, -1.0), (2.0, -3.0)])
    gearbox = two_wheels(kernel, table, load(1, VISCOUS, 10.0))
    o = gearbox.outputs(gearbox.start(STEADY, t=1.0))
    assert o["load_torque"][0] == pytest.approx(-2.0, rel=1e-15)
    assert o["angular_velocity"][1] == pytest.approx(0.3, rel=1e-12)


@pytest.mark.parametrize(("against_housing", "speed"), [(False, -1.0), (True, 2.0)])
def test_a_prescribed_speed_in_a_housing_that_turns_is_seen_from_where_it_says(
    kernel: Kernel, against_housing: bool, speed: float
):
    """Speeds of wheels are relative to the housing, which rotates at 3 rad/s."""
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    loads = [load(1, SPEED, 2.0, against_housing=against_housing)]
    turning = housing(PRESCRIBED, terms=[term(TURN_Z, RATE, 3.0)])
    gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel)], turning)
    state = gearbox.start(SPEEDS, speeds=[-1.5 * speed, speed])
    assert gearbox.outputs(state)["angular_velocity"][1] == pytest.approx(speed, rel=1e-14)
    with pytest.raises(GearboxError, match="does not agree"):
        gearbox.start(SPEEDS, speeds=[-1.5 * (1 - speed), 1 - speed])


# ---- invalid starts

Refusal = tuple[Callable[[Kernel], Gearbox], dict, int, int, int, str, str]


def drive(kernel: Kernel, **fields: float) -> Block:
    """Drive the first wheel."""
    return load_like(kernel, 0, {"kind": "drive", "speed": -5.0, "slope": -2.0, **fields})


BAD: dict[str, Refusal] = {
    "no kind": (paper_gearbox, {"kind": 3}, INVALID_INPUT, INITIAL, -1, "kind", "no such kind"),
    "no speeds": (paper_gearbox, {"kind": SPEEDS}, INVALID_INPUT, INITIAL, -1, "speeds", "one for"),
    "nan speed": (
        *(paper_gearbox, {"kind": SPEEDS, "speeds": [0, np.nan]}),
        *(INVALID_INPUT, INITIAL, -1, "", "finite"),
    ),
    "infinite gap": (
        *(paper_gearbox, {"kind": REST, "gaps": [np.inf]}),
        *(INVALID_INPUT, INITIAL, -1, "", "finite"),
    ),
    "a gap in which the coast flanks would penetrate each other": (
        *(lambda k: two_wheels(k, backlash=1e-4), {"kind": REST, "gaps": [0.04]}),
        *(INVALID_INPUT, MESH, 0, "gaps", "is more than half a base pitch"),
    ),
    "steady with a gap": (
        *(paper_gearbox, {"kind": STEADY, "gaps": [1e-6]}),
        *(INVALID_INPUT, INITIAL, -1, "gaps", "steady start has no gaps"),
    ),
    "rest against a prescribed speed": (
        *(lambda k: two_wheels(k, load(0, TORQUE, -1.0), load(1, SPEED, 2.0)), {"kind": REST}),
        *(INVALID_INPUT, LOAD, 1, "value", "prescribed speed 2 rad/s does not agree"),
    ),
    "speeds against a prescribed speed": (
        *(lambda k: two_wheels(k, load(1, SPEED, 2.0)), {"kind": SPEEDS, "speeds": [-3, 2.001]}),
        *(INVALID_INPUT, LOAD, 0, "value", "initial speed 2.001 rad/s"),
    ),
    "steady without a load that depends on the speed": (
        *(lambda k: two_wheels(k, load(0, TORQUE, -1.0)), {"kind": STEADY}),
        *(NO_SOLUTION, INITIAL, -1, "kind", "not determined"),
    ),
    "steady with a changing speed": (
        *(lambda k: prescribed(k, CLOSED_FORM), {"kind": STEADY, "t": 0.1}),
        *(NO_SOLUTION, LOAD, 1, "time", "changes at the start"),
    ),
    "steady with two prescribed speeds": (
        *(lambda k: two_wheels(k, load(0, SPEED, -3.0), load(1, SPEED, 2.0)), {"kind": STEADY}),
        *(NO_SOLUTION, INITIAL, -1, "kind", "but several wheels have one"),
    ),
    "steady with a pulling flank": (
        *(lambda k: two_wheels(k, load(0, TORQUE, 1.0), load(1, VISCOUS, 10)), {"kind": STEADY}),
        *(NO_SOLUTION, LOAD, 0, "value", "its torque 1 N m has the wrong sense"),
    ),
    "steady with a drive of the wrong sense": (
        *(lambda k: two_wheels(k, drive(k, speed=5.0), load(1, VISCOUS, 10)), {"kind": STEADY}),
        *(NO_SOLUTION, LOAD, 0, "speed", "has the wrong sense"),
    ),
    "steady with a drive of no stiffness": (
        *(lambda k: two_wheels(k, drive(k, slope=0.0), load(1, TORQUE, -1.0)), {"kind": STEADY}),
        *(NO_SOLUTION, INITIAL, -1, "kind", "no load depends on the speed"),
    ),
}


@pytest.mark.parametrize(
    ("make", "start", "code", "subject", "index", "field", "words"), BAD.values(), ids=BAD.keys()
)
def test_a_start_that_cannot_be_is_refused_with_what_and_why(
    kernel: Kernel,
    make: Callable[[Kernel], Gearbox],
    start: dict,
    code: int,
    subject: int,
    index: int,
    field: str,
    words: str,
):
    with pytest.raises(GearboxError) as error:
        make(kernel).start(**start)
    e = error.value
    assert (e.code, e.subject, e.index, e.field) == (code, subject, index, field), e.message
    assert words in e.message


def test_a_load_beyond_the_limit_of_the_contact_has_no_steady_state(kernel: Kernel):
    gearbox = two_wheels(kernel, load(0, TORQUE, -1e10), load(1, VISCOUS, 1e10))
    with pytest.raises(GearboxError) as error:
        gearbox.start(STEADY)
    assert error.value.code != INVALID_INPUT
    assert error.value.message


def test_a_penetration_beyond_the_limit_is_no_start(kernel: Kernel):
    with pytest.raises(GearboxError, match="exceeds the limit"):
        paper_gearbox(kernel).start(REST, gaps=[-0.09])
