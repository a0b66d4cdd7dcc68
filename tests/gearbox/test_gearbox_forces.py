"""Forces of a gearbox: inputs from tracking, equilibrium of wheels and axes, energy."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kernel.gearbox import LOADED, MESH, OPEN, UNLOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import (
    PAIRS,
    chain,
    face,
    in_mode,
    paper_gearbox,
    prescribed,
    press,
    worst,
)
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.housing import Housing, Pair
from kernel.kernel import CONTACT, OUT_OF_DOMAIN, Kernel

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
TRACKED = pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
TRACKINGS = pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
MODES = pytest.mark.parametrize(
    "mode", [(OPEN, 0), (LOADED, 0), (LOADED, 1), (LOADED, -1), (UNLOADED, 0)]
)
SEEDS = range(6)


def johnson(kernel: Kernel, gearbox: Gearbox, h: float, rho_sum: float) -> float:
    """Johnson's force of the first mesh."""
    geometry = gearbox.mesh_geometry()
    context = {"e_star": geometry.effective_modulus, "width": geometry.common_width}
    context.update(rho_a=rho_sum / 2, rho_b=rho_sum / 2)
    law = kernel.law(CONTACT, "johnson")
    return float(kernel.law_elastic_force(law, h=h, **context).force[0])


# ---- inputs of the force


@EVERY_PAIR
@MODES
@pytest.mark.parametrize("seed", SEEDS)
def test_the_three_trackings_give_the_same_outputs_where_the_points_face_each_other(
    kernel: Kernel, pair: Pair, mode: tuple[int, int], seed: int
):
    random = np.random.default_rng(seed)
    load_a = (load(0, TORQUE, -3.0), load(0, VISCOUS, 0.2))
    settings = {"friction": (0.3, 1e-3), "damping": 2e4}
    closed = pair.gearbox(kernel, load_a, tracking=CLOSED_FORM, **settings)
    state = in_mode(closed, random, mode)
    expected = closed.outputs(state)
    for tracking in (ALGEBRAIC, DIFFERENTIAL):
        gearbox = pair.gearbox(kernel, load_a, tracking=tracking, **settings)
        same = State(state.t, *np.zeros((2, gearbox.sizes.n_states)), state.integers, state.reals)
        for i, name in enumerate(closed.names):
            same.y[gearbox.index(name)] = state.y[i]
        face(gearbox, same)
        outputs = gearbox.outputs(same)
        for name, values in expected.items():
            if name in ("tracking", "gradient_ratio") or "distance" in name or "residual" in name:
                continue
            # the tracked points are accurate to 1e-15 of a metre, their normal to 1e-15/rho_B of a
            # radian, and quantities of the small sliding velocity to 1e-11 of themselves
            tolerance = 1e-11 * abs(values) + 1e-14 * abs(values).max() + 1e-15
            assert worst(outputs[name] - values, tolerance) <= 1, name


@EVERY_PAIR
@TRACKED
def test_first_force_follows_a_displaced_mu(kernel: Kernel, pair: Pair, tracking: str):
    """Displaced by 1 %, it gives Johnson's force at 1.01 h: the closed form would not change."""
    gearbox = pair.gearbox(kernel, tracking=tracking, damping=0.0)
    state = gearbox.start(2, speeds=(0, 3.0) if pair.reference else (0, 0), gaps=[-3e-9])
    before = gearbox.outputs(state)
    share = gearbox.mesh_geometry().elastic_share_driving
    h = before["penetration"][0]
    assert h == pytest.approx(3e-9, rel=1e-14)
    rho_sum = before["friction_arm_driving"][0] + before["friction_arm_driven"][0] + h
    assert before["normal_force"][0] == pytest.approx(
        johnson(kernel, gearbox, h, rho_sum), rel=1e-13
    )
    state.y[gearbox.tracked()][5] *= 1.01
    after = gearbox.outputs(state)
    expected = johnson(kernel, gearbox, 1.01 * h, rho_sum)
    assert after["normal_force"][0] == pytest.approx(expected, rel=1e-13)
    assert expected / before["normal_force"][0] > 1.01
    rho_a = after["friction_arm_driving"][0] + share * 1.01 * h
    assert rho_a == pytest.approx(before["friction_arm_driving"][0] + share * h, rel=1e-15)
    # and so do the accelerations
    if pair.reference == 0:
        ratio = gearbox.derivative(state)[1] / state.yp[1]
        assert ratio == pytest.approx(expected / before["normal_force"][0], rel=1e-12)


@EVERY_PAIR
@TRACKED
def test_displaced_wheels_leave_the_force_of_tracked_points_alone(
    kernel: Kernel, pair: Pair, tracking: str
):
    """The closed form, by contrast, would have twice the penetration."""
    gearbox = pair.gearbox(kernel, tracking=tracking, damping=0.0)
    state = gearbox.start(2, speeds=(0, 3.0) if pair.reference else (0, 0), gaps=[-3e-9])
    before = gearbox.outputs(state)["normal_force"][0]
    turned, moved = state.copy(), state.copy()
    wheel = 1 - pair.reference
    r_b = gearbox.wheel_geometry(wheel).base_radius
    turned.y[gearbox.index(f"angle_deviation_{wheel}")] -= pair.sigma * 3e-9 / r_b
    assert gearbox.outputs(turned)["normal_force"][0] == before
    moved.y[gearbox.index("displacement_x_1")] += 3e-9
    # only the driven flank's radius of curvature changes, by 3e-9 m times its slope: below 1e-4 of
    # itself, and the force depends on it by a logarithm
    assert gearbox.outputs(moved)["normal_force"][0] == pytest.approx(before, rel=1e-5)
    for other in (turned, moved):
        face(gearbox, other)
        assert abs(gearbox.outputs(other)["normal_force"][0] / before - 1) > 1e-2


@TRACKINGS
def test_force_of_the_contact_is_clipped_not_pulled(kernel: Kernel, tracking: str):
    gearbox = paper_gearbox(kernel, tracking=tracking)
    state = gearbox.start(0, gaps=[-1e-9])
    loaded = gearbox.outputs(state)["normal_force"][0]
    for mode, expected in ((OPEN, 0.0), (LOADED, loaded), (UNLOADED, 0.0)):
        press(gearbox, state, 0, mode)
        assert gearbox.outputs(state)["normal_force"][0] == expected
        assert gearbox.outputs(state)["contact_mode"][0] == mode
        assert gearbox.outputs(state)["in_contact"][0] == 1


def test_a_penetration_past_the_limit_is_out_of_the_domain_with_value_and_limit(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    state = gearbox.start(0, gaps=[-1e-9])
    state.y[gearbox.index("angle_deviation_1")] -= 0.3
    calls: list[Callable[[State], object]] = [
        gearbox.residual,
        gearbox.derivative,
        gearbox.outputs,
        gearbox.roots,
        lambda s: gearbox.jacobian(s, 1.0),
    ]
    for call in calls:
        with pytest.raises(GearboxError) as error:
            call(state)
        assert (error.value.code, error.value.subject, error.value.index) == (
            OUT_OF_DOMAIN,
            MESH,
            0,
        )
        assert error.value.field == "contact"
        assert "penetration h = " in error.value.message
        assert "limit" in error.value.message


# ---- balance


@EVERY_PAIR
@TRACKINGS
@pytest.mark.parametrize("branch", [-1, 0, 1])
@pytest.mark.parametrize("seed", SEEDS)
def test_torques_balance_on_each_wheel(
    kernel: Kernel, pair: Pair, tracking: str, branch: int, seed: int
):
    """Check sigma F_n (r_b + (F_t/F_n) l) = J omega' - M for either direction of sliding."""
    random = np.random.default_rng(seed)
    loads = (load(0, TORQUE, -3.0), load(0, VISCOUS, 0.2))
    gearbox = pair.gearbox(kernel, loads, tracking=tracking, friction=(0.3, 1e-3))
    state = in_mode(gearbox, random, (LOADED, branch))
    o = gearbox.outputs(state)
    f_n, f_t = o["normal_force"][0], o["friction_force"][0]
    for i, name in enumerate(("driving", "driven")):
        arm = o[f"friction_arm_{name}"][0]
        torque = pair.sigma * (f_n * o["base_radius"][i] + f_t * arm)
        inertial = o["inertia"][i] * o["angular_acceleration"][i]
        balance = torque + o["load_torque"][i] - inertial
        # rounding of the largest of the three
        assert worst(balance, 1e-14 * (abs(torque) + abs(inertial))) <= 1
    speed = pair.sigma * (
        o["angular_velocity"][0] * o["friction_arm_driving"][0]
        + o["angular_velocity"][1] * o["friction_arm_driven"][0]
    )
    t, _ = Housing(pair, gearbox, state).directions
    slip = (o["centre_velocity"][0] - o["centre_velocity"][1]) @ np.array(t, dtype=float)
    assert o["sliding_velocity"][0] == pytest.approx(speed + slip, rel=1e-11)
    factor = o["sliding_velocity"][0] / 1e-3 if branch == 0 else branch
    assert f_t == pytest.approx(-0.3 * f_n * factor, rel=1e-13)


@EVERY_PAIR
@TRACKINGS
@pytest.mark.parametrize("seed", SEEDS)
def test_the_axles_feel_opposite_forces_along_the_line_of_action_and_across_it(
    kernel: Kernel, pair: Pair, tracking: str, seed: int
):
    """Check -F_n e + F_t t on the driving axis; momentum is conserved."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=(0.3, 1e-3))
    state = in_mode(gearbox, random, (LOADED, 1))
    o = gearbox.outputs(state)
    t, e = (np.array(v, dtype=float) for v in Housing(pair, gearbox, state).directions)
    on_a = -o["normal_force"][0] * e + o["friction_force"][0] * t
    for i, force in enumerate((on_a, -on_a)):
        mass = o["mass"][i] + 5.0  # that of the support in Pair
        for x, axis in enumerate("xy"):
            index = gearbox.index(f"displacement_{axis}_{i}")
            stiffness, damping = ((1e9, 1e5), (7e8, 8e4))[x]
            s, rate, acceleration = state.y[index], state.y[index + 1], state.yp[index + 1]
            terms = np.array([mass * acceleration, stiffness * s, damping * rate, -force[x]])
            assert worst(terms.sum(), 1e-13 * abs(terms).max()) <= 1
            assert state.yp[index] == rate


# ---- energy

GEARBOXES: dict[str, Callable[[Kernel, int, int], Gearbox]] = {
    "prescribed": prescribed,
    "two": lambda kernel, tracking, sigma: chain(kernel, 2, tracking, sigma=sigma),
    "four": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma=sigma),
    "ring": lambda kernel, tracking, sigma: chain(kernel, 4, tracking, sigma=sigma, closed=True),
}
SUPPORT_MASS = {"prescribed": (0.0, 0.0)}  # besides the wheel's; that of `chain` if not listed


def kinetic(gearbox: Gearbox, o: dict[str, np.ndarray], masses: np.ndarray) -> float:
    rotation = o["inertia"] * o["angular_velocity"] ** 2
    return float((rotation.sum() + (masses * (o["centre_velocity"] ** 2).sum(axis=1)).sum()) / 2)


@MODES
@TRACKINGS
@pytest.mark.parametrize("sigma", [1, -1])
@pytest.mark.parametrize("name", GEARBOXES)
def test_energy_changes_by_the_work_of_the_loads_less_what_is_dissipated(
    kernel: Kernel, name: str, tracking: str, sigma: int, mode: tuple[int, int]
):
    """Check d/dt (T + V + dissipated - work) = 0 along the flow, in every mode."""
    gearbox = GEARBOXES[name](kernel, tracking, sigma)
    n = gearbox.sizes.n_wheels
    for seed in SEEDS:
        random = np.random.default_rng(seed)
        state = in_mode(gearbox, random, mode)
        o = gearbox.outputs(state)
        masses = o["mass"] + np.array(SUPPORT_MASS.get(name, 2.0 + np.arange(n)))
        assert o["kinetic_energy"][0] == pytest.approx(kinetic(gearbox, o, masses), rel=1e-14)
        motion = axle_accelerations(gearbox, state)
        d_kinetic = np.concatenate(
            [
                o["inertia"] * o["angular_velocity"] * o["angular_acceleration"],
                masses * (o["centre_velocity"] * motion).sum(axis=1),
            ]
        )
        d_potential = rate_along_flow(gearbox, state, "potential_energy")
        d_dissipated = state.yp[gearbox.index("dissipated_energy")]
        d_work = state.yp[gearbox.index("load_work")]
        parts = [*d_kinetic, d_potential, d_dissipated, -d_work]
        # Richardson differences of V over 1e-3 of h: 1e-10 of the largest power
        assert worst(np.sum(parts), 1e-10 * np.abs(parts).max()) <= 1
        if mode == (LOADED, 0) and (o["normal_force"] >= 0).all():
            assert d_dissipated >= 0


def axle_accelerations(gearbox: Gearbox, state: State) -> np.ndarray:
    """Accelerations of the axes [n_wheels, 2]: stored as velocities, and read as such."""
    moved = state.copy()
    for i, name in enumerate(gearbox.names):
        if name.startswith("displacement") and "rate" in name:
            moved.y[i] = state.yp[i]
    for m in range(gearbox.sizes.n_meshes):  # no force: such velocities are outside its law
        press(gearbox, moved, m, OPEN)
    return gearbox.outputs(moved)["centre_velocity"]


def rate_along_flow(gearbox: Gearbox, state: State, name: str) -> float:
    """Rate of an output along the flow, by differences over steps in which h changes by 1e-3."""
    o = gearbox.outputs(state)
    h = min(abs(o["gap"]))
    speed = max(abs(rates_of_gaps(gearbox, state)))
    step = 1e-3 * h / max(speed, 1e-9)
    values = {}
    for k in (-2, -1, 1, 2):
        moved = state.copy()
        moved.y = state.y + k * step * state.yp
        values[k] = gearbox.outputs(moved)[name][0]
    return float((8 * (values[1] - values[-1]) - (values[2] - values[-2])) / (12 * step))


def rates_of_gaps(gearbox: Gearbox, state: State) -> np.ndarray:
    step = 1e-7
    moved = state.copy()
    moved.y = state.y + step * state.yp
    return (gearbox.outputs(moved)["gap"] - gearbox.outputs(state)["gap"]) / step


def test_two_wheels_without_supports_loads_and_losses_keep_their_energy(kernel: Kernel):
    """To rounding: only rotation and the contact's potential are involved."""
    gearbox = paper_like_free_pair(kernel)
    state = gearbox.start(2, speeds=[-1.0, 0.6], gaps=[-2e-6])
    state.yp = gearbox.derivative(state)
    o = gearbox.outputs(state)
    d_kinetic = o["inertia"] * o["angular_velocity"] * o["angular_acceleration"]
    d_potential = rate_along_flow(gearbox, state, "potential_energy")
    # Richardson differences of V over 1e-3 of h: 1e-11 of it
    assert d_potential == pytest.approx(-d_kinetic.sum(), rel=1e-10)
    # a series for V: its truncation error is (h/rho)^3 of the power, 1e-14 here
    assert abs(state.yp[gearbox.index("dissipated_energy")]) <= 1e-14 * abs(d_potential)
    assert state.yp[gearbox.index("load_work")] == 0


def paper_like_free_pair(kernel: Kernel) -> Gearbox:
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    return Gearbox(kernel, wheels, [], [mesh(kernel, damping=None)])
