"""Load sharing of gears defined by a basic rack: tooth pairs, contact ratios, tip relief."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.special import lambertw

from evolvent import check_history
from system.real_cases import (
    ALPHA,
    E_STAR,
    base_pitch,
    base_radius,
    real_pair,
    speed,
    tip_diameters,
    torque,
    viscous,
)
from system.runs import TRACKINGS, Run


def broken_invariants(run: Run) -> list[str]:
    return [verdict.invariant.name for verdict in check_history(run.history) if verdict.failed]


def johnson_force(penetration: Any, rho: float, width: float) -> Any:
    """Force of Johnson's law [N]; rho: length of the line of action."""
    x = math.e * penetration / (4 * (rho + penetration))
    return -width * math.pi * E_STAR * penetration / lambertw(-x, -1).real


# ---- the perfect pair z 50/50, m 3 mm, 20 degrees

TORQUE, WIDTH, BASE = 100.0, 0.02, base_radius(50)
LINE = 0.15 * math.sin(ALPHA)  # T1T2
TIP = math.sqrt(0.078**2 - BASE**2)  # radius of curvature at the tips
RATIO = (2 * TIP - LINE) / base_pitch()  # 1.7547
PERIOD = 0.03  # of a pitch [s]


def perfect(kind: str) -> dict[str, Any]:
    """Return the pair under a constant torque; the gear has a constant low speed."""
    return real_pair(
        wheels=(
            {**torque(-TORQUE), "centre": [0, 0]},
            speed(2 * math.pi / 50 / PERIOD),
        ),
        mesh={"damping": {"law": "linear", "coefficient": 4e4}, "tracking": kind},
        **{"duration": 3 * PERIOD, "output_interval": PERIOD / 1000, "tolerance": 1e-10},
        initial={"kind": "steady"},
    )


@pytest.fixture(params=TRACKINGS)
def slow(runs, request) -> Run:
    return runs(perfect(request.param))


def test_the_perfect_pair_has_two_pairs_in_contact_for_the_time_that_its_ratio_says(slow):
    """75.47 %: the penetration shortens the path of contact by 2e-4 of a pitch."""
    assert pytest.approx(1.7547, abs=5e-5) == RATIO
    assert slow.exit_code == 0
    assert broken_invariants(slow) == []
    flank, kind, time = (slow.events[name].values for name in ("flank", "kind", "time"))
    entered, left = (time[(kind == f"pair_{k}") & (flank == 0)] for k in ("entered", "left"))
    assert (len(entered), len(left)) == (3, 3)
    # the earlier pair of the start leaves first; each enters before the one before leaves
    share = [(b - a) / PERIOD for a, b in zip(entered[:2], left[1:], strict=True)]
    history = slow.history
    depth = float(history["penetration"].interp(time=left[1] - 1e-4)[0])
    np.testing.assert_allclose(share, RATIO - 1 - depth / base_pitch(), rtol=0, atol=2e-8)
    assert share[0] == pytest.approx(0.7547, abs=4e-4)
    pairs = history["pairs_in_contact"][:, 0].values
    assert set(pairs) == {1, 2}
    first = np.searchsorted(history["time"], PERIOD)
    assert np.mean(pairs[first : first + 2000] == 2) == pytest.approx(share[0], abs=1e-3)


def test_the_perfect_pair_carries_its_torque(slow):
    """The mean over two pitches, by the work of the loads from the integrator."""
    history = slow.history
    rows = [np.searchsorted(history["time"], PERIOD * k - 1e-9) for k in (1, 3)]
    work, turned = (
        np.diff(v.values[rows])[0] for v in (history["load_work"], history["angle"][:, 0])
    )
    # the power of the gear's load is the force times its base radius times its constant speed
    output = work + TORQUE * turned
    mean = -output / (BASE * (2 * math.pi / 50 / PERIOD) * 2 * PERIOD)
    assert mean == pytest.approx(TORQUE / BASE, rel=1e-6)


def test_two_pairs_share_the_load_equally_and_sink_in_as_johnson_says(slow):
    history = slow.history
    pairs = history["pairs_in_contact"][:, 0].values
    force = history["pair_normal_force"][:, 0, :3].values
    both = pairs == 2
    shares = np.sort(force[both], axis=1)
    np.testing.assert_array_equal(shares[:, 0], 0)
    np.testing.assert_allclose(shares[:, 1], shares[:, 2], rtol=1e-12)
    # settled: 3 ms from every event, which is thirty decay times of the vibration
    times = slow.events["time"].values
    calm = np.min(abs(history["time"].values[:, None] - times), axis=1) > 3e-3
    calm &= history["time"].values > times[0]
    depth = history["penetration"][:, 0].values
    for n in (1, 2):
        rows = calm & (pairs == n)
        assert rows.sum() > 100
        np.testing.assert_allclose(
            n * johnson_force(depth[rows], LINE, WIDTH), TORQUE / BASE, rtol=1e-7
        )


# ---- contact ratios


def with_ratio(ratio: float, **mesh: Any) -> dict[str, Any]:
    """Return a pair with a contact ratio that drives a viscous load."""
    alpha = math.radians(12 if ratio > 2 else 20)
    teeth = (150, 150) if ratio > 2 else (30, 40)
    tips = tip_diameters(teeth, ratio, alpha=alpha)
    rack = {"rack": {"dedendum": 1.8}} if ratio > 2 else {}
    degrees = {"pressure_angle": math.degrees(alpha)}
    start: dict[str, Any] = {"kind": "steady"}
    if ratio < 1:
        # no pair is on the path under load at the start; and between the pairs only their inertia
        # keeps the flanks from a large overlap when the next pair enters
        start = {"kind": "speeds", "speeds": {"pinion": -40.0, "gear": 30.0}}
        rack["inertia"] = 1.0
    wheels = (
        {**torque(-20.0), "centre": [0, 0], "tip_diameter": tips[0], **rack, **degrees},
        {**viscous(20.0 / 30), "tip_diameter": tips[1], **rack, **degrees},
    )
    return real_pair(
        teeth,
        wheels=wheels,
        mesh={"damping": {"law": "linear", "coefficient": 500}, **mesh},
        **{"duration": 0.02, "output_interval": 1e-5, "initial": start},
    )


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize(("ratio", "pairs"), [(0.8, {0, 1}), (1.3, {1, 2}), (4.0, {4})])
def test_any_contact_ratio_runs(runs, ratio, pairs, kind):
    run = runs(with_ratio(ratio, tracking=kind))
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    on_path = run.history["pair_on_path"][:, 0].sel(pair=drive(run)).sum("pair").values
    counts = {int(n) for n in np.unique(on_path) if (on_path == n).mean() > 1e-2}
    assert counts == pairs
    assert len(run.history["pair"]) == 2 * (math.ceil(ratio) + 1)
    # of whole pitches that start with the entry of a pair; the penetration shortens the path
    kind, flank, time = (run.events[name].values for name in ("kind", "flank", "time"))
    entered = time[(kind == "pair_entered") & (flank == 0)]
    rows = np.searchsorted(run.history["time"].values, entered[[0, -1]])
    assert on_path[rows[0] : rows[1]].mean() == pytest.approx(ratio, abs=3e-3)
    loaded = run.history["pairs_in_contact"][:, 0].values
    if ratio < 1:
        assert np.all(loaded[on_path == 0] == 0)
        assert np.all(run.history["normal_force"][on_path == 0] == 0)


def drive(run: Run) -> list[str]:
    """Slots of the tooth pairs on the drive flank."""
    return [name for name in run.history["pair"].values if name.startswith("drive")]


@pytest.mark.parametrize("flawed", [False, True], ids=["perfect", "with pitch errors"])
def test_at_a_contact_ratio_of_exactly_1_exit_and_entry_are_one_event(runs, flawed):
    case = with_ratio(1.0)
    if flawed:  # each pair takes over at a gap different from that of the pair before
        case["wheels"][0]["pitch_errors"] = [1e-6 * (7 * k % 5) for k in range(30)]
        case["wheels"][1]["eccentricity"] = {"amount": 5e-6}
    run = runs(case)
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    kinds = set(run.events["kind"].values)
    assert "tooth_switch" in kinds
    assert not kinds & {"pair_entered", "pair_left"}
    assert run.history["pair"].values.tolist() == ["drive_0", "coast_0"]
    assert np.all(run.history["pair_on_path"] == 1)


@pytest.mark.parametrize(("ratio", "counts"), [(1.0, {1}), (1.3, {1, 2}), (4.0, {4})])
def test_rigid_pairs_share_one_force(runs, ratio, counts):
    friction = {"law": "coulomb", "coefficient": 0.1, "regularisation_velocity": 1e-2}
    case = with_ratio(ratio, contact={"law": "rigid"}, damping={"law": "none"}, friction=friction)
    case["wheels"][1]["thickness_allowance"] = -5e-5  # backlash at the same centre distance
    run = runs(case)
    assert run.exit_code == 0
    assert broken_invariants(run) == []
    history = run.history
    pairs = history["pairs_in_contact"][1:, 0].values  # at the start both ends may be on the path
    assert set(pairs) == counts
    force = history["pair_normal_force"][1:, 0].values
    share = history["normal_force"][1:].values / pairs[:, None]
    np.testing.assert_allclose(np.where(force > 0, force, share), share * np.ones_like(force))
    assert np.all((force > 0).sum(axis=1) == pairs)


# ---- tip relief


def relieved(amount: float, duration: float, damped: bool, **simulation: Any) -> dict[str, Any]:
    """Return the perfect pair with tip relief that starts before the end of double contact."""
    # single contact ends at the entry of the next pair, one base pitch after the start of contact
    start = 2 * math.hypot(BASE, LINE - TIP + base_pitch() - 3e-4)
    relief = {"tip_relief": {"amount": amount, "diameter": start}} if amount else {}
    return real_pair(
        wheels=(
            {**torque(-TORQUE), **relief, "centre": [0, 0]},
            {**viscous(TORQUE / 20), **relief},
        ),
        mesh={"damping": {"law": "one_sided", "coefficient": 1e9}} if damped else {},
        **{
            "duration": duration,
            "output_interval": 2e-6,
            "initial": {"kind": "steady"},
            **simulation,
        },
    )


def test_the_total_force_jumps_only_where_unmodified_flanks_come_and_go(runs):
    """With a relief larger than the penetration, it does not jump there either."""
    largest = {}
    for amount in (0.0, 20e-6):
        run = runs(relieved(amount, 0.012, damped=True, output_interval=5e-7))
        assert broken_invariants(run) == []
        history = run.history
        force, time = history["normal_force"][:, 0].values, history["time"].values
        jump = abs(np.diff(force)) / (TORQUE / BASE)
        kind, flank = run.events["kind"].values, run.events["flank"].values
        ends = np.isin(kind, ("pair_entered", "pair_left")) & (flank == 0)
        assert ends.sum() >= 3
        at_ends = np.searchsorted(time, run.events["time"].values[ends]) - 1
        largest[amount] = jump[at_ends].max()
        elsewhere = np.delete(jump, at_ends)
        assert elsewhere.max() < 0.03  # change by a vibration of some kHz in 0.5 us
    assert largest[0.0] > 0.3
    assert largest[20e-6] < 0.03


def energy_balance(history: xr.Dataset) -> Any:
    stored = history["kinetic_energy"] + history["potential_energy"]
    balance = (stored + history["dissipated_energy"] - history["load_work"]).values
    return balance - balance[0]


def test_energy_is_kept_over_many_pairs_of_relieved_flanks(runs):
    run = runs(relieved(20e-6, 0.02, damped=False, tolerance=1e-11))
    history = run.history
    speeds = history["angular_velocity"].values
    work = float(abs(history["mesh_torque_driving"][:, 0] * speeds[:, 0]).integrate("time"))
    assert abs(energy_balance(history)).max() <= 1e-9 * work
    assert float(abs(history["dissipated_energy"]).max()) <= 1e-9 * work
    assert (run.events["kind"].values == "profile_border").sum() > 10


def test_with_the_arms_left_at_the_base_radii_energy_would_get_lost(runs):
    """20 um of linear relief over a pitch of 6.6 mm: 0.3 % of the work of the mesh."""
    module, teeth, amount, duration = 2.25e-3, (60, 60), 20e-6, 6e-3
    tips = tip_diameters(teeth, 1.0, module)
    base, pitch = base_radius(teeth[0], module), base_pitch(module)
    rho_tip = math.sqrt(tips[0] ** 2 / 4 - base**2)
    border = rho_tip - 0.98 * pitch
    relief = {"amount": amount, "diameter": 2 * math.hypot(base, border)}
    turn = 0.9 * pitch / base / duration  # the run ends before the next pair takes over
    wheels = (
        {**torque(-50.0), "centre": [0, 0], "tip_diameter": tips[0], "tip_relief": relief},
        {**viscous(50.0 / turn), "tip_diameter": tips[1]},
    )
    case = real_pair(
        teeth,
        module,
        wheels=wheels,
        **{"duration": duration, "output_interval": 2e-6, "tolerance": 1e-11},
        initial={"kind": "steady", "position": 0.0},
    )
    history = runs(case).history
    assert set(np.unique(history["tooth_pair"])) == {0}
    speeds = history["angular_velocity"].values
    power = {
        name: history[f"mesh_torque_{name}"][:, 0] * speeds[:, i]
        for i, name in enumerate(("driving", "driven"))
    }
    work = float(abs(power["driving"]).integrate("time"))
    assert abs(energy_balance(history)).max() <= 1e-9 * work
    assert float(abs(history["dissipated_energy"]).max()) <= 1e-8 * work
    # energy of the wheels with lever arms r_b, less their actual energy
    radii = history["base_radius"].values
    sigma = float(history["flank"][0])
    radial = sigma * history["normal_force"][:, 0] * (speeds @ radii)
    lost = float((power["driving"] + power["driven"] - radial).integrate("time"))
    assert abs(lost) == pytest.approx(amount / (0.98 * pitch) * work, rel=0.05)
    assert 2.5e-3 * work < abs(lost) < 3.5e-3 * work
