"""Outputs at positions: rejected input with locations, contents of histories, and batches."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
import yaml

from designs import read_journal, write_design

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
TORQUE = "wheels.pinion.loads.0.value"
JOURNAL = "r/shard-1-of-1.jsonl"
STACK = "r/shard-1-of-1.h5"
BY_PITCH = {"per_pitch": 10, "mesh": "pinion-gear"}


@pytest.fixture
def content(examples: Path) -> dict[str, Any]:
    """The pair 19/34, short, with ten outputs a pitch."""
    case = yaml.safe_load((examples / "spur-pair.yaml").read_text(encoding="utf-8"))
    case["simulation"] = {"duration": 0.01, "output": BY_PITCH}
    case["simulation"]["initial"] = {"kind": "steady", "position": 0.0}
    return dict(case)


@pytest.fixture
def case(content: dict[str, Any], tmp_path: Path) -> Path:
    path = tmp_path / "pair.yaml"
    path.write_text(yaml.safe_dump(content, sort_keys=False))
    return path


REFUSED = {
    "beside an interval": (
        "simulation.output_interval=1e-4",
        "pair.yaml:51:5: simulation.output: conflicts with output_interval "
        "(--set simulation.output_interval=1e-4); give one of them",
    ),
    "none": (
        "simulation.output={}",
        "simulation.output: has none of interval, per_pitch and per_turn; give one of them",
    ),
    "several": (
        "simulation.output={per_pitch: 3, mesh: pinion-gear, interval: 1e-3}",
        "simulation.output: has more than one of interval, per_pitch and per_turn; give one of",
    ),
    "no number": ("simulation.output.per_pitch=0", "is 0, must be a whole number from 1 to 1e+06"),
    "below none": ("simulation.output.per_pitch=-2", "is -2, must be a whole number from 1"),
    "no whole number": (
        "simulation.output.per_pitch=2.5",
        "simulation.output.per_pitch: is 2.5, must be a whole number from 1 to 1e+06",
    ),
    "of no mesh": (
        "simulation.output={per_pitch: 3}",
        "simulation.output: 'per_pitch' needs 'mesh' in the same block",
    ),
    "of no wheel": (
        "simulation.output={per_turn: 3}",
        "simulation.output: 'per_turn' needs 'wheel' in the same block",
    ),
    "of a mesh that is not there": (
        "simulation.output.mesh=pinion-gaer",
        "simulation.output.mesh: there is no mesh 'pinion-gaer' (did you mean 'pinion-gear'?)",
    ),
    "of a wheel that is not there": (
        "simulation.output={per_turn: 3, wheel: rack}",
        "simulation.output.wheel: there is no wheel 'rack'; the case has pinion, gear",
    ),
    "pitches of a wheel": (
        "simulation.output={per_pitch: 3, wheel: gear}",
        "simulation.output: 'wheel' needs 'per_turn' in the same block",
    ),
    "an interval that is too long": (
        "simulation.output={interval: 1}",
        "simulation.output.interval: is 1 s, longer than the duration of 0.01 s",
    ),
    "an interval that is too short": (
        "simulation.output={interval: 1e-13}",
        "simulation.output.interval: is 1e-13 s, which gives more than 1e+09 rows",
    ),
    "another way": ("simulation.output.pre_pitch=3", "did you mean 'per_pitch'?"),
    "no block": ("simulation.output=3", "simulation.output: must be a block of keys, not '3'"),
    "not at all": (
        "simulation={duration: 1}",
        "simulation: 'output_interval' is missing (step of the output grid [s]); or else 'output'",
    ),
}


@pytest.mark.parametrize(("setting", "message"), REFUSED.values(), ids=REFUSED)
def test_an_output_that_says_too_little_or_too_much_is_refused_at_its_place(
    evolvent: Evolvent, case: Path, setting: str, message: str
) -> None:
    done = evolvent("run", case, "--set", setting, "-o", "h.h5")
    assert done.returncode == 3
    assert message in done.stderr
    assert done.stderr.count("\n") == 1
    assert [path.name for path in case.parent.iterdir()] == ["pair.yaml"]


@pytest.mark.parametrize(
    ("output", "loads", "what"),
    [
        (BY_PITCH, [[], []], "the driving wheel of mesh 'pinion-gear'"),
        ({"per_turn": 3, "wheel": "gear"}, [[], []], "wheel 'gear'"),
        ({"per_turn": 3, "wheel": "gear"}, [[], [{"kind": "speed", "value": 0}]], "wheel 'gear'"),
        (BY_PITCH, [[], [{"kind": "viscous", "coefficient": 1}]], "the driving wheel of mesh"),
    ],
)
def test_a_wheel_that_nothing_turns_is_refused(
    evolvent: Evolvent,
    content: dict[str, Any],
    case: Path,
    output: dict[str, Any],
    loads: list[Any],
    what: str,
) -> None:
    for wheel, own in zip(content["wheels"], loads, strict=True):
        wheel["loads"] = own
    content["meshes"][0]["damping"] = {"law": "none"}
    content["simulation"] |= {"output": output, "initial": {"kind": "rest"}}
    case.write_text(yaml.safe_dump(content, sort_keys=False))
    for command in (("run", case, "-o", "h.h5"), ("show", case)):
        done = evolvent(*command)
        assert done.returncode == 3
        assert f"nothing turns {what}" in done.stderr
        assert f"simulation.output.{'mesh' if 'mesh' in output else 'wheel'}" in done.stderr
    content["simulation"] |= {"initial": {"kind": "speeds", "speeds": {"pinion": -1, "gear": 0}}}
    if not (what == "wheel 'gear'" and loads[1]):
        case.write_text(yaml.safe_dump(content, sort_keys=False))
        assert evolvent("run", case, "-o", "h.h5").returncode == 0


def test_the_case_in_a_history_gives_the_same_rows_again(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    assert evolvent("run", case, "-o", "one.h5").returncode == 0
    with xr.open_dataset(tmp_path / "one.h5") as one:
        (tmp_path / "again.yaml").write_text(one.attrs["case"])
        assert yaml.safe_load(one.attrs["case"])["simulation"]["output"] == BY_PITCH
        assert evolvent("run", "again.yaml", "-o", "two.h5").returncode == 0
        with xr.open_dataset(tmp_path / "two.h5") as two:
            for name in one.variables:
                np.testing.assert_array_equal(one[name], two[name])
    shown = json.loads(evolvent("show", case, "--json").stdout)
    assert shown["case"]["simulation"]["output"] == BY_PITCH
    assert "output_interval" not in shown["case"]["simulation"]
    assert "simulation.output.per_pitch = 10" in evolvent("show", case, "--parameters").stdout


def test_modes_at_a_time_do_not_ask_for_outputs(evolvent: Evolvent, case: Path) -> None:
    done = evolvent("modes", case, "--at", "0.005")
    assert (done.returncode, done.stderr) == (0, "")


# ---- batches -------------------------------------------------------------------------------------


def test_histories_of_a_batch_stand_at_the_positions_of_single_runs(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """Every second position of the grid; a shorter case has NaN, and its own times."""
    torques = [-50.0, -100.0, -10.0]
    design = write_design(
        tmp_path / "design.h5",
        {TORQUE: torques},
        case.read_text(),
        histories="transmission_error angle",
        every=2,
        history_rows=25,
    )
    done = evolvent("batch", design, "-o", "r", "-q")
    assert (done.returncode, done.stderr) == (0, "")
    with xr.open_dataset(tmp_path / STACK) as stack:
        assert stack["transmission_error"].dims == ("case", "output_position", "mesh")
        np.testing.assert_array_equal(stack["output_position"], np.arange(25) / 5)
        lengths = []
        for number, value in enumerate(torques):
            run = evolvent("run", case, "-o", "h.h5", "-q", "--set", f"{TORQUE}={value}")
            assert run.returncode == 0
            with xr.open_dataset(tmp_path / "h.h5") as history:
                kept = history.isel(time=history["output_kind"].values == 0).isel(
                    time=slice(None, None, 2)
                )
                n = min(kept.sizes["time"], 25)
                lengths.append(n)
                row = stack.isel(case=number)
                np.testing.assert_array_equal(
                    row["time"].values[:n], kept["time"].values[:n].astype("f4")
                )
                for name in ("transmission_error", "angle"):
                    np.testing.assert_array_equal(
                        row[name].values[:n], kept[name].values[:n].astype("f4")
                    )
                    assert np.isnan(row[name].values[n:]).all()
        assert lengths[1] > lengths[0] > lengths[2]
    numbers = read_journal(tmp_path / JOURNAL).cases
    assert all(row["transmission_error_mean"] > 0.0 for row in numbers.values())
    assert "less than one" in numbers[2]["message"]


def test_a_position_that_is_passed_again_keeps_its_first_time(
    evolvent: Evolvent, content: dict[str, Any], tmp_path: Path
) -> None:
    content["wheels"][0]["loads"] = [
        {"kind": "harmonic", "amplitude": -3.0, "frequency": 20.0, "phase": 90.0}
    ]
    content["wheels"][1]["loads"] = [{"kind": "viscous", "coefficient": 0.01}]
    content["simulation"] |= {"duration": 0.1, "initial": {"kind": "rest"}}
    text = yaml.safe_dump(content, sort_keys=False)
    (tmp_path / "swing.yaml").write_text(text)
    design = write_design(
        tmp_path / "design.h5", {"title": ["a"]}, text, histories="angle", history_rows=30
    )
    assert evolvent("batch", design, "-o", "r", "-q").returncode == 0
    assert evolvent("run", "swing.yaml", "-o", "h.h5", "-q").returncode == 0
    with (
        xr.open_dataset(tmp_path / STACK) as stack,
        xr.open_dataset(tmp_path / "h.h5") as history,
    ):
        forwards = history.isel(time=history["output_kind"].values == 0)
        positions, first = np.unique(forwards["output_position"].values, return_index=True)
        first, positions = first[positions >= 0], positions[positions >= 0]
        assert np.unique(forwards["output_position"]).size < forwards.sizes["time"]
        assert positions.size < 30
        times = stack["time"].values[0]
        at = np.round(10 * positions).astype(int)
        np.testing.assert_array_equal(times[at], forwards["time"].values[first].astype("f4"))
        assert np.count_nonzero(~np.isnan(times)) == positions.size


@pytest.mark.parametrize(
    ("by_position", "rows", "message"),
    [
        (True, None, "history_rows: is missing, but outputs of these cases are by position"),
        (False, 7, "history_rows: is 7, but outputs of these cases are by time"),
        (True, -1, "history_rows: this attribute of the design is not a count"),
    ],
)
def test_a_design_says_how_many_positions_are_kept_and_only_of_positions(
    evolvent: Evolvent,
    content: dict[str, Any],
    tmp_path: Path,
    by_position: bool,
    rows: int | None,
    message: str,
) -> None:
    if not by_position:
        del content["simulation"]["output"]
        content["simulation"]["output_interval"] = 1e-3
    text = yaml.safe_dump(content, sort_keys=False)
    design = write_design(
        tmp_path / "design.h5", {TORQUE: [-50.0]}, text, histories="angle", history_rows=rows
    )
    done = evolvent("batch", design, "-o", "r")
    assert done.returncode == 3
    assert message in done.stderr
    with h5py.File(design, "r") as file:
        assert ("history_rows" in file.attrs) == (rows is not None)


def test_cases_with_other_positions_have_no_place_in_the_histories(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    outputs = [
        "{per_pitch: 10, mesh: pinion-gear}",
        "{per_pitch: 20, mesh: pinion-gear}",
        "{per_turn: 10, wheel: gear}",
        "{interval: 1e-3}",
    ]
    design = write_design(
        tmp_path / "design.h5",
        {"simulation.output": outputs},
        case.read_text(),
        histories="angle",
        history_rows=5,
    )
    assert evolvent("batch", design, "-o", "r", "-q").returncode == 1
    rows = read_journal(tmp_path / JOURNAL).cases
    assert [rows[i]["status"] for i in range(4)] == ["done", *["refused"] * 3]
    assert "its history differs in times, positions or sizes" in rows[1]["message"]
