"""What importers make of an FMU is what `evolvent run` makes of its case."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from fmu.importer import Make, simulate

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
CLOSED = ("--set", "meshes.0.tracking=closed_form")
SERVED = ("spur-pair", "rattle", "high-speed-pair", "tip-relief", "two-stage", "motor-driven")


@pytest.mark.parametrize("example", SERVED)
def test_examples_are_valid(make: Make, examples: Path, example: str) -> None:
    assert validate_fmu(str(make(examples / f"{example}.yaml"))) == []


def test_a_unit_has_one_spelling(make: Make, examples: Path) -> None:
    """Keys have rad/s, results rad s-1."""
    path = make(examples / "spur-pair.yaml", "--input", "wheel:pinion:torque")
    units = {unit.name for unit in read_model_description(str(path)).unitDefinitions}
    assert {"N m", "kg m-3", "m s-1", "rad s-1"} <= units
    assert not [unit for unit in units if "/" in unit]


def test_names_that_xml_could_take_for_something_else_are_valid(make: Make, tmp_path: Path) -> None:
    case = tmp_path / "named.yaml"
    text = """\
format: 1
title: '<a & "b">, a&amp;b'
materials: {steel: {youngs_modulus: 2.0e+11, poisson_ratio: 0.3, density: 7800}}
wheels:
- {name: "räd&<>", teeth: 20, module: 3 mm, width: 0.02, material: steel, centre: [0, 0],
   loads: [{kind: torque, value: 5}]}
- {name: "b'c", teeth: 30, module: 3 mm, width: 0.02, material: steel,
   loads: [{kind: viscous, coefficient: 1}]}
meshes:
- {name: m, driving: "räd&<>", driven: "b'c", driving_rotation: counterclockwise,
   centre_line_angle: 0, backlash: 0.1 mm, contact: {law: johnson},
   damping: {law: linear, coefficient: 1e3}, friction: {law: none}, tracking: closed_form}
simulation: {duration: 0.01, output_interval: 1e-3, initial: {kind: rest}}
"""
    case.write_text(text, encoding="utf-8")
    path = make(case, "--input", "wheel:räd&<>:torque")
    assert validate_fmu(str(path)) == []
    motion = simulate(path, "CoSimulation", ["angular_velocity[räd&<>]"], stop_time=0.01)
    assert motion["angular_velocity[räd&<>]"][-1] > 0


def run(evolvent: Evolvent, case: Path, folder: Path, *options: str) -> h5py.File:
    path = folder / "run.h5"
    result = evolvent("run", case, "-o", path, "-q", *options)
    assert result.returncode == 0, result.stderr
    return h5py.File(path)


# By steps it is the same integration, to the rounding of the importer's times. CVODE makes 500
# steps in an interval at most, and stays within 1e-8 at this tolerance.
@pytest.mark.parametrize(
    ("kind", "duration", "interval", "close"),
    [("CoSimulation", 1, 1e-3, 1e-12), ("ModelExchange", 0.02, 2e-5, 1e-8)],
)
def test_the_papers_case_is_that_of_the_program(
    make: Make,
    evolvent: Evolvent,
    examples: Path,
    tmp_path: Path,
    kind: str,
    duration: float,
    interval: float,
    close: float,
) -> None:
    simulation = f"{{duration: {duration}, output_interval: {interval}, tolerance: 1e-12}}"
    options = (*CLOSED, "--set", f"simulation={simulation}")
    path = make(examples / "paper.yaml", *options, "--input", "wheel:pinion:torque")
    names = ["angular_velocity[gear]", "angle[pinion]", "load_work"]
    times = {"stop_time": duration, "output_interval": interval}
    motion = simulate(path, kind, names, relative_tolerance=1e-12, **times)
    with run(evolvent, examples / "paper.yaml", tmp_path, *options) as history:
        own = [history["angular_velocity"][:, 1], history["angle"][:, 0], history["load_work"][:]]
    for name, expected in zip(names, own, strict=True):
        assert np.abs(motion[name] - expected).max() < close * np.abs(expected).max(), name


@pytest.mark.parametrize("law", ["schlenk", "benedict_kelley"])
def test_a_lubricated_mesh_with_a_load_independent_loss_is_that_of_the_program(
    make: Make, evolvent: Evolvent, examples: Path, tmp_path: Path, law: str
) -> None:
    """The coefficient is that of the nominal operating point, or of each instant."""
    loads = "[{kind: torque, value: -50}, {kind: loss, speed: [10, 100], torque: [1, 2]}]"
    settings = (
        f"meshes.0.friction={{law: {law}, regularisation_velocity: 1 mm/s}}",
        "lubricant={viscosity: 20 mPa s, roughness: 0.5 um}",
        f"wheels.pinion.loads={loads}",
        "simulation={duration: 5 ms, output_interval: 0.1 ms, tolerance: 1e-10,"
        " initial: {kind: steady}}",
    )
    options = [word for setting in settings for word in ("--set", setting)]
    path = make(examples / "spur-pair.yaml", *options)
    names = ["friction_loss[pinion-gear]", "load_loss[pinion]", "dissipated_energy", "load_work"]
    times = {"stop_time": 5e-3, "output_interval": 1e-4}
    motion = simulate(path, "CoSimulation", names, relative_tolerance=1e-10, **times)
    with run(evolvent, examples / "spur-pair.yaml", tmp_path, *options) as history:
        own = [history["friction_loss"][:, 0], history["load_loss"][:, 0]]
        own += [history["dissipated_energy"][:], history["load_work"][:]]
    for name, expected in zip(names, own, strict=True):
        assert np.abs(expected).max() > 0, name
        assert np.abs(motion[name] - expected).max() < 1e-9 * np.abs(expected).max(), name


def test_a_switch_of_tooth_pairs_is_found_where_the_program_finds_it(
    make: Make, evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    options = ("--set", "simulation={duration: 5 ms, output_interval: 1 ms, tolerance: 1e-12,"
               " initial: {kind: steady}}")  # fmt: skip
    path = make(examples / "spur-pair.yaml", *options)
    motion = simulate(
        path,
        "ModelExchange",
        ["pairs_in_contact[pinion-gear]"],
        stop_time=5e-3,
        output_interval=1e-5,
        relative_tolerance=1e-12,
        record_events=True,
    )
    times = motion["time"][1:][np.diff(motion["time"]) == 0]
    with run(evolvent, examples / "spur-pair.yaml", tmp_path, *options) as history:
        events = np.unique(history["events/time"][:])
    assert len(events) > 10
    for event in events:
        assert np.abs(times - event).min() < 1e-10, event


def test_a_run_by_an_fmu_needs_nothing_but_the_c_library(
    make: Make, examples: Path, tmp_path: Path
) -> None:
    import fmpy

    folder = Path(
        fmpy.extract(str(make(examples / "spur-pair.yaml")), unzipdir=str(tmp_path / "x"))
    )
    binaries = folder / "binaries" / "x86_64-linux"
    listed = subprocess.run(
        ["ldd", str(binaries / "evolvent.so")], capture_output=True, text=True, check=True
    ).stdout
    found = re.findall(r"^\s*(?:(\S+) => )?(\S+) \(0x", listed, re.MULTILINE)
    system = re.compile(r"(linux-vdso|ld-linux-x86-64|lib(c|m|gcc_s))\.so(\.\d+)?$")
    outside = [name or path for name, path in found if Path(path).parent != binaries]
    assert all(system.search(name) for name in outside), listed
    assert len(outside) < len(found)  # libgfortran lies beside it
