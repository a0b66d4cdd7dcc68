"""Steps have no time limit: results do not depend on the duration, and no event is missed."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from system.cases import pair
from system.real_cases import real_pair, speed
from system.runs import FRICTION, FRICTIONLESS, Run, tracking

CLOSED = tracking("closed_form")


def steps(run: Run) -> int:
    return int(run.history.attrs["integrator_steps"])


def same_events(run: Run, other: Run) -> bool:
    """Whether the same events occurred at the same contacts, in the same order."""
    return all(
        np.array_equal(run.events[name].values, other.events[name].values)
        for name in ("kind", "mesh", "tooth_pair", "flank")
        if name in run.events
    )


# Each with the longest time of a step [s], or of a step that an event would cut.
CASES: dict[str, tuple[str, tuple[str, ...], float]] = {
    "paper": (FRICTIONLESS, (CLOSED,), 0.5),
    "friction": (FRICTION, (CLOSED,), 0.2),
    "real gears": ("spur-pair.yaml", ("simulation.duration=0.5",), 1e-4),
    "rattle": ("rattle.yaml", (), 5.3e-3),  # a pitch: between two contacts the motion is smooth
}


@pytest.mark.parametrize(("case", "settings", "cut"), CASES.values(), ids=CASES.keys())
def test_a_longer_run_begins_with_the_bits_of_a_shorter_one(runs, case, settings, cut):
    """Up to the step that is cut by its end."""
    whole = runs(case, *settings)
    end = 0.731 * float(whole.history["time"].values[-1])
    part = runs(case, *settings, f"simulation.duration={end}")
    n = int((part.history["time"].values < end - cut).sum())
    n_events = int((part.events["time"].values < end - cut).sum())
    assert n_events > 0
    for name in ("gap", "angle_deviation", "angular_velocity", "load_work"):
        assert np.array_equal(
            part.history[name].values[:n], whole.history[name].values[:n], equal_nan=True
        ), name
    for name, values in part.events.data_vars.items():
        if "event" in values.dims:
            of_both = (run.events[name].isel(event=slice(n_events)) for run in (part, whole))
            assert next(of_both).identical(next(of_both)), name


def test_five_hundred_seconds_take_no_more_steps_a_second_than_five(runs):
    sparse = "simulation.output_interval=0.5"
    short = runs(FRICTIONLESS, CLOSED, sparse)
    # two pitches and the start in 5 s; 214 of 500 s: the start is over, the rest repeats
    settled = runs(FRICTIONLESS, CLOSED, sparse, "simulation.duration=50")
    long = runs(FRICTIONLESS, CLOSED, sparse, "simulation.duration=95")
    a_second = (steps(long) - steps(settled)) / 45
    assert a_second < 0.25 * steps(short) / 5


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_the_longest_step_is_none_with_radau_and_20_ms_with_ida(runs, integrator):
    said = f"simulation.integrator={integrator}"
    limit = {"radau": "none", "ida": "0.02"}[integrator]
    short = ("simulation.duration=0.5", CLOSED, said)
    silent, stated = (
        runs(FRICTIONLESS, *short),
        runs(FRICTIONLESS, *short, f"simulation.max_step={limit}"),
    )
    assert f"max_step: {limit}" in silent.history.attrs["case"]
    assert silent.history["gap"].values.tobytes() == stated.history["gap"].values.tobytes()


def test_a_longest_step_that_is_stated_holds_for_radau(runs):
    limited = runs(FRICTIONLESS, CLOSED, "simulation.max_step=2e-3")
    assert steps(limited) >= 2500 > steps(runs(FRICTIONLESS, CLOSED))


# ---- short events between two steps

TEETH = (20, 31)
SPEED = 50.0
GAP = 1.996e-5  # initial gap [m]: runout closes it for a fortieth of a revolution in 40


def spinning(**simulation: Any) -> dict[str, Any]:
    """Two gears with constant speeds in spite of contact, which occurs at the largest runout."""
    speeds = {"pinion": -SPEED, "gear": SPEED * TEETH[0] / TEETH[1]}
    start = {"kind": "speeds", "speeds": speeds, "gaps": {"pinion-gear": GAP}}
    return real_pair(
        TEETH,
        wheels=(
            {**speed(speeds["pinion"]), "eccentricity": {"amount": 2e-5, "phase": 170}},
            speed(speeds["gear"]),
        ),
        mesh={"backlash": 1e-3},
        **{"duration": 3.0, "output_interval": 1e-1, "initial": start},
        **simulation,
    )


def test_flanks_that_touch_once_in_a_turn_touch_in_every_turn(runs):
    """Only contact changes the motion: steps extend from tooth to tooth, and none is missed."""
    free, fine = runs(spinning()), runs(spinning(max_step=1e-4))
    touches = free.times("contact_closed")
    assert touches.size == math.ceil(3 * SPEED / (2 * math.pi))
    assert np.diff(touches) == pytest.approx(2 * math.pi / SPEED, rel=1e-6)
    assert same_events(free, fine)
    apart = np.abs(free.events["time"].values - fine.events["time"].values)
    assert apart.max() <= 1e-9
    assert steps(free) < steps(fine) / 5


def shaken(knots: list[float], values: list[float], **simulation: Any) -> dict[str, Any]:
    """The paper's pair in a housing that is at rest except for one jerk."""
    case = pair(**{"duration": 1.0, **simulation})
    motion = {"kind": "table", "axis": "x", "time": knots, "value": values}
    case["housing"] = {"kind": "prescribed", "translation": [motion]}
    return case


def test_a_jerk_of_the_housing_is_not_stepped_over(runs):
    """The housing rests for half a second, moves to and fro in 2 ms, and rests again."""
    quiet = [
        0.4,
        0.2,
        0.1,
        0.05,
        0.02,
        0.01,
        5e-3,
        2e-3,
        1e-3,
    ]  # knots: a spline may oscillate between them
    knots = [*(0.5 - x for x in quiet), 0.5, *(0.5 + x for x in reversed(quiet))]
    jerk = (knots, [1e-6 if t == 0.5 else 0.0 for t in knots])
    run, fine = runs(shaken(*jerk)), runs(shaken(*jerk, max_step=1e-4))
    moved = run.history["centre_displacement"].values[:, 1, 0]
    swing = np.ptp(fine.history["centre_displacement"].values[:, 1, 0])
    assert swing > 1e-9
    np.testing.assert_allclose(
        moved, fine.history["centre_displacement"].values[:, 1, 0], rtol=0, atol=1e-5 * swing
    )
    assert steps(run) < steps(fine) / 4
