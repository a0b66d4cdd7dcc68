"""A plan that names a response: its cases are files of `evolvent respond`, their numbers rows."""

from __future__ import annotations

import json
import random
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import xarray as xr
import yaml

from evolvent.errors import SweepError
from evolvent.sweep.design import write_design
from evolvent.sweep.plan import make_plan
from evolvent.sweep.program import find_program
from processes import catches, wait_for
from system.random_sets import seeds
from system.test_respond import SPEED, speeds, write_rectangular

NUMBER = "transmission_error_standard_deviation"
DAMPING = "meshes.ab.damping.value"
JUMPING = speeds(0.7, 0.76, 0.02)


def write_plan(folder: Path, values: list[float], **changes: Any) -> Path:
    write_rectangular(folder)
    path = folder / "plan.yaml"
    plan = {
        "format": 1,
        "case": "rectangular.yaml",
        "method": "list",
        "metrics": [NUMBER],
        "respond": {"over": JUMPING},
        "parameters": [{"path": DAMPING, "name": "damping", "values": values}],
        **changes,
    }
    path.write_text(yaml.safe_dump(plan))
    return path


def rows_of(folder: Path) -> dict[int, dict[str, Any]]:
    """Numbers of the recorded cases, without what a clock says."""
    lines = [line for path in folder.glob("*.jsonl") for line in path.read_text().splitlines()]
    rows = [row for row in map(json.loads, lines) if "case" in row]
    return {
        row["case"]: {key: row[key] for key in row if key not in ("cpu_time", "at", "check")}
        for row in rows
    }


def assert_same_file(one: Path, other: Path) -> None:
    with (
        xr.open_dataset(one, engine="h5netcdf") as a,
        xr.open_dataset(other, engine="h5netcdf") as b,
    ):
        xr.testing.assert_identical(a.load(), b.load())


def test_cases_are_the_files_of_respond_and_the_summary_has_their_numbers(
    sweep: Callable[..., Any], evolvent: Callable[..., Any], tmp_path: Path
) -> None:
    values = [0.03, 0.05, 0.1]
    assert sweep("plan", write_plan(tmp_path, values), "-o", "d.h5")[0] == 0
    assert sweep("run", "d.h5", "-o", "two", "--jobs", "2")[0] == 0
    assert sweep("run", "d.h5", "-o", "one", "--jobs", "1", "--shards", "2")[0] == 0
    assert rows_of(Path("one")) == rows_of(Path("two"))
    assert sweep("collect", "two", "-o", "s.h5")[0] == 0
    with xr.open_dataset("s.h5", engine="h5netcdf") as summary:
        summary.load()
    assert summary.status.values.tolist() == [1, 1, 1]
    for case, value in enumerate(values):
        words = ["--over", JUMPING, "--set", f"{DAMPING}={value}", "-q", "-o", f"{case}.h5"]
        assert evolvent("respond", tmp_path / "rectangular.yaml", *words).returncode == 0
        for folder in ("one", "two"):
            assert_same_file(Path(folder, "responses", f"case-{case}.h5"), Path(f"{case}.h5"))
        with xr.open_dataset(f"{case}.h5", engine="h5netcdf") as file:
            row = summary.sel(case=case)
            assert float(row[f"{NUMBER}_largest"]) == float(file[NUMBER].max())
            for number, direction in enumerate(("up", "down")):
                at = file["jump_after"].values[file["jump_direction"].values == number]
                assert int(row[f"jumps_{direction}"]) == at.size
                np.testing.assert_equal(
                    float(row[f"jump_{direction}_at"]), at[0] if at.size else np.nan
                )
            assert int(row["longest_period"]) == int(file["period"].max())
            assert int(row["not_periodic"]) == int((file["period"] == 0).sum())
            assert int(row["still_settling"]) == int((file["period"] == -2).sum())
    assert summary["jumps_up"].values.tolist() == [1, 1, 0]


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGKILL])
def test_stopped_within_a_case_it_goes_on_with_the_same_bits(
    sweep: Callable[..., Any], executable: Path, tmp_path: Path, sent: signal.Signals
) -> None:
    over = {"over": speeds(1.3, 1.8, 0.0015), "direction": "up"}
    plan = write_plan(tmp_path, [0.03, 0.031], respond=over)
    assert sweep("plan", plan, "-o", "d.h5")[0] == 0
    command = [executable, "batch", "d.h5", "-o", "stopped", "--resume", "-q"]
    kept = Path("stopped", "responses", "case-0.h5.parts", "checkpoint.h5")
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        wait_for(kept.exists)
        process.send_signal(sent)
        process.communicate(timeout=30)
    assert process.returncode == (75 if sent == signal.SIGTERM else -sent)
    wait_for(lambda: not is_locked_by_another(kept.parent))
    assert rows_of(Path("stopped")) == {}
    assert kept.exists()
    for folder in ("stopped", "whole"):
        done = subprocess.run([*command[:4], folder, "--resume", "-q"], check=False)
        assert done.returncode == 0
        assert not list(Path(folder, "responses").glob("*.par*"))
    assert rows_of(Path("stopped")) == rows_of(Path("whole"))
    for case in (0, 1):
        name = f"case-{case}.h5"
        assert_same_file(Path("stopped/responses", name), Path("whole/responses", name))


def assert_same_after_stops(
    design: Path, executable: Path, tmp_path: Path, delays: list[float], sent: signal.Signals
) -> None:
    """Stop a batch after each of these times and resume it: files and rows are those of `whole`."""
    command = [executable, "batch", design, "-o", "stopped", "--resume", "-q"]
    for delay in delays:
        with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
            wait_for(
                lambda process=process: catches(process.pid, sent) or process.poll() is not None
            )
            time.sleep(delay)
            process.send_signal(sent)
            _, messages = process.communicate(timeout=120)
        assert process.returncode in (0, 75), messages
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert rows_of(tmp_path / "stopped") == rows_of(design.parent / "whole")
    for path in (design.parent / "whole" / "responses").iterdir():
        assert (tmp_path / "stopped" / "responses" / path.name).read_bytes() == path.read_bytes()


@pytest.fixture(scope="module")
def stopped_design(tmp_path_factory: pytest.TempPathFactory, executable: Path) -> Path:
    """A design of three responses, with the results of a run that nothing stopped beside it."""
    folder = tmp_path_factory.mktemp("design")
    over = {"over": speeds(1.3, 1.33, 0.01)}
    plan = write_plan(folder, [0.03, 0.04, 0.05], respond=over)
    design, _ = make_plan(plan, find_program())
    write_design(design, folder / "d.h5")
    command = [executable, "batch", "d.h5", "-o", "whole", "-q"]
    assert subprocess.run(command, cwd=folder, check=False).returncode == 0
    return folder / "d.h5"


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGUSR1])
@pytest.mark.parametrize("seed", seeds(range(4), 200))
def test_a_batch_stopped_at_any_instant_has_the_bytes_of_one_that_was_not(
    stopped_design: Path, executable: Path, tmp_path: Path, seed: int, sent: signal.Signals
) -> None:
    draw = random.Random(seed)
    delays = [draw.uniform(0, 0.02), draw.uniform(0, 0.3)][seed % 2 :]
    assert_same_after_stops(stopped_design, executable, tmp_path, delays, sent)


def is_locked_by_another(folder: Path) -> bool:
    """Whether the worker of a killed batch is still there."""
    import fcntl

    with (folder / "lock").open("r+b") as lock:
        try:
            fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return True
    return False


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"window": {"from": 0, "to": 1}}, "window: has no meaning with respond"),
        ({"histories": {"variables": ["gap"]}}, "histories: has no meaning with respond"),
        ({"respond": {}}, "respond.over: is missing, must be a text"),
        ({"respond": {"over": "speed"}}, "respond.over: is 'speed', must be PATH=FROM:TO"),
        ({"respond": {"over": JUMPING, "direction": "left"}}, "must be one of up, down, both"),
        ({"respond": {"over": JUMPING, "periods": 9}}, "a whole number of at least 100"),
        ({"respond": {"over": JUMPING, "method": "x"}}, "unknown key 'method'"),
        ({"respond": {"over": f"{SPEED}=-500:-500"}}, "all 2 cases would be refused"),
        ({"respond": {"over": "wheels.a.teeth=20:40"}}, "changes the structure"),
        ({"metrics": ["no_such"]}, "unknown metric 'no_such'"),
    ],
)
def test_what_a_plan_cannot_ask_is_refused_in_one_line(
    tmp_path: Path, changes: dict[str, Any], what: str
) -> None:
    plan = write_plan(tmp_path, [0.03, 0.05], **changes)
    with pytest.raises(SweepError) as refused:
        make_plan(plan, find_program())
    assert what in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_case_that_is_refused_is_told_before_and_recorded(
    sweep: Callable[..., Any], tmp_path: Path
) -> None:
    assert sweep("plan", write_plan(tmp_path, [7, 0.1]), "-o", "d.h5")[0] == 1
    assert sweep("run", "d.h5", "-o", "d")[0] == 1
    rows = rows_of(Path("d"))
    assert [rows[case]["status"] for case in (0, 1)] == ["refused", "done"]
    assert DAMPING in rows[0]["message"]


def test_what_a_response_is_of_decides_about_its_design(tmp_path: Path) -> None:
    responds: list[dict[str, Any]] = [
        {"over": JUMPING},
        {"over": JUMPING, "direction": "up"},
        {"over": JUMPING, "periods": 700},
        {"over": speeds(0.74, 0.76, 0.01)},
    ]
    designs = [
        make_plan(write_plan(tmp_path, [0.1], respond=one), find_program())[0] for one in responds
    ]
    assert len({design.hash for design in designs}) == len(responds)


def test_a_design_of_another_program_is_held_to_the_same(
    sweep: Callable[..., Any], evolvent: Callable[..., Any], tmp_path: Path
) -> None:
    assert sweep("plan", write_plan(tmp_path, [0.1]), "-o", "d.h5")[0] == 0
    with h5py.File("d.h5", "r") as design, h5py.File("other.h5", "w") as other:
        other.attrs.update({key: value for key, value in design.attrs.items() if key != "plan"})
        design.copy("parameters", other)
        other.attrs["respond_direction"] = "left"
    done = evolvent("batch", "other.h5", "-o", "d")
    assert done.returncode == 3
    assert "respond_direction: is 'left', must be up, down or both" in done.stderr


def test_direction_and_periods_are_those_of_the_plan(
    sweep: Callable[..., Any], evolvent: Callable[..., Any], tmp_path: Path
) -> None:
    """With little damping a motion has not settled after 100 periods."""
    over = speeds(1.3, 1.31, 0.01)
    respond = {"over": over, "direction": "down", "periods": 100}
    assert sweep("plan", write_plan(tmp_path, [1e-4], respond=respond), "-o", "d.h5")[0] == 0
    assert sweep("run", "d.h5", "-o", "d")[0] == 0
    words = ["--over", over, "--down", "--periods", "100", "--set", f"{DAMPING}=1e-4"]
    case = tmp_path / "rectangular.yaml"
    assert evolvent("respond", case, *words, "-q", "-o", "r.h5").returncode == 0
    assert_same_file(Path("d/responses/case-0.h5"), Path("r.h5"))
    with xr.open_dataset("r.h5", engine="h5netcdf") as file:
        settled = file["period"].values > 0
    row = rows_of(Path("d"))[0]
    assert row["still_settling"] == np.count_nonzero(~settled) > 0
    assert row["not_periodic"] == 0
