"""The table of signs in docs/guides/operating_points.md, row by row, by runs."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

PAGE = Path(__file__).resolve().parents[2] / "docs" / "guides" / "operating_points.md"
ROW = re.compile(r"^\| the dri\w+ wheel.*\| (\w*clockwise) (.*)\|$", re.MULTILINE)
SIGNS = {"+": 1, "-": -1}
SPEED, TORQUE, RATIO = 157.08, 50.0, 34 / 19  # of examples/spur-pair.yaml: rad/s, N m
CASE = 3


def rows() -> list[list[str]]:
    """Rows of the table, from driving_rotation on."""
    found = ROW.findall(PAGE.read_text(encoding="utf-8"))
    return [
        [rotation, *(word.strip() for word in rest.strip("| ").split("|"))]
        for rotation, rest in found
    ]


def sign(values: np.ndarray) -> int:
    """The one sign that all values have."""
    signs = set(np.sign(values).astype(int).ravel().tolist())
    assert len(signs) == 1, signs
    return signs.pop()


def settings(**options: object) -> list[str]:
    return [word for key, value in options.items() for word in ("--set", f"{key}={value}")]


def of_row(row: list[str], start: str) -> list[str]:
    rotation, driving, _, load_driving, load_driven, *_ = row
    turns = SIGNS[driving] * SPEED
    drive = f"[{{kind: drive, speed: {turns}, torque: {SIGNS[load_driving] * TORQUE}, slope: -1}}]"
    load = f"[{{kind: torque, value: {SIGNS[load_driven] * TORQUE * RATIO}}}]"
    speeds = f"{{kind: speeds, speeds: {{pinion: {turns}, gear: {-turns / RATIO}}}}}"
    return settings(
        **{
            "meshes.0.driving_rotation": rotation,
            "wheels.pinion.loads": drive,
            "wheels.gear.loads": load,
            "simulation.duration": 0.02,
            "simulation.initial": speeds if start == "speeds" else "{kind: steady}",
        }
    )


def test_the_table_has_every_sense_of_rotation_with_either_flank() -> None:
    assert {(row[0], row[5]) for row in rows()} == {
        (rotation, flank)
        for rotation in ("clockwise", "counterclockwise")
        for flank in ("drive", "coast")
    }


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"{row[0]}, {row[5]}")
def test_a_row_of_the_table_of_signs_is_what_runs_do(
    evolvent: Evolvent, examples: Path, tmp_path: Path, row: list[str]
) -> None:
    case = examples / "spur-pair.yaml"
    done = evolvent("run", case, "-q", "-o", "row.h5", *of_row(row, "speeds"))
    assert done.returncode == 0, done.stderr
    _, driving, driven, load_driving, load_driven, flank, error = row
    with h5py.File(tmp_path / "row.h5") as history:
        late = history["time"][:] > 0.015  # the flanks have met
        speeds = history["angular_velocity"][late]
        assert [sign(speeds[:, 0]), sign(speeds[:, 1])] == [SIGNS[driving], SIGNS[driven]]
        torques = history["load_torque"][late]
        assert [sign(torques[:, 0]), sign(torques[:, 1])] == [
            SIGNS[load_driving],
            SIGNS[load_driven],
        ]
        for wheel, side in enumerate(("driving", "driven")):
            assert sign(history[f"mesh_torque_{side}"][late]) == -sign(torques[:, wheel])
        power = (torques * speeds).mean(axis=0)
        assert (power[0] > 0) == (flank == "drive")
        assert (power[1] < 0) == (flank == "drive")
        sides = np.array([name.decode().split("_")[0] for name in history["pair"][:]])
        force = history["pair_normal_force"][late][:, 0]
        assert (force >= 0).all()
        assert (force[:, sides == flank].sum(axis=1) > 0).all()
        assert (force[:, sides != flank] == 0).all()
        lag = history["transmission_error"][late]
        assert sign(lag) == SIGNS[error]
        if flank == "coast":
            assert (lag < -history["backlash"][:]).all()
    steady = evolvent("run", case, "-q", "-o", "steady.h5", *of_row(row, "steady"))
    assert steady.returncode == (0 if flank == "drive" else CASE)


def test_signs_along_a_train(evolvent: Evolvent, examples: Path, tmp_path: Path) -> None:
    stiff = {f"wheels.{i}.compliance.model": "none" for i in (1, 2, 3, 4)}
    done = evolvent(
        *("run", examples / "tutorial-train.yaml", "-q", "-o", "train.h5"),
        *settings(**stiff, **{"simulation.duration": 0.005, "simulation.metrics": "{from: 0}"}),
    )
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "train.h5") as history:
        wheels = [name.decode() for name in history["wheel"][:]]
        turns = dict(zip(wheels, map(sign, history["angular_velocity"][:].T), strict=True))
        loads = dict(zip(wheels, np.sign(history["load_torque"][0]), strict=True))
        shafts = list(map(sign, history["shaft_torque"][:].T))
    senses = {"motor": 1, "pinion-1": 1, "gear-1": -1, "pinion-2": -1, "gear-2": 1, "machine": 1}
    assert turns == senses
    assert (loads["motor"], loads["machine"]) == (1, -1)
    assert shafts == [1, -1, 1]  # each turns its second wheel on


@pytest.mark.parametrize(
    ("load", "said"),
    [
        ("{kind: drive, speed: 157, torque: 50, slope: 1}", "slope = 1 N m s/rad must be at"),
        ("{kind: viscous, coefficient: -1}", "coefficient: is -1"),
    ],
)
def test_a_load_that_grows_with_the_speed_is_refused(
    evolvent: Evolvent, examples: Path, load: str, said: str
) -> None:
    case = examples / "spur-pair.yaml"
    done = evolvent("run", case, *settings(**{"wheels.pinion.loads": f"[{load}]"}))
    assert done.returncode == CASE
    assert said in done.stderr
