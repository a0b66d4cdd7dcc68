"""The paper's gearbox with rigid contact: constraint, forces, energy, compliant contact."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import xarray as xr
from rigid_reference import solve_rigid

from evolvent import check_history
from system.cases import pair, rigid, train
from system.runs import FRICTION, FRICTIONLESS, RIGID, TRACKINGS, Run, tracking
from system.test_invariants import check_energy, separation, transmission_error

COEFFICIENTS = {FRICTIONLESS: 0.0, FRICTION: 0.3}
BASE_A = 0.2 * math.cos(1.05 * math.atan(2 * math.pi / 50))  # [m]
SMALL = 1e-18  # permitted gap [m] and gap rate [m/s]


@pytest.fixture(params=TRACKINGS)
def kind(request):
    return request.param


@pytest.fixture(params=COEFFICIENTS)
def example(request):
    return request.param


def rigid_run(runs, example: str, kind: str, *settings: str) -> Run:
    return runs(example, *RIGID, tracking(kind), *settings)


def check_constraint(history: xr.Dataset) -> None:
    """Check a contact that never opens: position, velocity, and the corresponding lag."""
    assert np.all(history["contact_mode"] == 1)
    assert np.all(history["in_contact"] == 1)
    assert np.abs(history["gap"]).max() <= SMALL
    assert np.abs(history["gap_rate"]).max() <= SMALL
    lag = transmission_error(history)
    assert np.abs(lag - separation(history)).max() <= SMALL
    assert np.abs(lag).max() > 1e-11  # the slider moves: the comparison is not trivial


def test_the_contact_stays_closed(runs, example, kind):
    check_constraint(rigid_run(runs, example, kind).history)


@pytest.mark.parametrize("duration", [100.0, pytest.param(500.0, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", ["closed_form", "differential"])
def test_nothing_drifts_over_a_hundred_seconds_and_more(runs, kind, duration):
    long = (f"simulation.duration={duration}", "simulation.output_interval=0.05")
    history = rigid_run(runs, FRICTION, kind, *long).history
    assert float(history["time"][-1]) == duration
    check_constraint(history)
    check_energy(history, 10.0)
    if kind == "differential":
        ratio = history["gradient_ratio"].values / history["gradient_ratio"].values[0]
        assert np.abs(ratio - 1).max() <= 1e-12


def test_energy_balances(runs, example, kind):
    check_energy(rigid_run(runs, example, kind).history, 0.5)


def test_no_invariant_is_broken(runs, example, kind):
    verdicts = {v.invariant.name: v for v in check_history(rigid_run(runs, example, kind).history)}
    assert [v for v in verdicts.values() if v.failed] == []
    for name in ("rigid gap", "rigid gap rate"):
        assert verdicts[name].verdict == "pass"


@pytest.mark.parametrize("kind", TRACKINGS)
def test_the_independent_program_agrees(runs, example, kind):
    history = rigid_run(runs, example, kind).history
    expected = solution(COEFFICIENTS[example])
    compared = {
        "normal_force": history["normal_force"][:, 0],
        "omega_a": history["angular_velocity"].sel(wheel="pinion"),
        "omega_b": history["angular_velocity"].sel(wheel="gear"),
        "slider": history["centre_displacement"].sel(wheel="gear", axis="x"),
        "delta": history["transmission_error"][:, 0],
    }
    for name, values in compared.items():
        largest = np.abs(expected[name]).max()
        assert np.abs(values.values - expected[name]).max() <= 1e-6 * largest, name
    difference = np.abs(history["friction_force"][:, 0].values - expected["friction_force"]).max()
    assert difference <= 1e-6 * np.abs(expected["normal_force"]).max()
    switches = rigid_run(runs, example, kind).times("tooth_switch")
    np.testing.assert_allclose(switches, expected["switch_times"], rtol=0, atol=1e-8)


_solutions: dict[float, dict[str, Any]] = {}


def solution(friction: float) -> dict[str, Any]:
    """Run the independent program once for each coefficient."""
    if friction not in _solutions:
        _solutions[friction] = solve_rigid(friction)
    return _solutions[friction]


# ---- steady state


def test_a_run_from_rest_comes_to_the_steady_state(runs, kind):
    last = rigid_run(runs, FRICTIONLESS, kind, "simulation.duration=20").history.isel(time=-1)
    # The speeds approach theirs with a time constant of 1.43 s: 9e-7 remain after 20 s.
    assert float(last["normal_force"][0]) == pytest.approx(1 / BASE_A, rel=1e-5)
    assert float(last["angular_velocity"].sel(wheel="gear")) == pytest.approx(0.15, rel=1e-5)


def test_a_run_from_the_steady_state_stays_there(runs, kind):
    history = runs(rigid(pair(0.0, kind, initial={"kind": "steady"}))).history
    np.testing.assert_allclose(history["normal_force"][:, 0], 1 / BASE_A, rtol=1e-11)
    np.testing.assert_allclose(history["angular_velocity"].sel(wheel="gear"), 0.15, rtol=1e-11)
    assert np.abs(history["gap"]).max() <= SMALL


# ---- comparison with the compliant contact


@pytest.mark.parametrize("example", COEFFICIENTS)
def test_compliant_and_rigid_contact_have_the_same_mean_force(runs, example):
    """Over whole pitches after 2 s; the remaining transient decays equally in both."""
    settings = ("simulation.duration=12", tracking("closed_form"))
    compliant, stiff = runs(example, *settings), runs(example, *RIGID, *settings)
    switches = stiff.times("tooth_switch")
    first, last = switches[switches > 2][[0, -1]]
    means = [
        run.history["normal_force"].sel(time=slice(first, last))[:, 0].mean()
        for run in (compliant, stiff)
    ]
    assert switches.size >= 5
    assert float(means[0]) == pytest.approx(float(means[1]), rel=1e-5)


def jump(run: Run, time: float) -> Any:
    """Change of normal and friction force over 0.1 s around a time."""
    around = run.history.interp(time=[time - 0.05, time + 0.05])
    return np.diff(around[["normal_force", "friction_force"]].to_array()[:, :, 0], axis=1)[:, 0]


@pytest.mark.parametrize("kind", TRACKINGS)
def test_friction_jumps_at_the_pitch_point_as_with_a_compliant_contact(runs, kind):
    compliant, stiff = (runs(FRICTION, *settings, tracking(kind)) for settings in ((), RIGID))
    names = [
        [name for name in run.events["kind"].values if name.startswith(("sliding", "tooth"))]
        for run in (compliant, stiff)
    ]
    assert names[0] == names[1]
    assert names[0].count("sliding_ended") >= 2  # the linear part of the law, at each pitch point
    passed = [run.times("sliding_ended")[0] for run in (compliant, stiff)]
    assert passed[0] == pytest.approx(passed[1], abs=1e-5)
    jumps = [jump(run, passed[1]) for run in (compliant, stiff)]
    normal, friction = jumps[1]
    force = float(stiff.history["normal_force"].interp(time=passed[1] - 0.05)[0])
    assert abs(friction) == pytest.approx(2 * 0.3 * force, rel=0.05)  # from +f F_n to -f F_n
    assert abs(normal) > 1e-3 * force
    # After 0.05 s 7e-4 of the vibration remain, at 146/s; measured: 1.6e-4.
    np.testing.assert_allclose(jumps[0], jumps[1], rtol=7e-4)


@pytest.mark.parametrize("kind", TRACKINGS)
def test_a_train_of_rigid_contacts_breaks_no_invariant(runs, kind):
    """Two contacts, an idler in bearings; friction changes twice per pitch in each."""
    run = runs(rigid(train(0.1, kind)))
    assert run.exit_code == 0
    assert np.all(run.history["contact_mode"] == 1)
    assert run.times("tooth_switch").size > 10
    assert [v for v in check_history(run.history) if v.failed] == []
