"""Rejected cases with rigid contact: exit code 3, one line, location, reason and remedy."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Evolvent = Callable[..., "subprocess.CompletedProcess[str]"]
RIGID = ("--set", "meshes.0.contact={law: rigid}", "--set", "meshes.0.damping={law: none}")


def refused(evolvent: Evolvent, *arguments: str | Path) -> str:
    """Return the message; no file remains."""
    result = evolvent("run", *arguments, "-o", "refused.h5")
    assert result.returncode == 3
    assert result.stderr.count("\n") == 1
    return result.stderr


def test_damping_beside_a_rigid_contact_is_refused_where_it_stands(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    said = refused(evolvent, examples / "paper.yaml", *RIGID[:2])
    lines = (examples / "paper.yaml").read_text().splitlines()
    line = next(i for i, text in enumerate(lines, 1) if "law: linear" in text)
    assert re.search(rf"paper\.yaml:{line}:\d+: meshes\.pinion-gear\.damping\.law: ", said)
    assert "choose the damping law none" in said
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("value", ["1.5", "-0.1", ".nan"])
def test_a_restitution_that_is_none_is_refused(
    evolvent: Evolvent, examples: Path, value: str
) -> None:
    setting = f"meshes.0.contact={{law: rigid, restitution: {value}}}"
    said = refused(evolvent, examples / "paper.yaml", "--set", setting, *RIGID[2:])
    assert said.startswith(f"--set {setting}: meshes.pinion-gear.contact.restitution: ")
    if value != ".nan":
        assert "must be from 0 to 1" in said


def test_a_rest_velocity_of_0_is_refused(evolvent: Evolvent, examples: Path) -> None:
    setting = "meshes.0.contact={law: rigid, rest_velocity: 0}"
    said = refused(evolvent, examples / "paper.yaml", "--set", setting, *RIGID[2:])
    assert "contact.rest_velocity: is 0 m/s, must be greater than 0 m/s" in said


def test_a_penetration_at_the_start_is_refused(evolvent: Evolvent, examples: Path) -> None:
    initial = "simulation.initial={kind: rest, gaps: {pinion-gear: -1e-9}}"
    said = refused(evolvent, examples / "paper.yaml", *RIGID, "--set", initial)
    assert "a rigid contact cannot start with the penetration 1E-09 m" in said


def test_a_ring_of_rigid_contacts_is_refused(evolvent: Evolvent, tmp_path: Path) -> None:
    corners = {"a": [0, 0], "b": [0.4, 0], "c": [0.4, 0.4], "d": [0, 0.4]}
    steel = {"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800}
    wheel = {"teeth": 20, "pitch_radius": 0.2, "width": 0.1, "material": "steel"}
    wheels = [{"name": name, "centre": centre, **wheel} for name, centre in corners.items()]
    meshes = [
        {
            "driving": driving,
            "driven": driven,
            "driving_rotation": "clockwise" if driving in "ac" else "counterclockwise",
            "pressure_angle": 20,
            "contact": {"law": "rigid"},
        }
        for driving, driven in ("ab", "bc", "cd", "da")
    ]
    case = {
        "format": 1,
        "materials": {"steel": steel},
        "wheels": wheels,
        "meshes": meshes,
        "simulation": {"duration": 1, "output_interval": 1e-3},
    }
    file = tmp_path / "ring.yaml"
    file.write_text(json.dumps(case))
    said = refused(evolvent, file)
    assert "contact.law: a rigid contact that closes a ring of rigid contacts" in said
    assert "give it an elastic law" in said
