"""Accuracy of a run, and its independence of tracking and of rounding."""

from __future__ import annotations

import numpy as np
import pytest

from system.runs import FRICTION, FRICTIONLESS, TRACKED, TRACKINGS, Run, tracking

CASES = (FRICTIONLESS, FRICTION)


def error(run: Run, reference: Run, name: str, index: int = 0) -> float:
    """Largest difference over the largest value, over the whole run."""
    values = run.history[name].values[:, index]
    expected = reference.history[name].values[:, index]
    assert values.shape == expected.shape
    return float(np.abs(values - expected).max() / np.abs(expected).max())


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize("case", CASES)
def test_the_default_tolerance_keeps_the_promised_accuracy(runs, case, kind):
    run = runs(case, tracking(kind))
    tighter = runs(case, tracking(kind), "simulation.tolerance=1e-11")
    assert error(run, tighter, "gap") <= 1e-6
    assert error(run, tighter, "normal_force") <= 1e-6
    assert error(run, tighter, "angular_velocity", 0) <= 1e-8
    assert error(run, tighter, "angular_velocity", 1) <= 1e-8


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize("case", CASES)
def test_a_tighter_tolerance_gives_a_smaller_error(runs, case, kind):
    run = runs(case, tracking(kind), "simulation.tolerance=1e-10")
    tighter = runs(case, tracking(kind), "simulation.tolerance=1e-12")
    assert error(run, tighter, "gap") <= 2e-7
    assert error(run, tighter, "normal_force") <= 2e-7
    assert error(run, tighter, "angular_velocity", 0) <= 1e-8
    assert error(run, tighter, "angular_velocity", 1) <= 1e-8


@pytest.mark.parametrize("kind", TRACKED)
@pytest.mark.parametrize("case", [*CASES, "pair-23-41.yaml"])
def test_the_three_trackings_give_the_same_penetration(runs, case, kind):
    closed_form = runs(case, tracking("closed_form"))
    assert error(runs(case, tracking(kind)), closed_form, "gap") <= 1e-6


@pytest.mark.parametrize("kind", TRACKED)
@pytest.mark.parametrize("case", CASES)
def test_the_three_trackings_give_the_same_events(runs, case, kind):
    run, closed_form = runs(case, tracking(kind)), runs(case, tracking("closed_form"))
    assert run.times("tooth_switch").size == 2
    assert run.events["kind"].values.tolist() == closed_form.events["kind"].values.tolist()
    apart = np.abs(run.events["time"].values - closed_form.events["time"].values)
    switch = run.events["kind"].values == "tooth_switch"
    assert apart[switch].max() <= 2e-9
    # Sliding crosses the limits of the friction law slowly, so these times have larger errors.
    assert apart.max() <= 2e-6


@pytest.mark.parametrize("kind", TRACKINGS)
def test_the_same_case_gives_the_same_data_to_the_bit(runs, kind):
    first, second = (runs(FRICTION, tracking(kind), copy=copy) for copy in (0, 1))
    assert first.path != second.path
    for group in ("history", "events"):
        one, other = getattr(first, group), getattr(second, group)
        assert set(one.variables) == set(other.variables)
        for name in one.variables:
            assert one[name].dtype == other[name].dtype
            if one[name].dtype.kind in "if":
                assert one[name].values.tobytes() == other[name].values.tobytes(), name
            else:
                assert one[name].values.tolist() == other[name].values.tolist(), name
