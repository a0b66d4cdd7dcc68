"""The programs of examples/python do what they say, with the tools that they are for."""

from __future__ import annotations

import csv
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import evolvent as package
import machine

NUMBER = r"(-?\d+\.\d+)"
Run = Callable[..., str]


@pytest.fixture
def run(root: Path, executable: Path, tmp_path: Path) -> Run:
    """Run Python in an empty folder, with the program of the build; what it prints."""
    folders = [str(root / "postprocess"), os.environ.get("PYTHONPATH", "")]
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "evolvent").symlink_to(executable)
    path = [str(tmp_path / "bin"), str(Path(sys.executable).parent), os.environ["PATH"]]

    def run(*words: object) -> str:
        (tmp_path / "work").mkdir(exist_ok=True)
        done = subprocess.run(
            [sys.executable, *map(str, words)],
            cwd=tmp_path / "work",
            env=os.environ
            | {
                "PYTHONPATH": os.pathsep.join(filter(None, folders)),
                "PATH": os.pathsep.join(path),
                "HOME": str(tmp_path),  # caches of the tools
                "XDG_CACHE_HOME": str(tmp_path / "cache"),
            },
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def test_relief_that_is_found_serves_the_band_better_than_none(run: Run, examples: Path) -> None:
    """Its figure is that of an analysis by itself."""
    machine.module("optuna")
    case = examples / "compliant-pair.yaml"
    printed = run(examples / "python" / "relief_for_torques.py", case, 12)
    (none,) = re.findall(rf"without relief {NUMBER} um", printed)
    ((amount, depth, best),) = re.findall(
        rf"with {NUMBER} um from {NUMBER} mm {NUMBER} um", printed
    )
    assert float(best) < 0.9 * float(none)
    settings = {
        f"wheels.{wheel}.tip_relief": f"{{amount: {amount} um, diameter: {tip - float(depth)} mm}}"
        for wheel, tip in (("pinion", 65.4), ("gear", 108.6))
    }
    worst = max(
        float(
            package.static(
                case, settings, torque=torque, points=60
            ).peak_to_peak_transmission_error[0]
        )
        for torque in (50, 100, 150)
    )
    assert 1e6 * worst == pytest.approx(float(best), abs=0.01)  # parameters as they are printed


def test_friction_decides_about_the_dynamic_factor_of_stiff_gears(run: Run, examples: Path) -> None:
    """Of 2048 runs 0.61; torque and damping act through each other, with nothing of first order."""
    machine.module("SALib")
    printed = run(examples / "python" / "sobol_indices.py", examples / "spur-pair.yaml", 64)
    found = re.findall(rf"(\w+) +first order {NUMBER}, total {NUMBER}", printed)
    first = {name: float(index) for name, index, _ in found}
    assert first.keys() == {"torque", "damping", "friction"}
    assert first["friction"] == pytest.approx(0.61, abs=0.1)  # of so few samples
    assert abs(first["torque"]) < 0.1
    assert abs(first["damping"]) < 0.1


def test_workers_of_dask_give_the_bits_of_this_process(run: Run, examples: Path) -> None:
    machine.module("distributed")
    printed = run(examples / "python" / "dask_torques.py", examples / "paper.yaml")
    forces = re.findall(rf"(\d) N m: {NUMBER} N", printed)
    assert [torque for torque, _ in forces] == ["1", "2", "3", "4"]
    for torque, force in forces:
        assert force == f"{largest_force(examples / 'paper.yaml', int(torque)):.3f}"


def largest_force(case: Path, torque: int) -> float:
    settings = {"wheels.pinion.loads.0.value": -torque, "simulation.duration": 0.5}
    return float(package.run(case, settings).normal_force.max())


def test_snakemake_runs_what_is_missing_and_nothing_else(
    run: Run, examples: Path, tmp_path: Path
) -> None:
    machine.module("snakemake")
    case = tmp_path / "case.yaml"
    case.write_text((examples / "paper.yaml").read_text())
    recipe = ("-s", examples / "python" / "Snakefile", "--cores", 2, "--config", f"case={case}")
    run("-m", "snakemake", *recipe)
    work = tmp_path / "work"
    with (work / "forces.csv").open() as table:
        forces = {int(row["torque"]): float(row["largest_force"]) for row in csv.DictReader(table)}
    assert forces == {torque: largest_force(case, torque) for torque in (1, 2, 4)}
    before = {path.name: path.stat().st_mtime_ns for path in work.glob("*.*")}
    for name in ("torque-2.h5", "forces.csv"):
        (work / name).unlink()
    run("-m", "snakemake", *recipe)
    after = {path.name: path.stat().st_mtime_ns for path in work.glob("*.*")}
    assert {name for name in after if after[name] != before[name]} == {"torque-2.h5", "forces.csv"}
