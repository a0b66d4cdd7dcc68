"""`show` and `modes` reject with the same message whatever `run` rejects: the whole table."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from commands import test_case as paper_cases
from commands import test_deviation_case as deviations
from commands import test_gears as gears

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
CASE = 3
STEADY = "simulation.initial.kind=steady"
FIRST = "wheels.pinion.loads=[{kind: speed, value: -3}]"
BODY = "housing={kind: mounted, mass: 20, inertia: [1, 1, 1]"
MOTOR = "motor: 0, pinion-1: 0, gear-1: 1, pinion-2: 2, gear-2: 0, drum: 0"

# By the values of one option, from the tests of their wording.
OPTIONS = {
    "paper.yaml": paper_cases.BAD_OPTIONS | paper_cases.BAD_GEOMETRY,
    "tip-relief.yaml": deviations.BAD_OPTIONS,
    "reference": gears.REFUSED,
}
TABLE = [(case, name, (row[0],)) for case, rows in OPTIONS.items() for name, row in rows.items()]

# Gearboxes without a valid start: an example, options, the end of the line.
STARTS: dict[str, tuple[str, tuple[str, ...], str]] = {
    "a load that pulls": (
        "spur-pair.yaml",
        ("wheels.pinion.loads.0.value=1",),
        "",
    ),
    "a pulled paper pair": (
        "paper.yaml",
        (STEADY, "wheels.pinion.loads.0.value=1"),
        "",
    ),
    "no speed is determined": (
        "paper.yaml",
        (STEADY, "wheels.gear.loads=[]"),
        "the steady speed is not determined",
    ),
    "a free housing": (
        "paper.yaml",
        (STEADY, BODY + "}"),
        "the steady state is not determined",
    ),
    "a driven housing": (
        "paper.yaml",
        (STEADY, "housing.kind=prescribed"),
        "a steady start requires a fixed or mounted housing",
    ),
    "a moving housing": (
        "paper.yaml",
        (STEADY, BODY + ", velocity: [1, 0, 0]}"),
        "housing.velocity: a steady start has a housing without velocity",
    ),
    "two prescribed speeds": (
        "paper.yaml",
        (STEADY, FIRST, "wheels.gear.loads=[{kind: speed, value: 2}]"),
        "at most one prescribed speed, but several wheels have one",
    ),
    "a speed that changes": (
        "paper.yaml",
        (STEADY, "wheels.pinion.loads=[{kind: speed, time: [0, 1], speed: [-1, -2]}]"),
        "wheels.pinion.loads.0.time: the prescribed speed of a wheel changes at the start",
    ),
    "a speed that is not there at rest": (
        "paper.yaml",
        (FIRST,),
        "wheels.pinion.loads.0.value: the prescribed speed -3 rad/s does not agree",
    ),
    "two speeds of one rotor": (
        "two-stage.yaml",
        (f"simulation.initial={{kind: speeds, speeds: {{{MOTOR}}}}}",),
        "simulation.initial.speeds.pinion-2: its initial speed 2 rad/s does not agree",
    ),
    "no tooth pair on the path": (
        "spur-pair.yaml",
        ("meshes.0.centre_distance=0.0845", "simulation.initial={kind: steady, position: 0.8}"),
        "under load no tooth pair of a mesh of contact ratio 0.542453 is on the path",
    ),
    "a rigid penetration": (
        "paper-rigid.yaml",
        ("simulation.initial={kind: rest, gaps: {pinion-gear: -1e-9}}",),
        "simulation.initial.gaps.pinion-gear: a rigid contact cannot start with the penetration",
    ),
    "a penetration past the force law": (
        "paper.yaml",
        ("simulation.initial={kind: rest, gaps: {pinion-gear: -0.3}}",),
        "meshes.pinion-gear.contact: penetration h = 0.3 m exceeds the limit",
    ),
    "a gap past the next tooth": (
        "spur-pair.yaml",
        ("simulation.initial={kind: rest, gaps: {pinion-gear: 0.5}}",),
        "simulation.initial.gaps.pinion-gear: its initial gap 0.5 m is more than half a base pitch",
    ),
    "a gap past the involute": (
        "paper.yaml",
        (STEADY, "wheels.pinion.loads.0.value=-1e10"),
        "",
    ),
    "radau with tracked points": (
        "paper.yaml",
        ("simulation.integrator=radau",),
        "tracked contact points are algebraic states",
    ),
    "radau with a rigid contact": (
        "paper-rigid.yaml",
        ("simulation.integrator=radau", "meshes.0.tracking=closed_form"),
        "a rigid contact is a constraint",
    ),
    "radau with a mounted housing": (
        "spur-pair.yaml",
        ("simulation.integrator=radau", BODY + ", mount: {}}"),
        "housing.kind: the accelerations of a mounted housing are coupled",
    ),
}


ALL = (("validate",), ("modes",), ("modes", "--at", "0"), ("show",), ("show", "--json"))


def refused_alike(
    evolvent: Evolvent,
    folder: Path,
    case: Path,
    options: tuple[str, ...],
    commands: Sequence[tuple[str, ...]] = ALL,
) -> tuple[str, dict[str, Any]]:
    """Return the one line of all commands, and the output of `show --json`, if any."""
    settings = [word for option in options for word in ("--set", option)]
    before = sorted(folder.iterdir())
    ran = evolvent("run", case, *settings, "-o", "refused.h5")
    assert (ran.returncode, ran.stdout, ran.stderr.count("\n")) == (CASE, "", 1)
    for command in commands:
        other = evolvent(command[0], case, *settings, *command[1:])
        assert (other.returncode, other.stderr) == (CASE, ran.stderr)
    assert sorted(folder.iterdir()) == before
    return ran.stderr[:-1], json.loads(other.stdout or "{}")


@pytest.mark.parametrize(
    ("case", "options"),
    [(case, options) for case, _, options in TABLE],
    ids=[f"{case}-{name}" for case, name, _ in TABLE],
)
def test_a_value_that_run_refuses_is_refused_by_show_and_modes_in_the_same_words(
    evolvent: Evolvent,
    examples: Path,
    reference: Path,
    tmp_path: Path,
    case: str,
    options: tuple[str, ...],
) -> None:
    path = reference if case == "reference" else examples / case
    line, shown = refused_alike(evolvent, tmp_path, path, options, (("modes",), ("show", "--json")))
    if shown:  # the case has all its keys: only its geometry is invalid
        assert shown["case"]["format"] == 1
        assert shown["refusal"] == line


@pytest.mark.parametrize("name", STARTS)
def test_show_prints_the_geometry_of_a_case_that_cannot_start_and_ends_with_run_s_line(
    evolvent: Evolvent, examples: Path, tmp_path: Path, name: str
) -> None:
    case, options, words = STARTS[name]
    line, shown = refused_alike(evolvent, tmp_path, examples / case, options)
    assert words in line
    assert shown["refusal"] == line
    assert all(mesh["base_pitch"] > 0.0 for mesh in shown["meshes"].values())
    settings = [word for option in options for word in ("--set", option)]
    text = evolvent("show", examples / case, *settings).stdout
    assert all(f"\nMesh {mesh}\n" in text for mesh in shown["meshes"])


def test_a_case_that_run_takes_has_no_refusal(evolvent: Evolvent, examples: Path) -> None:
    shown = json.loads(evolvent("show", examples / "paper.yaml", "--json").stdout)
    assert shown["refusal"] == ""
