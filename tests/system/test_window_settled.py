"""Whether the motion has settled before a window of metrics, against a run ten times as long."""

from __future__ import annotations

import json
import math
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from system.runs import RIGID, Run, Runs

Case = dict[str, Any]
OF_MEAN, OF_RANGE = 0.01, 0.05  # of the rms; of the peak to peak
LENGTH = 5e-3  # of a window [s]
SPEED, TORQUE = 157.08, 89.5  # of the pinion [rad/s], at the gear [N m]


def pair(
    examples: Path, zeta: float, *, start: str = "speeds", integrator: str = "radau", **options: Any
) -> Case:
    """A pinion with prescribed speed; flanks without initial load."""
    case = yaml.safe_load((examples / "spur-pair.yaml").read_text())
    pinion, gear = case["wheels"]
    pinion["loads"] = [{"kind": "speed", "value": -SPEED}]
    gear["loads"] = [{"kind": "torque", "value": -TORQUE}]
    case["meshes"][0]["damping"] = {"law": "ratio", "value": zeta}
    case["meshes"][0]["friction"]["coefficient"] = 0.0
    initial: Case = {"kind": start}
    if start == "speeds":
        initial["speeds"] = {"pinion": -SPEED, "gear": SPEED * 19 / 34}
    case["simulation"] = {"output_interval": 1e-3, "integrator": integrator, "initial": initial}
    return case | options


def driven(examples: Path, slope: float, start: str = "speeds") -> Case:
    """A motor whose speed settles: a motion without vibration."""
    case = pair(examples, 0.07, start=start)
    pinion, gear = case["wheels"]
    drive = {"kind": "drive", "speed": -SPEED, "torque": -TORQUE * 19 / 34, "slope": -slope}
    pinion |= {"inertia": 0.01, "loads": [drive]}
    gear["inertia"] = 0.02
    speeds = case["simulation"]["initial"].get("speeds", {})
    speeds |= {name: 0.9 * speed for name, speed in speeds.items()}
    return case


def with_machine(examples: Path, damping: float) -> Case:
    """A machine on a shaft without initial twist: 100 Hz."""
    case = pair(examples, 0.07)
    case["wheels"][1].pop("loads")
    machine = {"name": "machine", "inertia": 0.02, "mass": 20.0, "width": 0.1, "material": "steel"}
    machine["loads"] = [{"kind": "torque", "value": -TORQUE}]
    case["wheels"].append(machine)
    shaft = {"name": "output", "wheels": ["gear", "machine"], "stiffness": 8e3}
    case["shafts"] = [shaft | {"damping": damping}]
    case["simulation"]["initial"]["speeds"]["machine"] = SPEED * 19 / 34
    return case


CASES = {  # what moves: start of windows that are not settled, and of those that are [s]
    "damping ratio 0.07": (lambda of: pair(of, 0.07), [0.0], [2e-3]),
    "damping ratio 0.02": (lambda of: pair(of, 0.02), [1e-3], [6e-3]),
    "damping ratio 0.02 by IDA": (lambda of: pair(of, 0.02, integrator="ida"), [1e-3], [6e-3]),
    "damping ratio 0.005": (lambda of: pair(of, 0.005), [0.0, 4e-3], [0.03]),
    "from rest": (lambda of: driven(of, 2.0, start="rest"), [5e-3, 0.012], [0.1]),
    "steady start": (lambda of: pair(of, 0.02, start="steady"), [], [6e-3, 0.02]),
    "drive": (lambda of: driven(of, 2.0), [1e-3], [0.1]),
    "damped shaft": (lambda of: with_machine(of, 4.0), [5e-3, 0.02], [0.2]),
    "shaft": (lambda of: with_machine(of, 1.0), [0.05], [0.5]),
}
LISTED = [
    pytest.param(
        make, begin, settled, id=f"{name}, {'settled' if settled else 'unsettled'} {begin}"
    )
    for name, (make, early, late) in CASES.items()
    for settled, begins in ((False, early), (True, late))
    for begin in begins
]


def windowed(runs: Runs, case: Case, begin: float, length: float = LENGTH) -> Run:
    case = json.loads(json.dumps(case))
    case["simulation"] |= {"duration": begin + length, "metrics": {"from": begin}}
    run = runs(case)
    assert run.exit_code == 0, run.messages
    return run


def farthest(one: Run, other: Run) -> float:
    """Largest difference of the metrics of two runs, over its tolerance."""
    worst = 0.0
    for name in ("transmission_error", "normal_force", "angular_acceleration"):
        a, b = (
            {
                what: run.history[f"window_{name}_{what}"].values
                for what in ("mean", "rms", "peak_to_peak")
            }
            for run in (one, other)
        )
        least = 1e-4 * b["rms"].max()
        allowed = {
            "mean": OF_MEAN * b["rms"],
            "rms": OF_MEAN * b["rms"],
            "peak_to_peak": OF_RANGE * b["peak_to_peak"],
        }
        for what, most in allowed.items():
            worst = max(worst, *(abs(a[what] - b[what]) / np.maximum(most, least)))
    return worst


def test_there_are_ten_cases_of_each() -> None:
    settled = [param.values[2] for param in LISTED]
    assert settled.count(True) >= 10
    assert settled.count(False) >= 10


@pytest.mark.parametrize(("make", "begin", "settled"), LISTED)
def test_a_window_is_settled_where_a_run_ten_times_as_long_has_its_metrics(
    runs: Runs, examples: Path, make: Any, begin: float, settled: bool
) -> None:
    case = make(examples)
    run = windowed(runs, case, begin)
    late = windowed(runs, case, max(10 * (begin + LENGTH), 0.6 if "shafts" in case else 0.15))
    far = farthest(run, late)
    assert (far < 1) == settled, far
    assert float(run.history["window_settled"]) == settled, run.history.attrs[
        "window_settled_reason"
    ]
    assert float(late.history["window_settled"]) == 1, late.history.attrs["window_settled_reason"]
    assert (run.history.attrs["window_settled_reason"] == "") == settled
    assert ("evolvent: the motion has settled before the window" in run.messages) == settled
    assert ("evolvent: warning: the window from" in run.messages) == (not settled)


def test_an_undamped_mode_is_not_settling_and_its_frequency_is_told(
    runs: Runs, examples: Path
) -> None:
    case = pair(examples, 0.02)
    case["meshes"][0]["damping"] = {"law": "none"}
    run = windowed(runs, case, 0.05)
    assert float(run.history["window_settled"]) == 0
    reported = re.search(r"in an undamped mode of ([\d.]+) Hz, which does not settle", run.messages)
    assert reported is not None, run.messages
    case["simulation"] |= {"duration": 1.0, "initial": {"kind": "steady"}}
    file = runs.folder / "undamped.yaml"
    file.write_text(json.dumps(case))
    command = [runs.executable, "modes", "--mean", "--json", file]
    modes = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    frequencies = [
        mode["natural_frequency"] for mode in modes["modes"] if mode["natural_frequency"]
    ]
    assert min(abs(f / float(reported[1]) - 1) for f in frequencies) < 0.02


def test_where_there_are_no_modes_it_is_missing_with_the_reason(runs: Runs, examples: Path) -> None:
    settings = (*RIGID, "simulation.duration=8", "simulation.metrics={from: 0.5}")
    run = runs("paper-friction.yaml", *settings)
    assert run.exit_code == 0, run.messages
    assert math.isnan(float(run.history["window_settled"]))
    assert "this contact is rigid" in run.history.attrs["window_settled_reason"]
    assert "may not be settled: the initial transient cannot be estimated" in run.messages
    assert np.isfinite(run.history["window_normal_force_mean"].values).all()
