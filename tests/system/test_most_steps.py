"""Limit of the number of steps: no run is endless, and it reports the limit that it would need."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from evolvent import check_history
from system.runs import Run, Runs
from system.wide_gearboxes import wide_case

AT_ONCE = 1000  # steps of IDA between two checks
OUT_OF_STEPS = re.compile(
    r"t = \S+ s: the run is not complete after (?P<made>\d+) steps; at this rate it requires "
    r"(?P<more>\S+) more, \S+ (s|min|h|days|years) of CPU; increase simulation.max_steps"
)


def steps(run: Run) -> int:
    return int(run.history.attrs["integrator_steps"])


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_a_run_that_has_taken_its_steps_ends_and_foretells_the_others(
    runs: Runs, integrator: str
) -> None:
    by = (f"simulation.integrator={integrator}", "simulation.duration=0.5")
    whole = runs("rattle.yaml", *by)
    most = steps(whole) // 2
    stopped = runs("rattle.yaml", *by, f"simulation.max_steps={most}")
    assert stopped.exit_code == 4
    reported = OUT_OF_STEPS.search(stopped.messages.splitlines()[-1])
    assert reported, stopped.messages
    assert most <= int(reported["made"]) <= most + AT_ONCE
    all_of_them = int(reported["made"]) + float(reported["more"])
    assert 0.5 * steps(whole) < all_of_them < 2 * steps(whole)


@pytest.mark.parametrize("limit", ["none", "1e9"])
def test_steps_that_are_not_needed_change_nothing(runs: Runs, limit: str) -> None:
    run, limited = runs("paper.yaml"), runs("paper.yaml", f"simulation.max_steps={limit}")
    assert steps(run) == steps(limited)
    for name in ("angular_velocity", "normal_force"):
        np.testing.assert_array_equal(run.history[name], limited.history[name])


@pytest.mark.parametrize("seed", [59, 9139])
def test_gearboxes_that_take_very_long_say_so(executable: Path, tmp_path: Path, seed: int) -> None:
    """Rigid flanks with 6000 impacts and more."""
    case, most = tmp_path / "case.yaml", 20_000
    case.write_text(json.dumps(wide_case(executable, seed)))
    command = [executable, "run", case, "-o", tmp_path / "h.h5", "--set"]
    done = subprocess.run(
        [*command, f"simulation.max_steps={most}"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 4
    reported = OUT_OF_STEPS.search(done.stderr.splitlines()[-1])
    assert reported, done.stderr
    assert most <= int(reported["made"]) <= most + AT_ONCE
    assert float(reported["more"]) > 10 * most


@pytest.mark.parametrize("seed", [0, 1514, 5554, 6050, 8644, 9714])
def test_a_tolerance_below_rounding_takes_no_more_steps_for_that(
    executable: Path, tmp_path: Path, seed: int
) -> None:
    """A tonne and 1e-4 N m, dampers of 3e16 N s/m2, housings of micrometres: once millions."""
    case, history = tmp_path / "case.yaml", tmp_path / "h.h5"
    case.write_text(json.dumps(wide_case(executable, seed)))
    command = [executable, "run", case, "-o", history, "--set", "simulation.max_steps=300000"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(history, engine="netcdf4") as run:
        assert [v for v in check_history(run.load()) if v.failed] == []
