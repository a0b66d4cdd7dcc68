"""Both flanks: rattle across the backlash, torque reversal, start from a gap, mirror images."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.real_cases import base_radius, real_pair, torque, viscous
from system.runs import Run

BACKLASH = 4e-5
TEETH = (20, 30)
BASE_A, BASE_B = (base_radius(z) for z in TEETH)
INERTIA_A, INERTIA_B = 2e-3, 6e-3
MASS = 1 / (BASE_A**2 / INERTIA_A + BASE_B**2 / INERTIA_B)  # along the line of action


def broken_invariants(run: Run) -> list[str]:
    return [verdict.invariant.name for verdict in check_history(run.history) if verdict.failed]


def wheels(load_a: dict[str, Any], load_b: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Wheels of given inertia with their loads."""
    return (
        {"inertia": INERTIA_A, "centre": [0, 0], **load_a},
        {"inertia": INERTIA_B, **load_b},
    )


def speeds(events: Any, side: str) -> np.ndarray:
    """Angular velocities of both wheels at every event, (event, 2)."""
    at = events.sel(side=side)
    pinion = at["reference_speed"].values
    return np.stack([pinion, -pinion * TEETH[0] / TEETH[1] + at["speed_deviation_1"].values], 1)


def approach(omega: np.ndarray) -> np.ndarray:
    """Rate at which the drive flanks approach each other."""
    return -(BASE_A * omega[:, 0] + BASE_B * omega[:, 1])


def momentum(omega: np.ndarray) -> np.ndarray:
    """Momentum that contacts preserve [N s]: they give each wheel a torque of F r_b."""
    return INERTIA_A * omega[:, 0] / BASE_A - INERTIA_B * omega[:, 1] / BASE_B


def energy(omega: np.ndarray) -> np.ndarray:
    """Kinetic energy [J]."""
    return (INERTIA_A * omega[:, 0] ** 2 + INERTIA_B * omega[:, 1] ** 2) / 2


# ---- rattle

DRAG, SHAKE, CYCLE = 0.05, 1.5, 4e-3  # [N m], [N m], [s]


def rattle(contact: dict[str, Any], damping: dict[str, Any], **simulation: Any) -> dict[str, Any]:
    """Return a lightly loaded gear driven by a pinion with fluctuating torque and speed."""
    times = [CYCLE / 2 * k for k in range(16)]
    shake = {"kind": "table", "time": times, "torque": [SHAKE * (-1) ** (k + 1) for k in range(16)]}
    start = {"kind": "speeds", "speeds": {"pinion": -60.0, "gear": 40.0}}
    return real_pair(
        TEETH,
        wheels=wheels({"loads": [shake]}, torque(-DRAG)),
        mesh={"backlash": BACKLASH, "contact": contact, "damping": damping},
        **{"duration": 0.028, "output_interval": 1e-5, "tolerance": 1e-10, "initial": start},
        **simulation,
    )


def table_impulse(start: float, end: float) -> float:
    """Integral of the pinion's torque [N m s], which is linear between its knots."""
    t = np.union1d(np.linspace(start, end, 2), np.arange(16) * CYCLE / 2)
    t = t[(t >= start) & (t <= end)]
    values = np.interp(t, np.arange(16) * CYCLE / 2, SHAKE * (-1.0) ** (np.arange(16) + 1))
    return float(np.trapezoid(values, t))


COMPLIANT = {
    "undamped": ({"law": "johnson"}, {"law": "none"}),
    "damped": ({"law": "johnson"}, {"law": "hunt_crossley", "restitution": 0.7}),
}


@pytest.mark.parametrize(("contact", "damping"), COMPLIANT.values(), ids=COMPLIANT.keys())
def test_every_impact_of_compliant_flanks_keeps_momentum_and_energy(runs, contact, damping):
    run = runs(rattle(contact, damping))
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    events = run.events
    kind, flank, time = (events[name].values for name in ("kind", "flank", "time"))
    before, after = speeds(events, "before"), speeds(events, "after")
    np.testing.assert_array_equal(before, after)  # no discontinuity
    work, lost = (events[n].sel(side="after").values for n in ("load_work", "dissipated_energy"))
    impacts = {0: 0, 1: 0}
    first = None
    for i in range(len(kind)):
        if kind[i] == "contact_closed" and first is None:
            first = i
        if kind[i] != "contact_opened" or first is None:  # the first was closed at the start
            continue
        if i + 1 < len(kind) and kind[i + 1] == "contact_opened" and time[i + 1] == time[i]:
            continue  # another pair of the flank opens at the same time
        impacts[int(flank[i])] += 1
        exchanged = MASS * approach(before[first : first + 1])[0] ** 2 / 2
        balance = energy(after[i : i + 1])[0] - energy(before[first : first + 1])[0]
        balance += lost[i] - lost[first] - (work[i] - work[first])
        assert abs(balance) <= 1e-6 * exchanged
        given = table_impulse(time[first], time[i]) / BASE_A
        given += DRAG * (time[i] - time[first]) / BASE_B
        change = momentum(after[i : i + 1])[0] - momentum(before[first : first + 1])[0]
        impulse = MASS * abs(approach(before[first : first + 1])[0])
        assert abs(change - given) <= 1e-6 * impulse
        first = None
    assert impacts[0] >= 4
    assert impacts[1] >= 4
    gaps = run.history["gap"] + run.history["coast_gap"]
    np.testing.assert_allclose(gaps, BACKLASH, rtol=0, atol=1e-16)


def test_rattle_of_undamped_flanks_loses_nothing(runs):
    run = runs(rattle(*COMPLIANT["undamped"]))
    lost = run.history["dissipated_energy"].values
    kind, time = run.events["kind"].values, run.events["time"].values
    # only pairs that enter or leave under load change the energy
    booked = np.isin(kind, ("pair_entered", "pair_left"))
    jumps = run.events["dissipated_energy"].diff("side").values[:, 0]
    assert np.all(jumps[~booked] == 0)
    scale = MASS * 0.1**2 / 2
    total = np.array([jumps[time <= t].sum() for t in run.history["time"].values])
    assert abs(lost - total).max() <= 1e-8 * scale


def test_every_impact_of_rigid_flanks_follows_newton(runs):
    e = 0.6
    case = rattle({"law": "rigid", "restitution": e}, {"law": "none"})
    run = runs(case)
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    events = run.events
    struck = events["kind"].values == "impact"
    before, after = (speeds(events, side)[struck] for side in ("before", "after"))
    flank = events["flank"].values[struck]
    assert (flank == 0).sum() >= 4
    assert (flank == 1).sum() >= 4
    speed = approach(before)
    assert np.all(np.sign(speed) == np.where(flank == 0, 1, -1))
    np.testing.assert_allclose(approach(after), -e * speed, rtol=0, atol=1e-6 * abs(speed).max())
    exchanged = MASS * speed**2 / 2
    assert np.all(abs(momentum(after) - momentum(before)) <= 1e-6 * MASS * abs(speed))
    lost = events["dissipated_energy"].diff("side").values[struck, 0]
    rounding = 1e-15 * energy(before)
    assert np.all(abs(energy(after) - energy(before) + lost) <= 1e-6 * exchanged + rounding)
    assert np.all(abs(lost - (1 - e**2) * exchanged) <= 1e-6 * exchanged + rounding)
    gap, coast = run.history["gap"].values, run.history["coast_gap"].values
    assert gap.min() >= -1e-12
    assert coast.min() >= -1e-12


# ---- torque reversal, start from a gap


def reversal(contact: dict[str, Any], damping: dict[str, Any]) -> dict[str, Any]:
    """Return a pair whose torque reverses within a millisecond."""
    table = {"kind": "table", "time": [0, 4e-3, 5e-3], "torque": [-10, -10, 10]}
    return real_pair(
        TEETH,
        wheels=wheels({"loads": [table]}, viscous(0.5)),
        mesh={"backlash": BACKLASH, "contact": contact, "damping": damping},
        **{"duration": 0.02, "output_interval": 1e-5, "initial": {"kind": "steady"}},
    )


REVERSALS = {
    "compliant": ({"law": "johnson"}, {"law": "hunt_crossley", "restitution": 0.5}),
    "rigid": ({"law": "rigid", "restitution": 0.3, "rest_velocity": 1e-3}, {"law": "none"}),
}


@pytest.mark.parametrize("kind", REVERSALS)
def test_a_reversed_torque_is_carried_by_the_other_flanks(runs, kind):
    run = runs(reversal(*REVERSALS[kind]))
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    history = run.history
    time = history["time"].values
    drive = history["normal_force"][:, 0] - history["coast_force"][:, 0]
    early, late = time < 4e-3, time > 18e-3
    assert np.all(history["coast_force"].values[early] == 0)
    assert np.all(drive.values[early] > 0)
    assert np.all(drive.values[late] == 0)
    # the wheels move as one body: torques and inertias determine the force between them
    load = history["load_torque"].values[late]
    acceleration = load[:, 1] / INERTIA_B * BASE_B + load[:, 0] / INERTIA_A * BASE_A
    force = history["coast_force"].values[late, 0]
    # compliant flanks may still vibrate
    assert force.mean() == pytest.approx((acceleration * MASS).mean(), rel=0.02)
    if kind == "rigid":
        np.testing.assert_allclose(force, acceleration * MASS, rtol=1e-6)
    gaps = history["gap"] + history["coast_gap"]
    np.testing.assert_allclose(gaps, BACKLASH, rtol=0, atol=1e-16)


@pytest.mark.parametrize("law", ["johnson", "rigid"])
@pytest.mark.parametrize("gap", [1e-5, BACKLASH])
def test_flanks_that_start_apart_meet_when_the_gap_has_been_run_through(runs, law, gap):
    damping = {"law": "one_sided", "coefficient": 1e9} if law == "johnson" else {"law": "none"}
    start = {"kind": "rest", "gaps": {"pinion-gear": gap}}
    case = real_pair(
        TEETH,
        wheels=wheels(torque(-2.0), viscous(0.0)),
        mesh={"backlash": BACKLASH, "contact": {"law": law}, "damping": damping},
        **{"duration": 5e-3, "output_interval": 1e-5, "initial": start},
    )
    run = runs(case)
    assert run.exit_code == 0
    closed = run.events["time"].values[run.events["kind"].values == "contact_closed"][0]
    expected = np.sqrt(2 * gap * INERTIA_A / (2.0 * BASE_A))
    assert closed == pytest.approx(expected, rel=1e-7)
    history = run.history
    assert np.all(history["normal_force"].values[history["time"].values < closed] == 0)
    assert history["gap"][0, 0] == pytest.approx(gap, rel=1e-12)


# ---- mirror images


@pytest.mark.parametrize("contact", ["johnson", "rigid"])
def test_both_senses_of_rotation_are_mirror_images(runs, contact):
    """Also with deviations: pitch errors in reverse order, with the opposite sign."""
    errors = [1e-6 * ((3 * k * k + k) % 7) for k in range(TEETH[1])]
    found = []
    for sign, sense in ((1, "clockwise"), (-1, "counterclockwise")):
        flawed = {}
        if contact == "johnson":
            mirrored = [sign * errors[sign * k % TEETH[1]] for k in range(TEETH[1])]
            flawed = {
                "pitch_errors": mirrored,
                "eccentricity": {"amount": 5e-6, "phase": sign * 40.0},
                "tip_relief": {"amount": 1e-5, "diameter": 0.093},
            }
        table = {
            "kind": "table",
            "time": [0, 6e-3, 8e-3],
            "torque": [-10 * sign, -10 * sign, 6 * sign],
        }
        law = {"law": contact, **({"restitution": 0.4} if contact == "rigid" else {})}
        damping = {"law": "linear", "coefficient": 500} if contact == "johnson" else {"law": "none"}
        friction = {"law": "coulomb", "coefficient": 0.1, "regularisation_velocity": 1e-2}
        load = viscous(0.3)
        case = real_pair(
            TEETH,
            wheels=wheels({"loads": [table]}, {**load, **flawed}),
            mesh={
                **{"backlash": BACKLASH, "contact": law, "damping": damping},
                **{"friction": friction, "driving_rotation": sense},
            },
            **{"duration": 0.015, "output_interval": 1e-4},
            initial={"kind": "speeds", "speeds": {"pinion": -30.0 * sign, "gear": 20.0 * sign}},
        )
        found.append(runs(case))
        assert found[-1].exit_code == 0
    one, other = found
    assert one.events.sizes == other.events.sizes
    for name in ("kind", "flank", "tooth_pair"):
        np.testing.assert_array_equal(one.events[name], other.events[name])
    assert {0, 1} <= set(one.events["flank"].values)
    for name in ("normal_force", "coast_force", "gap", "coast_gap", "kinetic_energy", "efficiency"):
        a, b = one.history[name].values, other.history[name].values
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * np.nanmax(abs(a)), err_msg=name)
    for name in ("angular_velocity", "mesh_torque_driving", "mesh_torque_driven"):
        a, b = one.history[name].values, -other.history[name].values
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * np.nanmax(abs(a)), err_msg=name)
    for i, name in enumerate(("driving", "driven")):
        teeth = one.history[f"pair_tooth_{name}"].values
        mirrored = -other.history[f"pair_tooth_{name}"].values % TEETH[i]
        np.testing.assert_array_equal(teeth, mirrored)
