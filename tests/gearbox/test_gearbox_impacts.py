"""Impacts of rigid contacts: momentum, energy, simultaneous impacts, effects of speed jumps."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.gearbox import LOADED, MESH, OPEN, Event, Gearbox
from kernel.gearbox_cases import PAIRS
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEED,
    SPEEDS,
    TORQUE,
    load,
    mesh,
    wheel,
)
from kernel.housing import Pair
from kernel.kernel import SINGULAR, Kernel
from kernel.rigid_cases import (
    FRICTION,
    KNEE,
    Bodies,
    approaching,
    close,
    fire,
    friction_of,
    refusal,
    rigid,
    rigid_train,
)

TRACKINGS = pytest.mark.parametrize(
    "tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL], ids=["closed", "algebraic", "differential"]
)
FLANKS = pytest.mark.parametrize("sigma", [1, -1])
FREE = {name: pair for name, pair in PAIRS.items() if pair.reference == 0}  # no prescribed speed
EVERY_PAIR = pytest.mark.parametrize("pair", FREE.values(), ids=FREE.keys())
RESTITUTIONS = pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])


# ---- one impact


@EVERY_PAIR
@TRACKINGS
@RESTITUTIONS
def test_an_impact_is_newtons_with_the_friction_of_its_instant(
    kernel: Kernel, pair: Pair, tracking: str, restitution: float
):
    """kappa' changes to -e times itself; wheels and axes get P times the force per unit F_n."""
    random = np.random.default_rng(1)
    fields = {"tracking": tracking, "friction": FRICTION, **rigid(kernel, restitution)}
    gearbox = pair.gearbox(kernel, **fields)
    bodies = Bodies(gearbox, [5.0, 5.0])
    for size in (1e-5, 1e-3, 0.1):
        state = approaching(gearbox, random, [size])
        after, events = close(gearbox, state, 0)
        if restitution > 0:
            assert events == [Event("impact", 0, 0)]
        else:
            assert events[0] == Event("contact_closed", 0, 0)
        before = bodies.speeds(state)
        gap, force = bodies.directions(0, friction_of(gearbox, state), state)
        assert gap @ before == pytest.approx(-size, rel=1e-10)
        impulse = (1 + restitution) * size / (gap @ (force / bodies.masses))
        expected = before + impulse * force / bodies.masses
        changes = abs(impulse * force / bodies.masses)
        # momentum of every body; rounding of the speeds beside 1e-10 of their change
        error = abs(bodies.speeds(after) - expected)
        assert (error <= 1e-10 * changes + 1e-15 * abs(before)).all()
        assert gearbox.outputs(after)["gap_rate"][0] == pytest.approx(
            restitution * size, rel=1e-10, abs=1e-16
        )


@TRACKINGS
@RESTITUTIONS
def test_an_impact_without_friction_loses_what_its_restitution_says(
    kernel: Kernel, tracking: str, restitution: float
):
    """(1 - e^2)/2 m v^2, m the effective mass of the gap; the loss counts as dissipated."""
    random = np.random.default_rng(2)
    fields = {"tracking": tracking, "friction": 0.0, **rigid(kernel, restitution)}
    gearbox = PAIRS["tilted"].gearbox(kernel, **fields)
    bodies = Bodies(gearbox, [5.0, 5.0])
    state = approaching(gearbox, random, [0.1])
    after, _ = close(gearbox, state, 0)
    gap, force = bodies.directions(0, 0.0, state)
    np.testing.assert_allclose(force, gap, rtol=1e-15)
    mass = 1 / (gap @ (gap / bodies.masses))
    loss = (1 - restitution**2) / 2 * mass * 0.1**2
    lost = bodies.energy(state) - bodies.energy(after)
    rounding = 1e-14 * bodies.energy(state)
    assert lost == pytest.approx(loss, rel=1e-10, abs=rounding)
    dissipated = gearbox.outputs(after)["dissipated_energy"]
    assert float(dissipated[0]) == pytest.approx(loss, rel=1e-10, abs=rounding)


@FLANKS
def test_an_impact_between_a_prescribed_and_a_free_wheel_moves_the_free_one(
    kernel: Kernel, sigma: int
):
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    description = mesh(kernel, driving_rotation=-sigma, friction=0.0, **rigid(kernel, 0.5))
    gearbox = Gearbox(kernel, wheels, [load(1, SPEED, 2.0 * sigma)], [description])
    radii = [gearbox.wheel_geometry(i).base_radius for i in (0, 1)]
    approach = 1e-3
    first = -sigma * (approach + radii[1] * 2.0) / radii[0]
    state = gearbox.start(SPEEDS, [first, 2.0 * sigma])
    after, events = close(gearbox, state, 0)
    assert [event.name for event in events] == ["impact"]
    speeds = gearbox.outputs(after)["angular_velocity"]
    assert speeds[1] == pytest.approx(2.0 * sigma, rel=1e-15)
    change = 1.5 * approach * sigma / radii[0]
    assert speeds[0] - first == pytest.approx(change, rel=1e-9)  # 1e-3 of the speed


@pytest.mark.parametrize("rest_velocity", [1e-6, 1e-3])
@pytest.mark.parametrize("share", [0.5, 1 - 1e-6, 1 + 1e-6, 2.0])
def test_an_approach_rebounds_if_it_is_faster_than_the_rest_velocity(
    kernel: Kernel, rest_velocity: float, share: float
):
    random = np.random.default_rng(10)
    fields = {"friction": 0.0, **rigid(kernel, 0.5, rest_velocity)}
    gearbox = PAIRS["tilted"].gearbox(kernel, **fields)
    state = approaching(gearbox, random, [share * rest_velocity])
    after, events = close(gearbox, state, 0)
    names = [event.name for event in events]
    assert ("impact" in names) == (share > 1)
    assert ("impacts_ended" in names) == (share < 1)
    rate = gearbox.outputs(after)["gap_rate"][0]
    # the flanks separate at half the approach, or not at all; rounding of speeds of 0.1 m/s
    expected = 0.5 * share * rest_velocity if share > 1 else 0.0
    assert rate == pytest.approx(expected, rel=1e-6, abs=1e-16)


@pytest.mark.parametrize(("approach", "mode"), [(1e-7, LOADED), (1e-5, OPEN)])
def test_a_rebound_that_the_load_ends_before_it_can_be_seen_is_none(
    kernel: Kernel, approach: float, mode: int
):
    """They separate faster than rest_velocity, and return: events are located to 1e-15 m or so."""
    wheels = [wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)), wheel(teeth=30)]
    fields = {"friction": 0.0, **rigid(kernel, 0.5, 1e-10)}
    gearbox = Gearbox(kernel, wheels, [load(0, TORQUE, -300.0)], [mesh(kernel, **fields)])
    state = gearbox.start()
    gearbox.mode(state, 0)[1] = OPEN
    speed = approach / gearbox.wheel_geometry(1).base_radius
    state.y[gearbox.index("speed_deviation_1")] -= gearbox.mesh_geometry(0).sigma * speed
    after, events = close(gearbox, state, 0)
    assert events[0].name == "impact"
    assert gearbox.mode(after, 0)[1] == mode
    parts = 0.0 if mode == LOADED else approach / 2
    assert gearbox.outputs(after)["gap_rate"][0] == pytest.approx(parts, rel=1e-9, abs=1e-20)
    wheel_a = gearbox.wheel_geometry(0)
    bend = 300.0 * wheel_a.base_radius / wheel_a.inertia
    height = (approach / 2) ** 2 / (2 * bend)
    assert height < 1e-16 if mode == LOADED else height > 1e-13


# ---- several contacts


@pytest.mark.parametrize("restitutions", [(0.5, 0.8), (0.0, 0.7), (1.0, 1.0), (0.0, 0.0)])
@TRACKINGS
@FLANKS
def test_contacts_that_close_at_once_are_solved_together(
    kernel: Kernel, restitutions: tuple[float, float], tracking: str, sigma: int
):
    random = np.random.default_rng(3)
    gearbox = rigid_train(kernel, 3, tracking, sigma, restitutions)
    bodies = Bodies(gearbox, [2.0, 3.0, 4.0])
    sizes = [1e-3, 2e-3]
    state = approaching(gearbox, random, sizes)
    after, events = close(gearbox, state, 0, 1)
    for m, e in enumerate(restitutions):
        assert Event("impact" if e > 0 else "contact_closed", m, 0) in events
    rates = gearbox.outputs(after)["gap_rate"]
    expected = np.array(restitutions) * sizes
    np.testing.assert_allclose(rates, expected, rtol=1e-10, atol=1e-16)
    pairs = [bodies.directions(m, friction_of(gearbox, state, m), state) for m in (0, 1)]
    response = [[gap @ (force / bodies.masses) for _, force in pairs] for gap, _ in pairs]
    impulses = np.linalg.solve(response, (1 + np.array(restitutions)) * sizes)
    change = sum(
        impulse * force / bodies.masses for impulse, (_, force) in zip(impulses, pairs, strict=True)
    )
    moved = bodies.speeds(after) - bodies.speeds(state)
    np.testing.assert_allclose(moved, change, rtol=0, atol=1e-10 * abs(change).max())


@TRACKINGS
def test_a_closed_contact_stays_closed_while_another_one_is_struck(kernel: Kernel, tracking: str):
    """The momentum passes through it: its own impulse maintains kappa' = 0."""
    random = np.random.default_rng(4)
    gearbox = rigid_train(kernel, 3, tracking, 1, (0.0, 0.6))
    bodies = Bodies(gearbox, [2.0, 3.0, 4.0])
    state = approaching(gearbox, random, [0.0, 1e-3])
    gearbox.mode(state, 0)[1] = LOADED
    state.y[gearbox.index("multiplier_0")] = 1.0
    sliding = gearbox.outputs(state)["sliding_velocity"][0]
    gearbox.mode(state, 0)[2] = 0 if abs(sliding) <= KNEE else np.sign(sliding)
    after, events = close(gearbox, state, 1)
    assert Event("impact", 1, 0) in events
    pairs = [bodies.directions(m, friction_of(gearbox, state, m), state) for m in (0, 1)]
    response = [[gap @ (force / bodies.masses) for _, force in pairs] for gap, _ in pairs]
    impulses = np.linalg.solve(response, [0.0, 1.6e-3])
    assert impulses.min() > 0  # otherwise it would have opened
    change = sum(
        impulse * force / bodies.masses for impulse, (_, force) in zip(impulses, pairs, strict=True)
    )
    moved = bodies.speeds(after) - bodies.speeds(state)
    np.testing.assert_allclose(moved, change, rtol=0, atol=1e-10 * abs(change).max())
    rates = gearbox.outputs(after)["gap_rate"]
    assert rates[1] == pytest.approx(0.6e-3, rel=1e-10)
    assert abs(rates[0]) <= 1e-18


@pytest.mark.parametrize("left", [1e-12, -1e-12])
def test_what_a_located_event_leaves_of_the_gap_is_taken_out(kernel: Kernel, left: float):
    """For both contacts that close: the second gap is that after the first correction."""
    gearbox = rigid_train(kernel, 3, CLOSED_FORM, 1, (0.0, 0.0))
    state = approaching(gearbox, np.random.default_rng(6), [1e-4, 1e-4])
    for m in (0, 1):
        turn = gearbox.mesh_geometry(m).sigma * left / gearbox.wheel_geometry(m + 1).base_radius
        state.y[gearbox.index(f"angle_deviation_{m + 1}")] += turn
    assert abs(gearbox.outputs(state)["gap"]).max() > 9e-13
    after, _ = close(gearbox, state, 0, 1)
    values = gearbox.outputs(after)
    assert abs(values["gap"]).max() <= 1e-17  # rounding beside the displacements of the axes
    assert abs(values["gap_rate"]).max() <= 1e-17


def test_a_contact_that_would_have_to_pull_opens_with_an_event(kernel: Kernel):
    """Two wheels drive the middle one: an impact from one carries it away from the other."""
    random = np.random.default_rng(5)
    gearbox = rigid_train(kernel, 3, restitutions=(0.0, 0.5), outer_drive=True, friction=0.0)
    bodies = Bodies(gearbox, [2.0, 3.0, 4.0])
    state = approaching(gearbox, random, [0.0, 1e-3])
    gearbox.mode(state, 0)[1] = LOADED
    state.y[gearbox.index("multiplier_0")] = 1.0
    gap, force = bodies.directions(1, 0.0, state)
    first, _ = bodies.directions(0, 0.0, state)
    assert first @ (force / bodies.masses) > 0  # the impact separates the flanks of the first mesh
    after, events = close(gearbox, state, 1)
    happened = [(event.name, event.mesh) for event in gearbox.changing(events)]
    assert happened == [("contact_opened", 0), ("impact", 1)]
    change = 1.5e-3 / (gap @ (force / bodies.masses)) * force / bodies.masses
    moved = bodies.speeds(after) - bodies.speeds(state)
    np.testing.assert_allclose(moved, change, rtol=0, atol=1e-10 * abs(change).max())
    assert gearbox.mode(after, 0)[1] == OPEN
    assert after.y[gearbox.index("multiplier_0")] == 0


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_flank_that_its_load_presses_stays_closed_if_it_parts_slower_than_the_rest_velocity(
    kernel: Kernel, share: float
):
    """As above, now with a torque that would close the gap again."""

    def struck(rest_velocity: float) -> tuple[float, int, list[str]]:
        options = {"outer_drive": True, "friction": 0.0, "rest_velocity": rest_velocity}
        sense = rigid_train(kernel, 3, restitutions=(0.0, 0.5), outer_drive=True).mesh_geometry()
        gearbox = rigid_train(
            *(kernel, 3),
            **{"restitutions": (0.0, 0.5), "loads": (load(0, TORQUE, -50.0 * sense.sigma),)},
            **options,
        )
        state = approaching(gearbox, np.random.default_rng(5), [0.0, 1e-3])
        gearbox.mode(state, 0)[1] = LOADED
        state.y[gearbox.index("multiplier_0")] = 1.0
        after, events = close(gearbox, state, 1)
        names = [event.name for event in events if event.mesh == 0]
        return float(gearbox.outputs(after)["gap_rate"][0]), int(gearbox.mode(after, 0)[1]), names

    parting, mode, _ = struck(1e-12)
    assert mode == OPEN
    assert 1e-6 < parting < 0.9e-3  # below the approach in the other mesh, which rebounds
    rate, mode, names = struck(parting / share)
    if share < 1:
        assert mode == LOADED
        assert abs(rate) <= 1e-17
        assert names[-1] == "contact_closed"
    else:
        assert mode == OPEN
        assert rate == pytest.approx(parting, rel=1e-12)


def test_of_two_contacts_that_close_at_once_none_pulls(kernel: Kernel):
    """The stronger impact moves the middle wheel away from the weaker one, without effect."""
    random = np.random.default_rng(6)
    gearbox = rigid_train(kernel, 3, restitutions=(0.5, 0.5), outer_drive=True, friction=0.0)
    bodies = Bodies(gearbox, [2.0, 3.0, 4.0])
    state = approaching(gearbox, random, [1e-6, 1e-3])
    after, events = close(gearbox, state, 0, 1)
    assert [(event.name, event.mesh) for event in events] == [("impact", 1)]
    gap, force = bodies.directions(1, 0.0, state)
    change = 1.5e-3 / (gap @ (force / bodies.masses)) * force / bodies.masses
    moved = bodies.speeds(after) - bodies.speeds(state)
    np.testing.assert_allclose(moved, change, rtol=0, atol=1e-10 * abs(change).max())
    assert gearbox.outputs(after)["gap_rate"][0] > 0
    assert gearbox.mode(after, 0)[1] == OPEN


# ---- effects of the jump of the speeds


@pytest.mark.parametrize("elastic", [False, True], ids=["rigid neighbour", "elastic neighbour"])
def test_an_impact_chooses_the_branches_of_friction_anew(kernel: Kernel, elastic: bool):
    """In every loaded mesh: on the old branch friction could exceed f F_n."""
    random = np.random.default_rng(7)
    gearbox = rigid_train(kernel, 3, restitutions=(None if elastic else 0.0, 0.5))
    state = approaching(gearbox, random, [0.0, 0.2])
    gearbox.mode(state, 0)[1] = LOADED
    before = gearbox.outputs(state)["sliding_velocity"][0]
    gearbox.mode(state, 0)[2] = 0 if abs(before) <= KNEE else np.sign(before)
    after, _ = close(gearbox, state, 1)
    values = gearbox.outputs(after)
    for m in (0, 1):
        if gearbox.mode(after, m)[1] != LOADED:
            continue
        v_t = values["sliding_velocity"][m]
        assert gearbox.mode(after, m)[2] == (0 if abs(v_t) <= KNEE else np.sign(v_t))
    friction, normal = values["friction_force"][0], values["normal_force"][0]
    assert abs(friction) <= FRICTION[0] * normal * (1 + 1e-12)
    assert np.sign(before) != np.sign(values["sliding_velocity"][0]) or abs(before) < KNEE


def test_an_impact_clips_the_force_of_an_elastic_neighbour_that_would_pull(kernel: Kernel):
    """Its damper has the jump of h'; without the clip its root would already be passed."""
    random = np.random.default_rng(8)
    gearbox = rigid_train(kernel, 3, restitutions=(None, 0.5), outer_drive=True, friction=0.0)
    state = approaching(gearbox, random, [0.0, 0.2])
    sigma = gearbox.mesh_geometry().sigma
    state.y[gearbox.index("angle_deviation_1")] -= (
        sigma * 1e-9 / gearbox.wheel_geometry(1).base_radius
    )
    gearbox.mode(state, 0)[1] = LOADED
    assert gearbox.outputs(state)["normal_force"][0] > 0
    after, events = close(gearbox, state, 1)
    assert Event("force_vanished", 0, 0) in events
    assert gearbox.outputs(after)["normal_force"][0] == 0
    assert gearbox.root(after, "force") * gearbox.root_direction(after, "force") < 0


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_no_event_overflows_its_room(kernel: Kernel, restitution: float):
    """Also if all roots fire simultaneously."""
    random = np.random.default_rng(9)
    gearbox = rigid_train(kernel, 4, DIFFERENTIAL, 1, (restitution,) * 3)
    for sizes in ([1e-3] * 3, [1e-9] * 3, [-1e-3] * 3):
        state = approaching(gearbox, random, sizes)
        roots = np.ones(gearbox.sizes.n_roots)
        forward = [at for (_, name), at in gearbox.root_indices.items() if name == "forward"]
        roots[forward] = 0  # a mesh cannot switch both ways
        _, events = fire(gearbox, state, roots)
        assert 3 <= len(events) <= gearbox.sizes.n_events


# ---- no solution


def test_friction_that_holds_the_flanks_fast_is_diagnosed(kernel: Kernel):
    """f l_B > r_bB on approach with a light driven wheel: G M^-1 D < 0, no separating impulse."""
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)),
        wheel(teeth=30, inertia=1e-3),
    ]
    description = mesh(kernel, friction=(8.0, KNEE), **rigid(kernel, 0.5))
    gearbox = Gearbox(kernel, wheels, [], [description])
    bodies = Bodies(gearbox, [0.0, 0.0])
    state = gearbox.start(SPEEDS, [-1.0, 0.5])
    gap, force = bodies.directions(0, friction_of(gearbox, state, f=8.0), state)
    assert gap @ (force / bodies.masses) < 0
    error = refusal(lambda: gearbox.apply(state, "contact"))
    assert (error.code, error.subject, error.index, error.field) == (SINGULAR, MESH, 0, "friction")
    assert "the rigid contact jams by friction" in error.message
