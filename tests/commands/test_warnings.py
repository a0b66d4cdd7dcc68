"""Warnings about valid input: every warning names its component, in all outputs."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from designs import read_journal, write_design

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT = ("simulation.duration=1e-4", "simulation.output_interval=1e-4")
AGAINST = "its driving wheel turns against driving_rotation"

# Each warning of the kernel: an example, its changes, the component, the start of the message.
WARNINGS = {
    "a thin tip": (
        "spur-pair.yaml",
        "wheels.pinion.thickness_allowance=-1.1e-3",
        "wheels.pinion",
        "the tooth is ",
    ),
    "contact lost in every pitch": (
        "spur-pair.yaml",
        "meshes.0.centre_distance=0.0845",
        "meshes.pinion-gear",
        "its contact ratio is 0.542453, less than 1",
    ),
    "a wide contact strip": (
        "spur-pair.yaml",
        "wheels.pinion.width=10 um",
        "meshes.pinion-gear",
        "under its load of about 1866.98 N the contact strip is ",
    ),
    "no pitch point": (
        "paper.yaml",
        "wheels.gear.teeth=90",
        "meshes.pinion-gear",
        "its path of contact does not contain the pitch point",
    ),
    "rounded catalogue data": (
        "spur-pair.yaml",
        "meshes.0.centre_distance=0.0808122",
        "meshes.pinion-gear",
        "at its centre distance the normal backlash would be -3.32863E-07 m",
    ),
    "millimetres given as metres": (
        "paper-friction.yaml",
        "wheels.pinion.pitch_radius=200",
        "--set wheels.pinion.pitch_radius=200",
        "wheels.pinion.pitch_radius: 200 m is outside the plausible range, 0.1 mm to 2.5 m; did",
    ),
    "a speed that no gear has": (
        "spur-pair.yaml",
        "wheels.gear.loads.0.coefficient=1e-4",
        "wheels.pinion",
        "loads and initial state give it a speed of ",
    ),
    "a mesh against the first one": (
        "two-stage.yaml",
        "meshes.1.driving_rotation=clockwise",
        "meshes.second",
        AGAINST,
    ),
}


def settings(*options: str) -> list[str]:
    return [word for option in options for word in ("--set", option)]


@pytest.mark.parametrize("warning", WARNINGS)
def test_every_warning_names_its_part_as_errors_do(
    evolvent: Evolvent, examples: Path, warning: str
) -> None:
    case, option, part, words = WARNINGS[warning]
    angle = ("meshes.0.pressure_angle=20", "wheels.gear.mass=100")
    options = [option, *angle] if case == "paper.yaml" else [option]
    result = evolvent("show", examples / case, "--json", *settings(*options))
    texts = json.loads(result.stdout)["warnings"]
    assert sum(text.startswith(f"{part}: {words}") for text in texts) == 1


def test_every_command_tells_a_warning_in_the_same_words(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    option = "meshes.second.driving_rotation=clockwise"
    case = (examples / "two-stage.yaml", *settings(option, *SHORT))
    shown = evolvent("show", *case)
    assert shown.returncode == 0
    text = shown.stdout.split("\nWarnings\n  ")[1].rstrip("\n")
    assert text.startswith(f"meshes.second: {AGAINST}")
    assert json.loads(evolvent("show", *case, "--json").stdout)["warnings"] == [text]
    for command in (("modes", "--at", "0"), ("run", "-o", "x.h5"), ("run", "-q", "-o", "x.h5")):
        reported = evolvent(command[0], *case, *command[1:])
        assert reported.returncode == 0
        assert reported.stderr.splitlines()[0] == f"evolvent: warning: {text}"
    said = [line.removeprefix("evolvent: warning: ") for line in reported.stderr.splitlines()]
    assert said[1:] == ["the flanks of mesh 'second' never touched"]
    with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
        assert history.attrs["warnings"] == text
    base = (examples / "two-stage.yaml").read_text()
    columns = {SHORT[0].split("=")[0]: [1e-4], SHORT[1].split("=")[0]: [1e-4]}
    columns |= {"meshes.second.driving_rotation": ["clockwise"]}
    design = write_design(tmp_path / "design.h5", columns, base, (0.0, 1e-4))
    assert evolvent("batch", design, "-o", "r").returncode == 0
    assert read_journal(tmp_path / "r/shard-1-of-1.jsonl").cases[0]["message"] == "; ".join(said)
