"""Tooth pairs that enter and leave: root functions, events, start positions, rejected input."""

from __future__ import annotations

from typing import Any

import mpmath as mp
import numpy as np
import pytest

from kernel.deviations import ROOT, TIP, deviations, relief
from kernel.gearbox import (
    DRIVE,
    LOADED,
    MESH,
    OFF,
    OPEN,
    Event,
    Gearbox,
    GearboxError,
    State,
)
from kernel.gearbox_description import (
    REST,
    SPEEDS,
    STEADY,
    TORQUE,
    VISCOUS,
    load,
)
from kernel.kernel import CONTACT, INVALID_INPUT, Kernel
from kernel.real_cases import GAPS, PAIRS, made, settle_friction
from kernel.real_pairs import RealPair, Teeth

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
PERFECT = pytest.mark.parametrize(
    "pair",
    [pair for pair in PAIRS.values() if not pair.deviates],
    ids=[name for name, pair in PAIRS.items() if not pair.deviates],
)


def slot(pair: RealPair, flank: int, number: int) -> int:
    """Tooth contact that contains a tooth pair."""
    return flank * pair.slots + number % pair.slots


def passed(gearbox: Gearbox, state: State) -> list[int]:
    """Active root functions (others are 1) that are already beyond zero in an active direction."""
    values, directions = gearbox.roots(state), gearbox.root_directions(state)
    return [int(i) for i in np.flatnonzero((values * directions > 0) & (values != 1))]


# ---- root functions


@EVERY_PAIR
@pytest.mark.parametrize("gap", GAPS.values(), ids=GAPS.keys())
def test_no_root_is_passed_where_pairs_are_where_they_belong(
    kernel: Kernel, pair: RealPair, gap: float
):
    for seed in range(4):
        gearbox, teeth = made(kernel, pair, gap, 50 + seed)
        gearbox.take_sides(teeth.state)
        found = passed(gearbox, teeth.state)
        # overlapping flanks may be held apart by the damper: only the force's root is passed
        force = {at for (_, name), at in gearbox.root_indices.items() if name == "force"}
        assert force.issuperset(found)


@EVERY_PAIR
def test_the_ends_of_the_path_are_where_the_tips_are(kernel: Kernel, pair: RealPair):
    """Distances from both ends in pitches, of pairs on the path and of those before it."""
    for seed, gap in enumerate(GAPS.values()):
        gearbox, teeth = made(kernel, pair, gap, 60 + seed)
        _, _, rho = teeth.line(teeth.q)
        for contact in teeth.contacts:
            from_a, from_b = (
                float((tip - r) / pair.base_pitch)
                for tip, r in zip(pair.rho_tips, contact.rho, strict=True)
            )
            # the driving wheel's tip leaves last on the drive flank and enters first on the other
            forward, back = (from_a, from_b) if contact.flank == DRIVE else (from_b, from_a)
            at = slot(pair, contact.flank, contact.number)
            # rounding of the angle of some revolutions, and the offset of the roots
            assert gearbox.root(teeth.state, "forward", at) == pytest.approx(forward, abs=2e-10)
            assert gearbox.root(teeth.state, "back", at) == pytest.approx(back, abs=2e-10)
            assert gearbox.root_direction(teeth.state, "forward", at) == -1
            assert gearbox.root_direction(teeth.state, "back", at) == -1
        for at in range(2 * pair.slots):
            if gearbox.mode(teeth.state, at)[1] != OFF:
                continue
            number, flank = int(gearbox.mode(teeth.state, at)[0]), at // pair.slots
            first = teeth.first_radius(flank)
            radius = first - (number if flank == DRIVE else -number) * pair.base_pitch
            gap_now = min((c.gap for c in teeth.contacts if c.flank == flank), default=None)
            if gap_now is None or pair.deviates:
                continue
            other = rho - gap_now - radius  # of B, the gap being that of every pair
            entering = pair.rho_tips[1] - other if flank == DRIVE else pair.rho_tips[0] - radius
            back = gearbox.root(teeth.state, "back", at)
            assert back < 0
            assert back == pytest.approx(float(entering / pair.base_pitch), abs=2e-10)
            assert gearbox.root_direction(teeth.state, "back", at) == 1
            assert gearbox.root_direction(teeth.state, "forward", at) == 1
            assert gearbox.root(teeth.state, "forward", at) < 0


@pytest.mark.parametrize("name", [name for name, pair in PAIRS.items() if pair.deviates])
def test_the_borders_of_reliefs_are_located(kernel: Kernel, name: str):
    pair = PAIRS[name]
    seen = set()
    for seed in range(6):
        gearbox, teeth = made(kernel, pair, GAPS["drive"], 70 + seed)
        for contact in teeth.contacts:
            at = slot(pair, contact.flank, contact.number)
            for i, wheel_name in enumerate("ab"):
                formula = pair.formulas[i]
                for part, zone in (("tip", TIP), ("root", ROOT)):
                    given = formula.relief(zone)
                    root = f"{part}_{wheel_name}"
                    value = gearbox.root(teeth.state, root, at)
                    if given is None or contact.zones[i] == -zone:
                        assert value == 1
                        continue
                    border = formula.start(given)
                    beyond = float((contact.rho[i] - border) / pair.base_pitch)
                    assert value == pytest.approx(beyond, abs=2e-10)
                    inside = contact.zones[i] == zone
                    assert gearbox.root_direction(teeth.state, root, at) == (
                        -zone if inside else zone
                    )
                    seen.add((root, inside))
                    after, events = gearbox.apply(teeth.state, root, contact=at)
                    flank = contact.flank
                    # the branch of the other zone is far off here; its effects are corrected, too
                    assert events[0] == Event("profile_border", 0, contact.number, flank)
                    zones = gearbox.mode(after, at)[3:].tolist()
                    expected = list(contact.zones)
                    expected[i] = 0 if inside else zone
                    assert zones == expected
    assert {("tip_a", True), ("tip_a", False), ("tip_b", False)} <= seen


# ---- events


def at_the_end(kernel: Kernel, pair: RealPair, forward: bool) -> tuple[Gearbox, Teeth, int]:
    """State with the drive flanks' first pair on the path almost at one of its ends."""
    gearbox, teeth = made(kernel, pair, -6e-5, 80)  # deep enough for flanks with deviations
    contacts = [c for c in teeth.contacts if c.flank == DRIVE]
    contact = min(contacts, key=lambda c: c.number if forward else -c.number)
    wheel_index = 0 if forward else 1
    missing = pair.rho_tips[wheel_index] - contact.rho[wheel_index]
    # as it turns, rho_A grows and rho_B falls, each by the arc of its base circle
    sign = -pair.sigma if forward else pair.sigma
    driving = sign * float((missing - mp.mpf("1e-14")) / pair.base_radii[0])
    ratio = 1.0 if pair.reference == 0 else -pair.teeth[0] / pair.teeth[1]
    state = teeth.state.copy()
    angle = state.y[gearbox.index("reference_angle")] + driving * ratio
    turns = int(angle / (2 * np.pi))
    state.y[gearbox.index("reference_angle")] = angle - 2 * np.pi * turns
    state.integers[0] += turns
    there = Teeth(pair, gearbox, state)
    there.settle()
    settle_friction(pair, there)
    state.yp = gearbox.derivative(state)
    return gearbox, there, contact.number


@EVERY_PAIR
@pytest.mark.parametrize("forward", [True, False], ids=["on", "back"])
def test_a_pair_that_leaves_takes_its_energy_and_no_other_force_with_it(
    kernel: Kernel, pair: RealPair, forward: bool
):
    gearbox, teeth, number = at_the_end(kernel, pair, forward)
    at = slot(pair, DRIVE, number)
    name = "forward" if forward else "back"
    state = teeth.state
    assert gearbox.root(state, name, at) == pytest.approx(0, abs=2e-10)
    assert gearbox.mode(state, at)[1] == LOADED
    before = gearbox.outputs(state)
    after, events = gearbox.apply(state, name, contact=at)
    assert events == [Event("pair_left", 0, number, DRIVE)]
    mode = gearbox.mode(after, at)
    assert mode[1] == OFF
    assert mode[0] == number + (pair.slots if forward else 0)  # the next to enter at the start
    now = gearbox.outputs(after)
    others = np.arange(gearbox.sizes.n_pair_slots) != at
    for output in ("pair_normal_force", "pair_friction_force"):
        np.testing.assert_array_equal(now[output][0, others], before[output][0, others])
        assert now[output][0, at] == 0
    assert before["pair_normal_force"][0, at] > 0
    taken = before["potential_energy"][0] - now["potential_energy"][0]
    booked = now["dissipated_energy"][0] - before["dissipated_energy"][0]
    assert taken > 0
    assert booked == pytest.approx(taken, rel=1e-12)
    np.testing.assert_array_equal(after.y[:-2], state.y[:-2])
    # the slot may be entered again at the same end, with the original state
    again, events = gearbox.apply(after, name, contact=at)
    assert events == [Event("pair_entered", 0, number, DRIVE)]
    assert gearbox.mode(again, at)[:2].tolist() == [number, LOADED]
    back = gearbox.outputs(again)
    np.testing.assert_allclose(
        back["pair_normal_force"][0, at], before["pair_normal_force"][0, at], rtol=1e-12
    )
    assert back["dissipated_energy"][0] == pytest.approx(before["dissipated_energy"][0], abs=1e-15)


def test_a_pair_that_enters_with_a_gap_is_open(kernel: Kernel):
    pair = PAIRS["standard"]
    gearbox, teeth = made(kernel, pair, GAPS["between"], 3)
    at = next(c for c in range(pair.slots) if gearbox.mode(teeth.state, c)[1] == OFF)
    number = int(gearbox.mode(teeth.state, at)[0])
    after, events = gearbox.apply(teeth.state, "back", contact=at)
    assert events == [Event("pair_entered", 0, number, DRIVE)]
    assert gearbox.mode(after, at)[1] == OPEN
    assert after.y[-2] == teeth.state.y[-2]


# ---- the start


@pytest.mark.parametrize("ratio", [0.8, 0.999, 1.2, 1.755, 2.0, 2.4, 3.0, 3.7, 4.0])
@pytest.mark.parametrize("sigma", [1, -1])
@pytest.mark.parametrize("gap", [0.0, 3e-5, 1e-4])
def test_every_pair_on_the_path_is_there_at_the_start(
    kernel: Kernel, ratio: float, sigma: int, gap: float
):
    high = ratio > 1.6
    pair = RealPair(
        **{"teeth": (150, 160) if high else (60, 70), "ratio": ratio, "sigma": sigma},
        **{"pressure_angle": float(np.radians(12 if high else 20)), "fixed": True},
        **{"dedendum": 1.8 if high else 1.25, "module": 2e-3, "backlash": 1e-4},
    )
    gearbox = pair.gearbox(kernel, (load(0, TORQUE, -1.0 * sigma),))
    state = gearbox.start(REST, gaps=[gap])
    teeth = Teeth(pair, gearbox, state)
    o = gearbox.outputs(state)
    on_path = o["pair_on_path"][0] == 1
    found = {
        (at // pair.slots, int(o["pair_tooth_driving"][0, at]), int(o["pair_tooth_driven"][0, at]))
        for at in np.flatnonzero(on_path)
    }
    # a pair within rounding of an end of the path may count as on it or not
    margin = mp.mpf(10) ** -12
    expected = {(c.flank, *c.teeth) for c in teeth.contacts if inside(pair, c, margin)}
    assert expected <= found
    assert len(found - expected) <= 2 * (abs(ratio - round(ratio)) < 1e-9 or gap < 1e-12) + 1
    assert passed(gearbox, state) == []
    assert gearbox.sizes.n_drive_slots == pair.slots


def inside(pair: RealPair, contact: Any, margin: mp.mpf) -> bool:
    return all(r < t - margin for r, t in zip(contact.rho, pair.rho_tips, strict=True))


def test_a_pair_whose_contact_ratio_is_below_1_starts_where_a_pair_is_on_the_path(kernel: Kernel):
    pair = RealPair(ratio=0.8, fixed=True)
    gearbox = pair.gearbox(kernel, (load(0, TORQUE, -1.0), load(1, VISCOUS, 0.1)))
    assert gearbox.outputs(gearbox.start(STEADY))["pairs_in_contact"][0] == 1
    with pytest.raises(GearboxError) as caught:
        gearbox.start(STEADY, mesh_position=0.9)
    assert "contact ratio 0.8 is on the path" in caught.value.message
    assert gearbox.start(SPEEDS, speeds=(0.0, 0.0))


# ---- rejected input


def refusal(kernel: Kernel, pair: RealPair, **fields: Any) -> GearboxError:
    with pytest.raises(GearboxError) as caught:
        pair.gearbox(kernel, (load(0, TORQUE, -1.0),), **fields)
    assert caught.value.code == INVALID_INPUT
    assert "\n" not in caught.value.message
    return caught.value


@pytest.mark.parametrize(
    ("pair", "words"),
    [
        (RealPair(backlash=0.0), "need backlash"),
        (RealPair(ratio=0.8), "contact ratio of at least 1, but that of this mesh is 0.8"),
        (RealPair(deviations=(deviations(runout_amount=1e-6), None)), "deviations"),
    ],
    ids=["no backlash", "contact ratio", "deviations"],
)
def test_rigid_flanks_are_refused_where_they_would_overlap(
    kernel: Kernel, pair: RealPair, words: str
):
    rigid = kernel.law(CONTACT, "rigid")
    error = refusal(kernel, pair, contact=rigid, damping=None)
    assert (error.subject, error.index, error.field) == (MESH, 0, "contact.law")
    assert words in error.message


def test_a_warning_names_the_smallest_radius_of_curvature_at_either_end_of_the_path(
    kernel: Kernel,
):
    """The tip of the large driving wheel uses the flank of the small driven one down to 1 mm."""
    pair = RealPair(teeth=(60, 20), fixed=True)
    gearbox = pair.gearbox(kernel, (load(0, TORQUE, -2e4), load(1, TORQUE, -2e4 / 3)))
    least = float(pair.rho_0 - max(pair.rho_tips))
    assert least < float(pair.rho_0 - min(pair.rho_tips))
    (warning,) = [w.message for w in gearbox.warnings() if "contact strip" in w.message]
    assert f"smallest radius of curvature {least:.6g}"[:42] in warning


def test_a_relief_reaches_the_flank_that_it_belongs_to(kernel: Kernel):
    """Only pairs near the tip of the relieved wheel have a deviation."""
    relieved = deviations(tip_relief=relief(10e-6, diameter=0.0592))
    pair = RealPair(deviations=(relieved, None), fixed=True)
    gearbox = pair.gearbox(kernel, (load(0, TORQUE, -1.0),))
    start = gearbox.outputs(gearbox.start())
    assert start["flank_deviation"][0] == 0  # the pair that has just entered is nearest
    assert start["gap"][0] == 0
