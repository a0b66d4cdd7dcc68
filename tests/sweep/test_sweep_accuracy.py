"""Sweeps state an accuracy of 1e-6 where nobody says another, and `run` gives the same numbers."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
import yaml

from evolvent.sweep.design import read_design, write_design
from evolvent.sweep.plan import ACCURACY, make_plan, with_accuracy
from example_cases import CASES

SAID = "simulation.tolerance", "simulation.accuracy", "simulation"
PLAN = """
format: 1
case: case.yaml
method: factorial
parameters:
- {path: wheels.pinion.loads.0.value, values: [-1, -2]}
"""


def numbers(text: str) -> Any:
    case = yaml.safe_load(text)
    simulation = case["simulation"]
    for name in ("accuracy", "tolerance"):
        if name in simulation:
            simulation[name] = float(simulation[name])
    return case


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
@pytest.mark.parametrize("form", ["as it is", "JSON", "one line", "comments"])
def test_the_accuracy_is_all_that_is_added_to_a_case(path: Path, form: str) -> None:
    text = path.read_text(encoding="utf-8")
    if form == "JSON":
        text = json.dumps(yaml.safe_load(text))
    elif form == "one line":
        text = yaml.safe_dump(yaml.safe_load(text), default_flow_style=True)
    elif form == "comments":
        text = text.replace("simulation:", "simulation: # of the run\n\n  # how long\n")
    made = with_accuracy(text, [None, "wheels.0.teeth"])
    expected = numbers(text)
    expected["simulation"]["accuracy"] = float(ACCURACY)
    assert numbers(made) == expected
    assert len(made) - len(text) < 30
    if form == "JSON":
        json.loads(made)


@pytest.mark.parametrize("path", CASES, ids=lambda path: path.stem)
def test_a_case_or_plan_that_says_it_stays_as_it_is(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    for name, value in (("tolerance", 1e-9), ("accuracy", 1e-4)):
        said = numbers(text)
        said["simulation"][name] = value
        said_text = yaml.safe_dump(said)
        assert with_accuracy(said_text, []) == said_text
    for by in SAID:
        assert with_accuracy(text, ["x", by]) == text


@pytest.mark.parametrize("text", ["", "a: [", "simulation: {}", "simulation: 3", "- 1", "{a: 1}"])
def test_what_is_no_case_is_left_to_the_program(text: str) -> None:
    assert with_accuracy(text, []) == text


@pytest.mark.parametrize("tracking", ["closed_form", "differential"])
def test_run_of_a_design_s_case_gives_the_numbers_of_the_sweep(
    examples: Path, executable: Path, tmp_path: Path, tracking: str
) -> None:
    text = (examples / "paper.yaml").read_text(encoding="utf-8")
    text = text.replace("tracking: differential", f"tracking: {tracking}")
    (tmp_path / "case.yaml").write_text(text.replace("duration: 5 ", "duration: 0.2 "))
    (tmp_path / "sweep.yaml").write_text(PLAN)
    design, _ = make_plan(tmp_path / "sweep.yaml", executable)
    write_design(design, tmp_path / "design.h5")
    case = tmp_path / "of-design.yaml"
    case.write_text(read_design(tmp_path / "design.h5").case, encoding="utf-8")
    assert f"accuracy: {ACCURACY}" in case.read_text()
    folder = tmp_path / "results"
    subprocess.run([executable, "batch", tmp_path / "design.h5", "-o", folder, "-q"], check=True)
    lines = (folder / "shard-1-of-1.jsonl").read_text().splitlines()[1:]
    for record in map(json.loads, lines):
        value = design.parameters[0].values[record["case"]]
        output = tmp_path / "history.h5"
        setting = f"wheels.pinion.loads.0.value={value}"
        command = [executable, "run", case, "-o", output, "--set", setting]
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        with xr.open_dataset(output, engine="netcdf4") as history:
            assert record["steps"] == history.attrs["integrator_steps"]
            assert record["events_tooth_switch"] == 0
            window = history.sel(time=slice(0.1, None))
            # means are of the outputs alone
            mean = float(window.normal_force.integrate("time").item() / 0.1)
            assert record["normal_force_mean"] == pytest.approx(mean, rel=1e-12)
