"""`evolvent fmu`: what it refuses, and that the same case gives the same file."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.mark.parametrize(
    ("example", "options", "code", "words"),
    [
        ("paper", [], 3, "paper.yaml:49:13: meshes.pinion-gear.tracking: tracked contact points"),
        ("paper-rigid", [], 3, "a rigid contact is a constraint"),
        ("spur-pair", ["--input", "pinion"], 2, "an input is wheel:NAME:torque or"),
        ("spur-pair", ["--input", "wheel:torque"], 2, "--input wheel:torque: an input is wheel:"),
        ("spur-pair", ["--input", "wheel:worm:torque"], 2, "there is no wheel 'worm'; inputs"),
        ("spur-pair", ["--input", "wheel:pinion:speed"], 2, "has no load {kind: speed,"),
        ("spur-pair", ["--input", "wheel:gear:torque"], 2, "wheel 'gear' has no load"),
        ("rattle", ["--input", "wheel:pinion:speed"], 2, "wheel 'pinion' has no load"),
        ("spur-pair", ["--outputs", "nothing"], 3, "unknown output or group 'nothing'"),
        ("spur-pair", ["-o", "missing/x.fmu"], 74, "missing/x.fmu"),
    ],
)  # fmt: skip
def test_refusals_are_one_line(
    evolvent: Evolvent,
    examples: Path,
    tmp_path: Path,
    example: str,
    options: list[str],
    code: int,
    words: str,
) -> None:
    result = evolvent("fmu", examples / f"{example}.yaml", *options)
    assert result.returncode == code, result.stderr
    assert words in result.stderr
    assert result.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


def test_the_same_case_gives_the_same_bytes(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    for name in ("first.fmu", "second.fmu"):
        assert evolvent("fmu", examples / "spur-pair.yaml", "-o", name).returncode == 0
    first, second = ((tmp_path / name).read_bytes() for name in ("first.fmu", "second.fmu"))
    # The name of the model is that of the file.
    assert len(first) == pytest.approx(len(second), abs=16)
    (tmp_path / "again").mkdir()
    assert evolvent("fmu", examples / "spur-pair.yaml", "-o", "again/first.fmu").returncode == 0
    assert (tmp_path / "again" / "first.fmu").read_bytes() == first
