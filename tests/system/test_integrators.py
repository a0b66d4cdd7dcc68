"""Agreement of both integrators, for cases that they support."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from system.cases import pair, rigid, train
from system.runs import FRICTION, FRICTIONLESS, Run, tracking

IDA, RADAU = ("simulation.integrator=ida", "simulation.integrator=radau")
TIGHT = "simulation.tolerance=1e-13"

# Settings of examples: shorter than the example if a second covers all of its behaviour.
SETTINGS = {
    FRICTIONLESS: (tracking("closed_form"),),
    FRICTION: (tracking("closed_form"),),
    "pair-23-41.yaml": (tracking("closed_form"), "simulation.duration=1"),
}
NOT_SERVED = {"paper-rigid.yaml", "paper-rigid-friction.yaml"}  # by radau
EXAMPLES = {
    file.name: SETTINGS.get(file.name, ())
    for file in sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
    if file.name not in NOT_SERVED and "\nmeshes:" in file.read_text()
}


def rattle() -> dict[str, Any]:
    """Return two gears with backlash; the pinion's speed varies, so both flanks make contact."""
    knots = [0, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3]
    speeds = [-50, -52, -48, -52, -48, -52, -50]
    gear = {"module": 0.003, "width": 0.03, "material": "steel"}
    driver = {"kind": "speed", "time": knots, "speed": speeds}
    case = pair(duration=0.3, output_interval=1e-4)
    case["wheels"] = [
        {"name": "pinion", "teeth": 25, "centre": [0, 0], "loads": [driver], **gear},
        {"name": "gear", "teeth": 40, "loads": [{"kind": "torque", "value": -0.1}], **gear},
    ]
    mesh = case["meshes"][0]
    del mesh["pressure_angle"]
    mesh["backlash"] = 1e-4
    mesh["damping"] = {"law": "flores", "restitution": 0.5, "v0_min": 1e-3}
    mesh["friction"] = {"law": "coulomb", "coefficient": 0.05, "regularisation_velocity": 1e-3}
    case["simulation"]["initial"] = {"kind": "speeds", "speeds": {"pinion": -50, "gear": 31.25}}
    return case


def knots(sense: int) -> dict[str, Any]:
    """Return a pair under a table of torques that turns it in either direction."""
    case = pair(0.3, duration=0.5)
    table = {"kind": "table", "time": [0, 0.1, 0.1013, 0.3, 0.4], "torque": [0, -1, -2, -2, -0.5]}
    table["torque"] = [sense * value for value in table["torque"]]
    case["wheels"][0]["loads"] = [table]
    case["meshes"][0]["driving_rotation"] = "clockwise" if sense > 0 else "counterclockwise"
    return case


def error(run: Run, reference: Run) -> float:
    """Largest difference of the gap over its largest value in contact."""
    gap, expected = run.history["gap"].values, reference.history["gap"].values
    return float(np.abs(gap - expected).max() / np.abs(expected).max())


def assert_same_events(run: Run, other: Run) -> None:
    events, others = run.events, other.events
    for name in ("kind", "mesh", "flank", "tooth_pair"):
        assert events[name].values.tolist() == others[name].values.tolist(), name
    np.testing.assert_allclose(events["time"], others["time"], rtol=0, atol=1e-8)


def check_both(ida: Run, radau: Run, exact: Run) -> None:
    assert (ida.exit_code, radau.exit_code) == (0, 0)
    assert_same_events(radau, ida)
    assert_same_events(radau, exact)
    assert error(ida, exact) <= 1e-6
    assert error(radau, exact) <= 1e-6
    broken = {v.invariant.name for v in check_history(radau.history) if v.failed}
    assert broken <= {v.invariant.name for v in check_history(ida.history) if v.failed}
    assert "energy balance" not in broken


@pytest.mark.parametrize("example", EXAMPLES)
def test_both_give_the_same_in_every_example_in_closed_form(runs, example):
    settings = EXAMPLES[example]
    ida, radau = runs(example, *settings, IDA), runs(example, *settings, RADAU)
    check_both(ida, radau, runs(example, *settings, RADAU, TIGHT))
    assert radau.history.attrs["integrator_steps"] < ida.history.attrs["integrator_steps"] / 5


def test_both_find_every_loss_of_contact_and_every_return_of_rattling_gears(runs):
    case = rattle()
    ida, radau = runs(case, IDA), runs(case, RADAU)
    check_both(ida, radau, runs(case, RADAU, TIGHT))
    for kind in ("contact_opened", "contact_closed"):
        assert radau.times(kind).size > 40
    assert set(radau.events["flank"].values) >= {0, 1}


@pytest.mark.parametrize("sense", [1, -1])
def test_both_meet_the_knots_of_a_table_of_torques_in_both_senses(runs, sense):
    case = knots(sense)
    ida, radau = runs(case, IDA), runs(case, RADAU)
    check_both(ida, radau, runs(case, RADAU, TIGHT))
    assert radau.times("table_knot").tolist() == [0.1, 0.1013, 0.3, 0.4]


def test_both_run_a_train_alike(runs):
    case = train(0.1, "closed_form")
    check_both(runs(case, IDA), runs(case, RADAU), runs(case, RADAU, TIGHT))


@pytest.mark.parametrize("example", [FRICTIONLESS, FRICTION])
def test_the_paper_s_case_is_right_to_a_millionth_of_the_penetration_by_default(runs, example):
    run = runs(example, tracking("closed_form"))
    assert "integrator: radau" in run.history.attrs["case"]
    assert error(run, runs(example, tracking("closed_form"), RADAU, TIGHT)) <= 1e-6


@pytest.mark.parametrize("kind", ["algebraic", "differential"])
def test_ida_is_taken_where_radau_does_not_serve(runs, kind):
    case = pair(tracking=kind, duration=0.05)
    for cannot in (case, rigid(pair(duration=0.05))):
        assert "integrator: ida" in runs(cannot).history.attrs["case"]
    below = runs(pair(duration=0.05, tolerance=1e-14))
    assert "integrator: ida" in below.history.attrs["case"]


def test_the_attributes_tell_what_an_integrator_counts(runs):
    radau = runs(FRICTION, *EXAMPLES[FRICTION], RADAU).history.attrs
    assert "integrator_error_test_failures" not in radau
    assert radau["integrator_rejections"] < radau["integrator_steps"]
    assert radau["integrator_residuals"] >= 7 * radau["integrator_newton_iterations"]
    ida = runs(FRICTION, *EXAMPLES[FRICTION], IDA).history.attrs
    assert "integrator_rejections" not in ida
    assert radau["integrator_events"] == ida["integrator_events"]
