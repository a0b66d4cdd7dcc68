"""Analyses of an internal pair agree with each other: static, steady, periodic, response, batch."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from designs import write_design
from system.internal_cases import internal_pair
from system.runs import Runs

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
Block = dict[str, Any]


def driven(start: str = "steady") -> Block:
    """Pinion by a drive at 126 rad/s against a brake, over a window of whole pitches."""
    mesh = {
        "damping": {"law": "ratio", "value": 0.06},
        "friction": {"law": "coulomb", "coefficient": 0.05},
    }
    drive = {"kind": "drive", "speed": 126.0, "torque": 120.0, "slope": -1.0}
    return internal_pair(
        mesh=mesh,
        pinion={"loads": [drive]},
        duration=0.06,
        tolerance=1e-10,
        initial={"kind": start},
        metrics={"from": 0.03},
    )


def test_steady_and_periodic_start_lead_to_the_same_motion(runs: Runs) -> None:
    found = [runs(driven(start)) for start in ("steady", "periodic")]
    forces = [run.history["normal_force_max"].values for run in found]
    assert all(run.exit_code == 0 for run in found)
    last = [run.history["transmission_error"].values[-400:].max() for run in found]
    assert last[0] == pytest.approx(last[1], rel=1e-4)
    assert forces[0].shape == forces[1].shape


def test_orbits_are_those_of_the_sweep(evolvent: Evolvent, tmp_path: Path) -> None:
    file = tmp_path / "ring.yaml"
    file.write_text(json.dumps(driven()))
    over = ("--over", "wheels.pinion.loads.0.speed=105:126:3", "-q")
    peaks = {}
    for method in ("sweep", "orbits"):
        result = tmp_path / f"{method}.h5"
        done = evolvent("respond", file, *over, "--method", method, "-o", result)
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(result, engine="h5netcdf") as data:
            peaks[method] = np.unique(np.round(data["transmission_error_max"].values.ravel(), 12))
    ends = [peaks["sweep"].min(), peaks["sweep"].max()]
    # the branch of orbits passes through the values of the sweep
    for peak in ends:
        assert np.abs(peaks["orbits"] - peak).min() < 2e-3 * peak


def test_a_slow_run_has_the_static_transmission_error(
    evolvent: Evolvent, tmp_path: Path, runs: Runs
) -> None:
    slow = 0.02  # [rad/s]
    pitch = 2 * math.pi / 35 / slow
    case = internal_pair(
        mesh={"damping": {"law": "ratio", "value": 0.3}},
        ring={"loads": [{"kind": "speed", "value": slow * 35 / 98}]},
        duration=pitch,
        output_interval=pitch / 200,
        initial={"kind": "steady"},
        max_step=pitch / 50,
    )
    run = runs(case)
    assert run.exit_code == 0, run.messages
    error = run.history["transmission_error"].values[20:, 0]
    file = tmp_path / "ring.yaml"
    file.write_text(json.dumps(case))
    result = tmp_path / "static.h5"
    done = evolvent("static", file, "-o", result, "-q")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(result, engine="h5netcdf") as data:
        static = data["transmission_error"].values.ravel()
    # the law of the run has |rho| + h in the logarithm, that of the static analysis |rho|
    assert error.max() == pytest.approx(static.max(), rel=1e-4)
    assert np.percentile(error, 5) == pytest.approx(static.min(), rel=2e-2)


def test_batch_and_run_have_the_same_metrics(
    evolvent: Evolvent, tmp_path: Path, runs: Runs
) -> None:
    case = driven()
    design = write_design(
        tmp_path / "design.h5",
        {"wheels.pinion.loads.0.speed": [110.0, 126.0]},
        json.dumps(case),
    )
    done = evolvent("batch", design, "-o", tmp_path / "results", "-q", "-j", "1")
    assert done.returncode == 0, done.stderr
    lines = (tmp_path / "results" / "shard-1-of-1.jsonl").read_text().splitlines()
    done_cases = [json.loads(line) for line in lines][1:]
    run = runs(case)
    # the numbers of a design are those of the outputs of the second half
    late = run.history.sel(time=slice(0.03, None))["penetration"].values.max()
    assert done_cases[1]["penetration_max"] == pytest.approx(late, rel=1e-5)
    for kind in ("pair_entered", "sliding_began"):
        assert done_cases[1][f"events_{kind}"] == run.times(kind).size
