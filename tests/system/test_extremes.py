"""Extremes over a run include values between outputs, and do not depend on the outputs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from evolvent import check_history
from evolvent.physics.extremes import Extreme, recorded_extremes
from system.cases import pair, rigid, train
from system.random_gearboxes import random_gearbox
from system.runs import TRACKED, TRACKINGS

INTEGRATORS = ("radau", "ida")
GEARS = "spur-pair.yaml"
STRONG = "meshes.0.damping={law: hunt_crossley, restitution: 0.8, v0_min: 1.0e-3}"
# without friction and with constant laws: the force of both pairs is a linear function
LINEAR = (
    "meshes.0.contact={law: linear, stiffness: 5.0e8}",
    "meshes.0.damping={law: linear, coefficient: 2.0e3}",
    "meshes.0.friction={law: none}",
)
NAMES = {
    *("normal_force_max", "pair_normal_force_max", "pair_contact_pressure_max", "penetration_max"),
    *("friction_force_max", "transmission_error_max", "sliding_velocity_max"),
    *("friction_force_min", "transmission_error_min", "sliding_velocity_min"),
}


def integrator(name: str) -> str:
    return f"simulation.integrator={name}"


def every(interval: float) -> str:
    return f"simulation.output_interval={interval!r}"


def sampled(history: xr.Dataset, extreme: Extreme) -> Any:
    """Return the extreme among the outputs, dim (mesh)."""
    values = history[extreme.output]
    others = [dim for dim in values.dims if dim != "mesh"]
    return (values.max(others) if extreme.is_largest else values.min(others)).values


def unit(history: xr.Dataset, extreme: Extreme) -> Any:
    """Return the largest value of the output, at least that of either of its extremes."""
    of_output = [
        abs(e.value.values) for e in recorded_extremes(history) if e.output == extreme.output
    ]
    return np.maximum(np.max(of_output, axis=0), 1e-300)


def assert_same(first: xr.Dataset, second: xr.Dataset, tolerance: float) -> None:
    for one, other in zip(recorded_extremes(first), recorded_extremes(second), strict=True):
        difference = abs(one.value.values - other.value.values) / unit(first, one)
        assert difference.max() <= tolerance, one.value.name


def verdict(history: xr.Dataset) -> str:
    return next(v.verdict for v in check_history(history) if v.invariant.name == "extremes")


def test_every_extreme_has_its_value_and_its_time_in_the_history(runs):
    history = runs(GEARS, STRONG, "simulation.duration=0.02").history
    assert {str(e.value.name) for e in recorded_extremes(history)} == NAMES
    for extreme in recorded_extremes(history):
        assert extreme.value.dims == extreme.time.dims == ("mesh",)
        assert extreme.value.attrs["units"] == history[extreme.output].attrs["units"]
        assert extreme.time.attrs["units"] == "s"
        assert 0 <= float(extreme.time[0]) <= 0.02


@pytest.mark.parametrize("name", INTEGRATORS)
def test_extremes_do_not_depend_on_the_output_interval(runs, name):
    settings = (STRONG, "simulation.duration=0.02", integrator(name))
    histories = [runs(GEARS, *settings, every(dt)).history for dt in (2e-5, 1e-6, 2e-7)]
    for other in histories[1:]:
        assert_same(histories[0], other, 1e-9)  # required are 1e-6; the steps are the same
    # the outputs do depend on it: the largest force is that right after an event
    peaks = [float(history["normal_force"].max()) for history in histories]
    assert peaks[0] < 0.8 * float(histories[0]["normal_force_max"][0])
    assert peaks[0] < peaks[1] < peaks[2] < float(histories[0]["normal_force_max"][0])


def test_both_integrators_find_the_same_extremes(runs):
    ida, radau = (
        runs(GEARS, STRONG, "simulation.duration=0.02", integrator(name)).history
        for name in ("ida", "radau")
    )
    assert_same(ida, radau, 1e-7)  # errors of IDA, docs/guides/integrators.md


@pytest.mark.parametrize("name", INTEGRATORS)
def test_the_extremes_of_a_vibration_are_those_of_very_fine_outputs(runs, name):
    settings = (*LINEAR, "simulation.duration=0.004", integrator(name))
    run = runs(GEARS, *settings, every(1e-4))
    fine = runs(GEARS, *settings, every(4e-8)).history
    smooth = set()
    for extreme in recorded_extremes(run.history):
        miss = abs(sampled(fine, extreme) - extreme.value.values) / unit(run.history, extreme)
        # 9 kHz: half a step beside the peak of a parabola misses (2 pi 9e3 * 2e-8)**2/2; at a jump
        # of the curve, the outputs miss its change over a whole step
        if abs(run.events["time"] - float(extreme.time[0])).min() > 1e-7:
            smooth.add(extreme.output)
            assert miss.max() <= 1e-6, extreme.value.name
        assert miss.max() <= 1e-3, extreme.value.name
    assert {"transmission_error", "pair_normal_force", "penetration"} <= smooth


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
@pytest.mark.parametrize("name", INTEGRATORS)
def test_the_largest_pressure_of_relieved_flanks_is_that_of_very_fine_outputs(runs, name, shape):
    """Curvature, force and position on the flank change together; the relief acts there."""
    settings = (
        f"wheels.pinion.tip_relief={{amount: 1.0e-5, diameter: 0.059, shape: {shape}}}",
        f"wheels.gear.tip_relief={{amount: 1.4e-5, diameter: 0.1035, shape: {shape}}}",
        *("simulation.duration=0.002", integrator(name)),
    )
    run = runs(GEARS, *settings, every(1e-4))
    fine = runs(GEARS, *settings, every(4e-8)).history
    largest = float(run.history["pair_contact_pressure_max"][0])
    time = float(run.history["pair_contact_pressure_max_time"][0])
    samples = fine["pair_contact_pressure"].isel(mesh=0).max("pair").values
    top = int(np.argmax(samples))
    below, here, above = samples[top - 1 : top + 2]
    # the vertex of the parabola through three outputs 4e-8 s apart; (2 pi 9e3 * 4e-8)**4 is 3e-11
    peak = here + (above - below) ** 2 / (8 * (2 * here - below - above))
    assert largest == pytest.approx(peak, rel=1e-9)
    assert abs(time - float(fine["time"][top])) <= 4e-8
    assert float(fine["flank_deviation"].isel(mesh=0).sel(time=time, method="nearest")) > 1e-6
    assert float(run.history["pair_contact_pressure"].max()) < 0.99 * largest


@pytest.mark.parametrize("name", INTEGRATORS)
def test_the_force_just_after_an_event_counts_though_no_output_lies_there(runs, name):
    run = runs(GEARS, *LINEAR, "simulation.duration=0.012", integrator(name), every(1e-3))
    entered = run.events["kind"].values == "pair_entered"
    radius = float(run.history["base_radius"][1])
    moved, speed = (
        abs(run.events[state].values[entered, 1]) * radius
        for state in ("angle_deviation_1", "speed_deviation_1")
    )
    assert entered.sum() >= 3
    sense = np.sign(
        run.events["angle_deviation_1"].values[entered, 1]
        * run.events["speed_deviation_1"].values[entered, 1]
    )
    # two pairs have equal forces when the second one enters
    forces = 2 * (5e8 * moved + sense * 2e3 * speed)
    assert float(run.history["normal_force_max"][0]) >= forces.max() * (1 - 1e-9)
    assert float(run.history["normal_force"].max()) < forces.max()


CASES = {
    **{tracking: pair(0.3, tracking, duration=0.1) for tracking in TRACKINGS},
    "train": train(0.1, "closed_form", duration=0.05),
    **{f"train, {tracking}": train(0.1, tracking, duration=0.005) for tracking in TRACKED},
    "rigid": rigid(pair(0.2, duration=0.1)),
    "rattle.yaml": "rattle.yaml",
    "tip-relief.yaml": "tip-relief.yaml",
    "two-stage-gears.yaml": "two-stage-gears.yaml",
    **{f"seed {seed}": random_gearbox(seed) for seed in (5, 12)},
}


@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_no_output_exceeds_an_extreme_and_the_interval_does_not_matter(runs, case):
    shorter = () if not isinstance(case, str) else ("simulation.duration=0.02",)
    history = runs(case, *shorter).history
    assert verdict(history) == "pass"
    interval = float(history["time"][1] - history["time"][0])
    finer = runs(case, *shorter, every(interval / 7)).history
    assert verdict(finer) == "pass"
    # IDA also locates events between outputs: their times may differ by rounding
    assert_same(history, finer, 1e-6)


def test_where_an_extreme_is_told_the_motion_has_that_value(runs):
    """Outputs that end at the time of an extreme: the last one is the extreme."""
    settings = (*LINEAR, "simulation.duration=0.004")
    history = runs(GEARS, *settings).history
    for extreme in recorded_extremes(history):
        end = float(extreme.time[0])
        if extreme.output not in ("penetration", "transmission_error") or end == 0:
            continue
        ends = runs(GEARS, LINEAR[0], LINEAR[1], LINEAR[2], f"simulation.duration={end!r}").history
        last = float(ends[extreme.output][-1, 0])
        assert last == pytest.approx(float(extreme.value[0]), rel=1e-8)


def test_a_run_that_fails_tells_the_extremes_so_far(runs):
    case = pair(duration=0.02)
    # beyond the limit of Johnson's law, after some time
    table = {"kind": "table", "time": [0, 0.01, 0.0101], "torque": [-1, -1, -1e10]}
    case["wheels"][0]["loads"] = [table]
    run = runs(case)
    assert run.exit_code == 4
    assert {str(e.value.name) for e in recorded_extremes(run.history)} == NAMES
    assert verdict(run.history) == "pass"
    assert float(run.history["normal_force_max_time"][0]) <= float(run.history["time"][-1])


def test_impacts_of_a_rigid_contact_leave_the_force_between_them(runs):
    case = rigid(pair(duration=0.05), restitution=0.5)
    case["simulation"]["initial"] = {"kind": "rest", "gaps": {"pinion-gear": 1e-6}}
    run = runs(case)
    assert run.times("impact").size > 0
    largest = run.history["normal_force_max"]
    assert "between impacts" in largest.attrs["long_name"]
    assert np.isfinite(largest.values).all()
    assert verdict(run.history) == "pass"


def test_a_wrong_extreme_fails_the_check(runs):
    history = runs(GEARS, STRONG, "simulation.duration=0.02").history
    for extreme in recorded_extremes(history):
        name = str(extreme.value.name)
        sense = 1 if extreme.is_largest else -1
        wrong = sampled(history, extreme) - sense * 1e-6 * unit(history, extreme)
        assert verdict(history.assign({name: ("mesh", wrong)})) == "fail", name
