"""Rigid contacts that open, close, bounce and settle, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.cases import pair, rigid, unloaded_pair
from system.runs import TRACKINGS

TEETH_COSINE = math.cos(1.05 * math.atan(2 * math.pi / 50))
BASE_A, BASE_B = 0.2 * TEETH_COSINE, 0.3 * TEETH_COSINE  # [m]
# Solid discs of the pitch radius.
INERTIA_A, INERTIA_B = (7800 * math.pi * r**4 * 0.1 / 2 for r in (0.2, 0.3))
MOBILITY = BASE_A**2 / INERTIA_A + BASE_B**2 / INERTIA_B  # of the gap [1/kg]
FALL = BASE_A / INERTIA_A  # the gap's acceleration under 1 N m on the pinion [m/s^2]


@pytest.fixture(params=TRACKINGS)
def kind(request):
    return request.param


def free_pair(kind: str, restitution: float, **simulation: Any) -> dict[str, Any]:
    """Two wheels on fixed axes, with dissipation only in impacts."""
    return rigid(unloaded_pair(kind, **simulation), restitution)


# ---- opening


def test_the_contact_opens_when_its_force_falls_through_zero(runs, kind):
    """F_n is affine in the torques: 0 where r_A M_A/J_A + r_B M_B/J_B is."""
    case = free_pair(kind, 0.0, duration=1.2, output_interval=1e-2)
    table = {"kind": "table", "time": [0, 1, 2], "torque": [-1, 1, 3]}
    case["wheels"][0]["loads"] = [table]
    case["wheels"][1]["loads"] = [{"kind": "torque", "value": -0.3}]
    run = runs(case)
    (opened,) = run.times("contact_opened")
    expected = (1 + 0.3 * BASE_B / INERTIA_B * INERTIA_A / BASE_A) / 2
    assert opened == pytest.approx(expected, rel=1e-9)
    history = run.history
    closed = history.sel(time=slice(0, opened))
    assert np.abs(closed["gap"]).max() <= 1e-18
    balance = 2 * FALL * (opened - closed["time"].values) / MOBILITY
    # the tolerance of IDA's interpolation, of the largest value
    np.testing.assert_allclose(closed["normal_force"][:, 0], balance, rtol=0, atol=4e-9)
    # From here the gap grows with the third power: kappa'' increases like M_A.
    apart = history.sel(time=slice(opened + 0.05, None))
    cube = 2 * FALL * (apart["time"].values - opened) ** 3 / 6
    np.testing.assert_allclose(apart["gap"][:, 0], cube, rtol=1e-7)
    assert np.all(apart["normal_force"] == 0)
    assert f"lost contact at t = {opened:.4f}"[:26] in run.messages


# ---- one impact


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_an_impact_leaves_the_speeds_that_restitution_and_momentum_say(runs, kind, restitution):
    approach, gap = 1e-3, 1e-6
    speeds = {"pinion": -approach / BASE_A, "gear": 0.0}
    start = {"kind": "speeds", "speeds": speeds, "gaps": {"pinion-gear": gap}}
    run = runs(free_pair(kind, restitution, duration=0.05, initial=start))
    struck = run.times("impact" if restitution > 0 else "contact_closed")
    np.testing.assert_allclose(struck, [gap / approach], rtol=1e-10)
    impulse = (1 + restitution) * approach / MOBILITY
    expected = [
        -approach / BASE_A + impulse * BASE_A / INERTIA_A,
        impulse * BASE_B / INERTIA_B,
    ]
    history = run.history
    np.testing.assert_allclose(history["angular_velocity"][-1], expected, rtol=1e-10)
    loss = (1 - restitution**2) / 2 * approach**2 / MOBILITY
    energy = history["kinetic_energy"].values
    assert energy[0] - energy[-1] == pytest.approx(loss, rel=1e-10, abs=1e-14 * energy[0])
    assert float(history["dissipated_energy"][-1]) == pytest.approx(
        loss, rel=1e-10, abs=1e-14 * energy[0]
    )
    later = history.isel(time=-1)
    time = float(later["time"]) - struck[0]
    assert float(later["gap"][0]) == pytest.approx(
        restitution * approach * time, rel=1e-9, abs=1e-18
    )


# ---- bouncing


def fall(kind: str, restitution: float, gap: float, duration: float) -> dict[str, Any]:
    """The pinion is driven across a gap against the gear at rest."""
    start = {"kind": "rest", "gaps": {"pinion-gear": gap}}
    case = free_pair(kind, restitution, duration=duration, initial=start)
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": -1.0}]
    return case


def test_bounces_follow_the_geometric_series_until_the_approach_is_too_slow(runs, kind):
    gap, restitution = 1e-3, 0.5
    run = runs(fall(kind, restitution, gap, 0.6))
    speed = math.sqrt(2 * FALL * gap)  # of the first impact
    times = [speed / FALL]
    while speed > 1e-6:  # the default of rest_velocity
        speed *= restitution
        times.append(times[-1] + 2 * speed / FALL)
    # Times inherit the rounding of the root only, but each impact adds its own.
    np.testing.assert_allclose(run.times("impact"), times[:-1], rtol=1e-9)
    for name in ("impacts_ended", "contact_closed"):
        np.testing.assert_allclose(run.times(name), times[-1:], rtol=1e-9)
    assert run.times("contact_opened").size == 0
    closed = run.history.sel(time=slice(times[-1], None))
    assert closed.sizes["time"] > 100
    assert np.all(closed["contact_mode"] == 1)
    assert np.abs(closed["gap"]).max() <= 1e-18
    assert np.abs(closed["gap_rate"]).max() <= 1e-18
    # F_n accelerates the gear as well: M_A over both inertias.
    np.testing.assert_allclose(closed["normal_force"], FALL / MOBILITY, rtol=1e-9)


def test_a_coarser_rest_velocity_ends_the_impacts_earlier(runs):
    case = fall("closed_form", 0.5, 1e-3, 0.6)
    case["meshes"][0]["contact"]["rest_velocity"] = 1e-3
    run = runs(case)
    speed = math.sqrt(2 * FALL * 1e-3)
    assert run.times("impact").size == math.ceil(math.log2(speed / 1e-3))
    assert run.times("impacts_ended").size == 1


def test_full_restitution_keeps_energy_and_height_over_many_impacts(runs, kind):
    gap = 1e-5
    run = runs(fall(kind, 1.0, gap, 2.0))
    impacts = run.times("impact")
    assert impacts.size > 60
    period = 2 * math.sqrt(2 * gap / FALL)
    expected = period * (np.arange(impacts.size) + 0.5)
    np.testing.assert_allclose(impacts, expected, rtol=1e-8)
    history = run.history
    assert float(history["dissipated_energy"].max()) <= 1e-14
    balance = history["kinetic_energy"] - history["load_work"]
    assert np.abs(balance).max() <= 1e-8 * float(history["load_work"].max())
    phase = np.mod(history["time"].values / period + 0.5, 1.0) - 0.5
    height = gap - FALL * (phase * period) ** 2 / 2
    assert np.abs(history["gap"][:, 0] - height).max() <= 1e-6 * gap


# ---- flanks with a common wheel


def split(kind: str, restitution: float, gaps: tuple[float, float], duration: float) -> Any:
    """A pinion strikes two gears at once: an impact with one takes momentum from the other."""
    case = fall(kind, restitution, 0.0, duration)
    case["simulation"]["initial"]["gaps"] = dict(zip(("left", "right"), gaps, strict=True))
    pinion, gear = case["wheels"]
    (mesh,) = case["meshes"]
    case["wheels"] = [pinion, gear | {"name": "left-gear"}, gear | {"name": "right-gear"}]
    case["meshes"] = [
        mesh | {"name": "left", "driven": "left-gear"},
        mesh | {"name": "right", "driven": "right-gear", "centre_line_angle": 180},
    ]
    return case


@pytest.mark.parametrize("restitution", [0.0, 0.1, 0.3, 0.5, 0.7, 0.9])
def test_a_pinion_between_two_equal_gears_bounces_on_both_at_once(runs, kind, restitution):
    """Impacts are simultaneous up to rounding, and each impact closes the other flanks further.

    Processed one after the other, they opened each other endlessly.
    """
    gap, rest = 1e-4, 1e-6
    speed = math.sqrt(2 * FALL * gap)
    times = [speed / FALL]
    while restitution > 0 and speed > rest:
        speed *= restitution
        times.append(times[-1] + 2 * speed / FALL)
    run = runs(split(kind, restitution, (gap, gap), times[-1] + 0.02))
    # The tolerance of the run, 1e-9, accumulates over 70 bounces; 1.1e-9 was the worst.
    np.testing.assert_allclose(run.times("impact"), np.repeat(times[:-1], 2), rtol=4e-9)
    np.testing.assert_allclose(run.times("contact_closed"), np.repeat(times[-1:], 2), rtol=4e-9)
    assert run.times("contact_opened").size == 0
    closed = run.history.sel(time=slice(times[-1], None))
    force = FALL / (MOBILITY + BASE_A**2 / INERTIA_A)  # r_A M/J_A over the effect of both on a gap
    np.testing.assert_allclose(closed["normal_force"], force, rtol=1e-9)
    assert np.abs(closed["gap"]).max() <= 1e-18
    assert [v for v in check_history(run.history) if v.failed] == []


@pytest.mark.parametrize("gaps", [(0.0, 1e-4), (1e-4, 1.3e-4), (1e-4, 2e-4), (1e-4, 0.0)])
@pytest.mark.parametrize("restitution", [0.0, 0.3, 0.7, 1.0])
def test_a_pinion_that_bounces_between_two_gears_gains_no_energy(runs, restitution, gaps):
    run = runs(split("closed_form", restitution, gaps, 0.2))
    history = run.history
    assert run.exit_code == 0, run.messages
    assert np.diff(history["dissipated_energy"]).min() >= -1e-15  # the rounding of 2 mJ and less
    assert float(history["normal_force"].min()) >= 0
    assert float(history["gap"].min()) >= -1e-15  # roots lie 1e-10 h_0 past the change
    assert [v for v in check_history(history) if v.failed] == []


# ---- friction


def test_friction_that_holds_the_flanks_fast_ends_the_run_with_a_diagnosis(runs, kind):
    """f l_B > r_bB on approach: no impulse separates the flanks."""
    start = {"kind": "speeds", "speeds": {"pinion": -1.0, "gear": 0.5}}
    case = free_pair(kind, 0.5, duration=0.1, initial=start)
    case["wheels"][1]["inertia"] = 1e-3
    case["meshes"][0]["friction"] = {"law": "coulomb", "coefficient": 8.0}
    run = runs(case)
    assert run.exit_code == 4
    assert "the rigid contact jams by friction" in run.messages


def test_wheels_that_are_thrown_about_come_back_to_rest_in_contact(runs, kind):
    """Friction, a slider, a torque reversal: energy balances through all impacts."""
    case = rigid(pair(0.3, kind, duration=2.5, output_interval=1e-4), 0.4)
    table = {"time": [0, 1, 1.01, 1.2, 1.21], "torque": [-1, -1, 1, 1, -1]}
    case["wheels"][0]["loads"] = [{"kind": "table", **table}]
    run = runs(case)
    kinds = run.events["kind"].values
    assert np.sum(kinds == "impact") >= 5
    assert "impacts_ended" in kinds
    history = run.history
    assert int(history["contact_mode"][-1, 0]) == 1
    power = history["load_torque"] * history["angular_velocity"]
    gross = float(power.clip(min=0).sum("wheel").integrate("time"))
    stored = history["kinetic_energy"] + history["potential_energy"]
    balance = stored + history["dissipated_energy"] - history["load_work"]
    assert float(np.abs(balance - balance[0]).max()) <= 1e-8 * gross
    assert float(history["gap"].min()) >= -1e-18
