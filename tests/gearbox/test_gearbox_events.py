"""Root functions, directions and the effect of events."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from kernel.gearbox import (
    APART,
    LOADED,
    OPEN,
    UNLOADED,
    Event,
    Gearbox,
    GearboxError,
    State,
    event_kinds,
    event_names,
)
from kernel.gearbox_cases import (
    PAIRS,
    branch,
    chain,
    face,
    in_mode,
    moved,
    paper_gearbox,
    press,
    scatter,
    set_gap,
)
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEEDS,
    mesh,
    wheel,
)
from kernel.housing import Housing, Pair
from kernel.kernel import OUT_OF_DOMAIN, Kernel

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
TRACKINGS = pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
KNEE = 1e-3
FRICTION = (0.3, KNEE)


def part(gearbox: Gearbox, state: State, rate: float) -> None:
    """Separate the flanks of the paper's gearbox at a rate [m/s]."""
    index = gearbox.index("speed_deviation_1")
    state.y[index] += rate / gearbox.wheel_geometry(1).base_radius


def is_consistent(gearbox: Gearbox, state: State) -> bool:
    return bool((state.yp == gearbox.derivative(state)).all())


def has_passed(gearbox: Gearbox, state: State, name: str) -> bool:
    """Whether a root function is already beyond zero in its active direction."""
    root = gearbox.root(state, name)
    return root * gearbox.root_direction(state, name) >= 0 and root != 1  # 1: inactive


# ---- teeth


@EVERY_PAIR
@TRACKINGS
@pytest.mark.parametrize("name", ["forward", "back"])
@pytest.mark.parametrize("seed", range(4))
def test_a_tooth_switch_leaves_the_contact_alone_but_moves_it_by_a_base_pitch(
    kernel: Kernel, pair: Pair, tracking: str, name: str, seed: int
):
    """Constant are h, F_n, lambda, mu and the invariants; the radii of curvature jump."""
    random = np.random.default_rng(seed)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=FRICTION)
    sign = 1 if name == "forward" else -1
    state = in_mode(gearbox, random, (LOADED, 0), share=(0.001, 0.02))
    if name == "forward":  # the pair before is still in mesh
        gearbox.mode(state)[0] -= 1
    gearbox.mode(state)[2] = branch(gearbox, state)
    state.yp = gearbox.derivative(state)
    after, events = gearbox.apply(state, name)
    teeth = int(state.integers[1]) + sign
    kind = "tooth_switch" if sign > 0 else "tooth_switch_back"
    assert gearbox.changing(events) == [Event(kind, 0, teeth)]
    assert moved(gearbox, after, state) <= 1
    assert after.integers[1] == teeth
    assert is_consistent(gearbox, after)
    old, new = gearbox.outputs(state), gearbox.outputs(after)
    kept = ("gap", "penetration", "gradient_ratio", "transmission_error", "separation_curvature")
    for output in (*kept, "contact_mode", "kinetic_energy", "potential_energy"):
        # rho_A + rho_B is the sum of two other numbers now; all else is equal
        np.testing.assert_allclose(new[output], old[output], rtol=1e-13, err_msg=output)
    assert new["normal_force"] == pytest.approx(old["normal_force"], rel=1e-13)
    pitch = gearbox.mesh_geometry().base_pitch
    arms = [
        new[f"friction_arm_{n}"][0] - old[f"friction_arm_{n}"][0] for n in ("driving", "driven")
    ]
    np.testing.assert_allclose(arms, [-sign * pitch, sign * pitch], rtol=0, atol=1e-15)
    _, e = Housing(pair, gearbox, state).directions
    jump = -sign * pitch * np.array(e, dtype=float)
    # the tracked normal is that of the line of action to rounding of the displacements
    for n in ("driving", "driven"):
        change = new[f"contact_point_{n}"][0] - old[f"contact_point_{n}"][0]
        np.testing.assert_allclose(change, jump, rtol=0, atol=1e-15)
        if tracking != CLOSED_FORM:
            for output in (f"tracking_residual_{n}", f"line_distance_{n}"):
                assert abs(new[output][0]) <= 1e-17 + 1e-9 * abs(old["gap"][0])
    other = "back" if name == "forward" else "forward"
    again, events = gearbox.apply(after, other)
    assert [event.tooth_pair for event in gearbox.changing(events)] == [teeth - sign]
    assert moved(gearbox, again, state) <= 1
    held = [i for i in range(len(state.integers)) if i not in gearbox.sides]
    np.testing.assert_array_equal(again.integers[held], state.integers[held])


@EVERY_PAIR
@TRACKINGS
def test_the_switch_comes_when_the_driving_wheel_has_turned_by_a_pitch_from_the_centre_line(
    kernel: Kernel, pair: Pair, tracking: str
):
    """Here sigma (phi_A - chi) has changed by one pitch, also with displaced axes."""
    random = np.random.default_rng(3)
    gearbox = pair.gearbox(kernel, tracking=tracking)
    for _ in range(20):
        state = scatter(gearbox, random, displacement=2e-5, gap=1e-5)
        at = Housing(pair, gearbox, state)
        c = at.centre_line
        chi = float(np.arctan2(float(c[1]), float(c[0]))) - pair.chi
        turned = -pair.sigma * (float(at.turn(0)) - (chi + np.pi) % (2 * np.pi) + np.pi)
        pitches = turned / (2 * np.pi / pair.teeth[0]) - state.integers[1]
        # rounding of tens of pitches
        assert gearbox.root(state, "forward") == pytest.approx(pitches - 1, abs=1e-13)
        assert gearbox.root(state, "back") == pytest.approx(pitches + 1, abs=1e-13)
    assert gearbox.root_direction(state, "forward") == 1
    assert gearbox.root_direction(state, "back") == -1


# ---- contact


@EVERY_PAIR
@TRACKINGS
def test_closing_flanks_are_loaded_and_keep_their_approach_speed(
    kernel: Kernel, pair: Pair, tracking: str
):
    random = np.random.default_rng(4)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=FRICTION)
    for _ in range(10):
        h_dot = -1.0
        while h_dot < 0:  # flanks close as they approach
            state = scatter(gearbox, random)
            set_gap(gearbox, state, 0, -1e-18)  # as a root is located: slightly beyond it
            press(gearbox, state, 0, OPEN)
            h_dot = -approach(gearbox, state)
        after, events = gearbox.apply(state, "contact")
        assert events == [Event("contact_closed", 0, int(state.integers[1]))]
        assert gearbox.mode(after)[1] == LOADED
        assert after.reals[0] == pytest.approx(h_dot, rel=1e-9)
        assert gearbox.mode(after)[2] == branch(gearbox, state)
        assert is_consistent(gearbox, after)


def approach(gearbox: Gearbox, state: State) -> float:
    """Return the rate of the gap, by differences of the closed form along the motion."""
    gaps = []
    for step in (1e-6, -1e-6):
        moved = state.copy()
        moved.y = state.y + step * gearbox.derivative(state)
        face(gearbox, moved)
        gaps.append(gearbox.outputs(moved)["gap"][0])
    return (gaps[0] - gaps[1]) / 2e-6


@TRACKINGS
def test_contact_roots_are_zero_where_the_flanks_touch(kernel: Kernel, tracking: str):
    gearbox = paper_gearbox(kernel, tracking=tracking)
    h_0 = gearbox.mesh_geometry().reference_penetration
    for gap in (1e-6, 1e-12, 0.0, -1e-12, -1e-6):
        state = gearbox.start(0, gaps=[gap])
        for mode in (OPEN, LOADED, UNLOADED):
            press(gearbox, state, 0, mode)
            # 1e-10 of h_0 beyond contact, so that no root starts at zero
            past = -1e-10 if mode == OPEN else 1e-10
            assert gearbox.root(state, "contact") == pytest.approx(past - gap / h_0, rel=1e-12)
            assert gearbox.root_direction(state, "contact") == (1 if mode == OPEN else -1)


def test_the_force_root_is_zero_where_elastic_and_viscous_force_cancel(kernel: Kernel):
    gearbox = paper_gearbox(kernel, damping=1e4)
    f_0 = gearbox.mesh_geometry().reference_force
    state = gearbox.start(0, gaps=[-3e-9])
    press(gearbox, state, 0, LOADED)
    elastic = gearbox.outputs(state)["normal_force"][0]
    rate = elastic / 1e4  # h' at which the damper force equals the elastic force
    index = gearbox.index("speed_deviation_1")
    for part in (0.0, 0.5, 1.0, 1.5, 4.0):
        state.y[index] = part * rate / gearbox.wheel_geometry(1).base_radius
        for mode, sign in ((LOADED, 1e-10), (UNLOADED, -1e-10)):
            press(gearbox, state, 0, mode)
            expected = (1 - part) * elastic / f_0 + sign
            assert gearbox.root(state, "force") == pytest.approx(expected, abs=1e-14)
            assert gearbox.root_direction(state, "force") == (-1 if mode == LOADED else 1)
    press(gearbox, state, 0, OPEN)
    assert gearbox.root(state, "force") == 1


DAMPING = 1e4  # [N s/m] equals the elastic force at 1e-9 m of overlap and a separation at 2e-4 m/s
TRANSITIONS = {  # mode, root function, gap [m] and its rate [m/s]; mode afterwards, event
    "the flanks part": (LOADED, "contact", 1e-18, 1e-5, OPEN, "contact_opened"),
    "the damper pulls": (LOADED, "force", -1e-9, 1e-3, UNLOADED, "force_vanished"),
    "it stops pulling": (UNLOADED, "force", -1e-9, 1e-5, LOADED, "force_returned"),
    "they part without force": (UNLOADED, "contact", 1e-18, 1e-3, OPEN, "contact_opened"),
    "the force vanishes as they part": (LOADED, "force", -1e-16, 1e-3, OPEN, "contact_opened"),
    "the force returns as they part": (UNLOADED, "force", -1e-16, 1e-3, OPEN, "contact_opened"),
    "the gap just touches zero": (UNLOADED, "force", -1e-16, 1e-12, LOADED, "force_returned"),
}


@pytest.mark.parametrize(
    ("before", "root", "gap", "rate", "mode", "event"), TRANSITIONS.values(), ids=TRANSITIONS.keys()
)
@TRACKINGS
def test_contact_modes_follow_the_roots(
    kernel: Kernel,
    tracking: str,
    before: int,
    root: str,
    gap: float,
    rate: float,
    mode: int,
    event: str,
):
    gearbox = paper_gearbox(kernel, tracking=tracking, friction=FRICTION, damping=DAMPING)
    state = gearbox.start(SPEEDS, speeds=[-0.3, 0.2], gaps=[gap])
    part(gearbox, state, rate)
    face(gearbox, state)
    press(gearbox, state, 0, before, branch(gearbox, state) if before == LOADED else 0)
    state.reals[0] = 0.125
    after, events = gearbox.apply(state, root)
    assert events == [Event(event, 0, 0)]
    assert gearbox.mode(after)[1] == mode
    assert moved(gearbox, after, state) <= 1
    assert after.reals[0] == 0.125  # the approach speed is that of the last closing
    assert is_consistent(gearbox, after)
    if mode != LOADED:
        assert gearbox.outputs(after)["normal_force"][0] == 0
    else:
        assert gearbox.mode(after)[2] == branch(gearbox, state) != 0


@pytest.mark.parametrize(("share", "mode"), [(3e-12, UNLOADED), (3e-11, LOADED)])
def test_a_force_that_vanished_has_the_digits_of_what_it_is_the_difference_of(
    kernel: Kernel, share: float, mode: int
):
    """The remainder, over the elastic force, some thousand times the reference force: within
    rounding the force has not returned, above it has.
    """
    gearbox = paper_gearbox(kernel, damping=DAMPING)
    f_0 = gearbox.mesh_geometry().reference_force
    state = gearbox.start(0, gaps=[-3e-5])
    press(gearbox, state, 0, LOADED)
    elastic = gearbox.outputs(state)["normal_force"][0]
    assert elastic > 3e3 * f_0
    part(gearbox, state, elastic / DAMPING)
    left = gearbox.root(state, "force") * f_0 / elastic
    part(gearbox, state, (left - share) * elastic / DAMPING)
    left = gearbox.root(state, "force") * f_0 / elastic
    assert left == pytest.approx(share, rel=1e-2)
    after, _ = gearbox.apply(state, "force")
    assert gearbox.mode(after)[1] == mode


# ---- friction


@pytest.mark.parametrize(
    ("branch", "root", "then", "event"),
    [
        (0, "friction_high", 1, "sliding_began"),
        (0, "friction_low", -1, "sliding_began"),
        (1, "friction_high", 0, "sliding_ended"),
        (-1, "friction_low", 0, "sliding_ended"),
    ],
)
@TRACKINGS
def test_branches_of_friction_follow_the_sliding_velocity(
    kernel: Kernel, tracking: str, branch: int, root: str, then: int, event: str
):
    """The root is zero where |v_t| is the knee, friction is the same on both sides of it, and the
    new branch's root is not passed.
    """
    gearbox = paper_gearbox(kernel, tracking=tracking, friction=FRICTION)
    state = gearbox.start(SPEEDS, speeds=[-0.3, 0.2], gaps=[-3e-9])
    knee = KNEE if root == "friction_high" else -KNEE
    index = gearbox.index("reference_speed")
    press(gearbox, state, 0, LOADED, branch)
    for _ in range(3):  # v_t is linear in the speed
        v_t = gearbox.outputs(state)["sliding_velocity"][0]
        state.y[index] *= knee / v_t
    v_t = gearbox.outputs(state)["sliding_velocity"][0]
    assert v_t == pytest.approx(knee, rel=1e-14)
    assert abs(gearbox.root(state, root)) == pytest.approx(1e-10, rel=1e-4)
    assert not has_passed(gearbox, state, root)
    outward = gearbox.root_direction(state, root) * np.sign(knee)
    assert outward == (1 if branch == 0 else -1)
    after, events = gearbox.apply(state, root)
    assert events == [Event(event, 0, 0)]
    assert gearbox.mode(after)[1:].tolist() == [LOADED, then]
    old, new = gearbox.outputs(state)["friction_force"], gearbox.outputs(after)["friction_force"]
    assert new == pytest.approx(old, rel=1e-13)
    assert not has_passed(gearbox, after, root)
    assert is_consistent(gearbox, after)


def test_roots_without_a_meaning_are_one(kernel: Kernel):
    gearbox = paper_gearbox(kernel, tracking=CLOSED_FORM, friction=FRICTION)
    state = gearbox.start(SPEEDS, speeds=[-0.3, 0.2], gaps=[-3e-9])
    press(gearbox, state, 0, OPEN)
    for name in ("force", "friction_high", "friction_low", "apart"):
        assert gearbox.root(state, name) == 1
    press(gearbox, state, 0, LOADED, 1)
    assert gearbox.root(state, "friction_low") == 1
    press(gearbox, state, 0, LOADED, -1)
    assert gearbox.root(state, "friction_high") == 1
    smooth = paper_gearbox(kernel, friction=0.0)
    state = smooth.start(SPEEDS, speeds=[-0.3, 0.2], gaps=[-3e-9])
    press(smooth, state, 0, LOADED)
    assert smooth.root(state, "friction_high") == smooth.root(state, "friction_low") == 1


# ---- flanks too far apart to track


@EVERY_PAIR
@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
def test_tracking_rests_while_the_flanks_are_far_apart_and_begins_anew(
    kernel: Kernel, pair: Pair, tracking: str
):
    random = np.random.default_rng(6)
    gearbox = pair.gearbox(kernel, tracking=tracking)
    geometry = gearbox.mesh_geometry()
    far = (geometry.line_of_action_length - geometry.base_pitch) / 4
    state = scatter(gearbox, random, displacement=1e-7)
    for share in (0.5, 1.0, 1.5):
        set_gap(gearbox, state, 0, share * far)
        press(gearbox, state, 0, OPEN)
        assert gearbox.root(state, "apart") == pytest.approx(share - 1, abs=1e-6)
        assert gearbox.root_direction(state, "apart") == 1
    after, events = gearbox.apply(state, "apart")
    assert events == [Event("flanks_apart", 0, int(state.integers[1]))]
    assert gearbox.mode(after)[1] == APART
    assert moved(gearbox, after, state) <= 1
    assert is_consistent(gearbox, after)
    outputs = gearbox.outputs(after)
    assert outputs["normal_force"][0] == outputs["in_contact"][0] == 0
    assert outputs["gap"][0] == pytest.approx(1.5 * far, rel=1e-6)
    assert np.isnan(outputs["gradient_ratio"][0])
    assert np.isfinite(outputs["contact_point_driven"]).all()
    # meanwhile the wheels move, and the points do not
    track = gearbox.tracked()
    wheel = 1 - pair.reference
    r_b = gearbox.wheel_geometry(wheel).base_radius
    after.y[gearbox.index(f"angle_deviation_{wheel}")] -= pair.sigma * 0.6 * far / r_b
    assert gearbox.root(after, "apart") == pytest.approx(-0.1, abs=1e-6)
    assert gearbox.root_direction(after, "apart") == -1
    np.testing.assert_array_equal(gearbox.derivative(after)[track], 0)
    near, events = gearbox.apply(after, "apart")
    assert events == [Event("flanks_near", 0, int(state.integers[1]))]
    assert gearbox.mode(near)[1] == OPEN
    at = Housing(pair, gearbox, near)
    assert float(at.tracked["mu"] / pair.base_radii[1]) == pytest.approx(float(at.kappa), rel=1e-12)
    assert is_consistent(gearbox, near)
    others = np.delete(near.y, np.r_[track])
    np.testing.assert_array_equal(others, np.delete(after.y, np.r_[track]))


# ---- several at once


@EVERY_PAIR
@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
def test_an_event_puts_tracked_points_back_onto_the_equations(
    kernel: Kernel, pair: Pair, tracking: str
):
    """The integration error in (1) is removed; the wheels do not move."""
    random = np.random.default_rng(10)
    gearbox = pair.gearbox(kernel, tracking=tracking)
    state = in_mode(gearbox, random, (LOADED, 0))
    right = state.y.copy()
    track = gearbox.tracked()
    lost = 1e-12 * np.array([1, 1, 1, 1, 1e3, gearbox.wheel_geometry(1).base_radius])
    state.y[track] += lost * random.uniform(0.5, 1, 6)
    assert abs(gearbox.outputs(state)["tracking_residual_driving"][0]) > 1e-14
    after, _ = gearbox.apply(state)
    before = state.copy()
    before.y = right
    assert moved(gearbox, after, before) <= 1


def test_events_of_several_meshes_at_one_time_are_all_applied(kernel: Kernel):
    gearbox = chain(kernel, 3, DIFFERENTIAL)
    state = in_mode(gearbox, np.random.default_rng(8), (LOADED, 0))
    for m in (0, 1):
        gearbox.mode(state, m)[2] = branch(gearbox, state, m, knee=2e-3)
    press(gearbox, state, 1, UNLOADED)
    teeth = [int(gearbox.mode(state, m)[0]) for m in (0, 1)]
    fired = ("forward", "force")
    after, events = gearbox.apply(state, *fired, contact=1)
    assert {(e.name, e.mesh) for e in events} == {("tooth_switch", 1), ("force_returned", 1)}
    assert gearbox.mode(after, 0).tolist() == gearbox.mode(state, 0).tolist()
    assert gearbox.mode(after, 1)[0] == teeth[1] + 1
    assert gearbox.mode(after, 1)[1] == LOADED


def test_every_kind_of_event_has_a_name_of_its_own(kernel: Kernel):
    names = event_names(kernel)
    assert len(names) == len(set(names)) >= 17
    assert all(name.isidentifier() and name.islower() for name in names)
    assert all(text for _, text in event_kinds(kernel))


def test_the_documentation_lists_every_kind_of_event(kernel: Kernel, root: Path):
    page = root / "docs" / "reference" / "result_format.md"
    text = page.read_text().split("## Group `events`")[1]
    table = re.findall(r"^\| `(\w+)` \| ([^|]+) \|$", text.split("## Attributes")[0], re.MULTILINE)
    assert table == event_kinds(kernel)


def test_every_event_of_an_instant_is_told_however_many_there_are(kernel: Kernel):
    """A train of 40 meshes in which all flanks close, slide and hand over simultaneously."""
    n = 40
    wheels = [wheel(teeth=20, pitch_radius=0.1), *(wheel(teeth=20) for _ in range(n))]
    pairs = [mesh(kernel, m, m + 1, driving_rotation=(-1) ** (m + 1)) for m in range(n)]
    gearbox = Gearbox(kernel, wheels, [], pairs)
    state = gearbox.start(SPEEDS, gaps=[1e-6] * n, speeds=[(-1.0) ** m for m in range(n + 1)])
    indices = [
        at for (_, name), at in gearbox.root_indices.items() if name in {"contact", "forward"}
    ]
    _, events = gearbox.apply_all(state, indices)
    reported = {(event.name, event.mesh) for event in events}
    assert reported >= {("tooth_switch", m) for m in range(n)} | {
        ("contact_closed", m) for m in range(n)
    }
    assert 2 * n <= len(events) <= gearbox.sizes.n_events


def test_every_mesh_has_its_roots_and_there_is_one_for_the_turns(kernel: Kernel):
    for n in (2, 3, 4):
        gearbox = chain(kernel, n, DIFFERENTIAL)
        names = [set(), *(set() for _ in range(n - 1))]
        for contact, name in gearbox.root_indices:
            names[contact + 1].add(name)
        assert names[0] == {"revolution"}
        assert all(mine >= {"contact", "force", "forward", "back"} for mine in names[1:])
        assert len(gearbox.root_indices) == gearbox.sizes.n_roots


Mode = tuple[int, int]  # of the contact, and the branch of friction


class Belonging(NamedTuple):
    """A mode, and a consistent state."""

    mode: Mode
    gap: float  # [m]
    rate: float  # of the gap [m/s]
    speed: float  # of the driving wheel [rad/s]


BELONGING = {
    "open": Belonging((OPEN, 0), 1e-9, 0.0, -0.3),
    "loaded, sliding": Belonging((LOADED, 1), -1e-9, 0.0, -0.3),
    "loaded, sliding the other way": Belonging((LOADED, -1), -1e-9, 0.0, 0.3),
    "loaded, not sliding": Belonging((LOADED, 0), -1e-9, 0.0, -0.001),
    "pulled apart": Belonging((UNLOADED, 0), -1e-9, 1e-3, -0.3),
}
EVERY_BELONGING = pytest.mark.parametrize("belongs", BELONGING.values(), ids=BELONGING.keys())
WRONG = pytest.mark.parametrize(
    "wrong", [(OPEN, 0), (LOADED, 0), (LOADED, 1), (LOADED, -1), (UNLOADED, 0)]
)


@TRACKINGS
@EVERY_BELONGING
def test_an_event_that_did_not_happen_changes_nothing(
    kernel: Kernel, tracking: str, belongs: Belonging
):
    gearbox, state = belonging(kernel, tracking, belongs, belongs.mode)
    state.yp = gearbox.derivative(state)
    after, events = gearbox.apply(state)
    assert events == []
    assert moved(gearbox, after, state) <= 1
    np.testing.assert_array_equal(after.integers, state.integers)
    np.testing.assert_array_equal(after.reals, state.reals)


@TRACKINGS
@WRONG
@EVERY_BELONGING
def test_after_any_event_every_mode_is_the_one_that_belongs_to_the_state(
    kernel: Kernel, tracking: str, belongs: Belonging, wrong: Mode
):
    """For any mode after an event, as at a jump of the slope of the flank or of a speed."""
    gearbox, state = belonging(kernel, tracking, belongs, wrong)
    state.yp = gearbox.derivative(state)
    after, events = gearbox.apply(state)
    contact, friction = belongs.mode
    assert gearbox.mode(after)[1] == contact
    if contact == LOADED:
        assert gearbox.mode(after)[2] == friction
    assert all(not has_passed(gearbox, after, name) for name in CAN_JUMP)
    assert (events == []) == (gearbox.mode(after).tolist() == gearbox.mode(state).tolist())
    assert is_consistent(gearbox, after)


@TRACKINGS
@WRONG
@EVERY_BELONGING
def test_a_mode_that_contradicts_the_state_is_refused(
    kernel: Kernel, tracking: str, belongs: Belonging, wrong: Mode
):
    gearbox, state = belonging(kernel, tracking, belongs, wrong)
    checks = (
        lambda: gearbox.check_modes(state),
        lambda: gearbox.sampled([state], "load_work", check=True),
        lambda: gearbox.sampled([state] * 8, "load_work", check=True),  # at once, in closed form
    )
    for check in checks:
        if wrong == belongs.mode:
            check()
            continue
        with pytest.raises(GearboxError, match=r"tooth pair 0 .*an event was missed") as refused:
            check()
        assert (refused.value.code, refused.value.index) == (OUT_OF_DOMAIN, 0)
        gearbox.values(state)
        gearbox.sampled([state] * 8, "load_work")


CAN_JUMP = ("contact", "force", "friction_high", "friction_low")


def belonging(
    kernel: Kernel, tracking: str, belongs: Belonging, mode: Mode
) -> tuple[Gearbox, State]:
    """Create the paper's gearbox with damping and friction, and a state of it in any mode."""
    gearbox = paper_gearbox(kernel, tracking=tracking, friction=FRICTION, damping=DAMPING)
    speeds = [belongs.speed, -belongs.speed * 20 / 30]
    state = gearbox.start(SPEEDS, speeds=speeds, gaps=[belongs.gap])
    part(gearbox, state, belongs.rate)
    face(gearbox, state)
    press(gearbox, state, 0, *mode)
    return gearbox, state
