"""Sweeps with the program: every way to run a design gives the same summary."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from sweeps import PAPER

import machine
from evolvent.errors import SweepError
from evolvent.sweep.design import read_design
from evolvent.sweep.folder import open_for_run, remaining_shards
from evolvent.sweep.journal import read_records
from evolvent.sweep.plan import ACCURACY
from evolvent.sweep.pool import run_with_executor, task_count
from evolvent.sweep.program import program_version
from processes import children, is_alive, wait_for

# 24 cases of 20 ms of model time; those with a tolerance that no step can keep fail.
PLAN = f"""
format: 1
title: Load and friction
case: {PAPER}
method: factorial
parameters:
- {{path: wheels.pinion.loads.0.value, name: load, units: N m, from: -1, to: -6, number: 12}}
- {{path: meshes.0.friction.coefficient, name: friction, values: [0, 0.3]}}
- {{path: simulation.duration, name: duration, value: 0.02}}
- {{path: simulation.output_interval, name: interval, value: 1.0e-3}}
histories: {{variables: [normal_force], every: 2}}
"""
N_CASES = 24
TIMINGS = ["cpu_time", "recorded_at"]


@pytest.fixture
def design(sweep, tmp_path) -> Path:
    (tmp_path / "sweep.yaml").write_text(PLAN)
    code, _, err = sweep("plan", "sweep.yaml", "-o", "design.h5")
    assert (code, err) == (0, "")
    return tmp_path / "design.h5"


@pytest.fixture
def summary(sweep, design, tmp_path):
    """Collect a folder; without timings."""

    def collected(folder: str) -> xr.Dataset:
        code, _, err = sweep("collect", folder, "-o", f"{folder}.h5")
        assert (code, err) == (0, "")
        path = tmp_path / f"{folder}.h5"
        with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as found:
            return found.load().drop_vars(TIMINGS)

    return collected


@pytest.fixture
def reference(sweep, design, summary) -> xr.Dataset:
    code, out, _ = sweep("run", design, "-o", "reference", "--jobs", "1")
    assert (code, out) == (0, "reference: 24 cases: 24 done, 0 did not finish, 0 missing\n")
    return summary("reference")


def evolvent_sweep(*arguments: object, **options: object) -> subprocess.Popen[str]:
    """Start evolvent-sweep as a process of its own."""
    command = [sys.executable, "-m", "evolvent.commands.sweep", *map(str, arguments)]
    return subprocess.Popen(command, text=True, **options)  # type: ignore[call-overload]


def test_a_sweep_gives_what_single_runs_give(reference, evolvent, tmp_path):
    for case in (0, 17):
        settings = [
            f"wheels.pinion.loads.0.value={float(reference['load'].values[case])!r}",
            f"meshes.0.friction.coefficient={float(reference['friction'].values[case])!r}",
            "simulation.duration=0.02",
            f"simulation.accuracy={ACCURACY}",  # as the plan says for the case
        ]
        options = [part for setting in settings for part in ("--set", setting)]
        assert evolvent("run", PAPER, "-o", f"{case}.h5", *options).returncode == 0
        with xr.open_dataset(tmp_path / f"{case}.h5", engine="h5netcdf", decode_times=False) as run:
            force = run["normal_force"].values[::2, :]
        np.testing.assert_array_equal(
            reference["normal_force"].values[case], force.astype(np.float32)
        )


def test_two_workers_give_the_summary_of_one(sweep, design, reference, summary):
    assert sweep("run", design, "-o", "two", "--jobs", "2")[0] == 0
    xr.testing.assert_identical(summary("two"), reference)


def test_four_shards_give_the_summary_of_one(sweep, design, reference, summary):
    assert sweep("run", design, "-o", "four", "--shards", "4", "--jobs", "1")[0] == 0
    assert len(list(Path("four").glob("shard-*-of-4.jsonl"))) == 4
    xr.testing.assert_identical(summary("four"), reference)


def test_dask_gives_the_summary_of_one_worker(sweep, design, reference, summary):
    machine.module("distributed")
    command = ("run", design, "-o", "dask", "--executor", "dask", "--shards", "4", "--jobs", "2")
    with evolvent_sweep(*command, stdout=subprocess.PIPE) as process:
        out, _ = process.communicate(timeout=120)
    assert process.returncode == 0, out
    xr.testing.assert_identical(summary("dask"), reference)


@pytest.mark.parametrize("kind", [ThreadPoolExecutor, ProcessPoolExecutor])
def test_any_executor_gives_the_summary_of_one_worker(design, executable, reference, summary, kind):
    todo = prepared(design, executable, "pool", 3)
    with kind(2) as executor:
        code = run_with_executor(executable, design, Path("pool"), todo, executor)
    assert code == 0
    xr.testing.assert_identical(summary("pool"), reference)


def prepared(design: Path, executable: Path, folder: str, of: int) -> list:
    planned = open_for_run(design, Path(folder), program_version(executable))
    return remaining_shards(read_records(Path(folder), planned).recorded, of)


def die(*_):
    """Kill this process: no program of its own is left behind with the lock of a shard."""
    os.kill(os.getpid(), signal.SIGKILL)


class DyingExecutor(ProcessPoolExecutor):
    """A pool whose worker is killed while it has its first task."""

    def submit(self, _function, /, *arguments, **options):
        return super().submit(die, *arguments, **options)


def test_a_batch_whose_dask_worker_was_killed_is_run_again(sweep, executable, summary, tmp_path):
    distributed = machine.module("distributed")
    (tmp_path / "long.yaml").write_text(PLAN.replace("value: 0.02", "value: 2"))
    assert sweep("plan", "long.yaml", "-o", "long.h5")[0] == 0
    todo = prepared(tmp_path / "long.h5", executable, "dask", 2)
    killed = []

    def kill() -> None:
        started = any(path.read_bytes().count(b'"case":') for path in Path("dask").glob("*.jsonl"))
        if started and not killed:
            killed.append(next(iter(client.run(os.getpid).values())))
            os.kill(killed[0], signal.SIGKILL)

    options = {"threads_per_worker": 1, "dashboard_address": None}
    with distributed.Client(n_workers=2, **options) as client:
        executor = client.get_executor(pure=False)
        arguments = (executable, tmp_path / "long.h5", Path("dask"), todo, executor)
        assert run_with_executor(*arguments, show=kill) == 0
    assert killed
    rows = [path.read_bytes().count(b'"case":') for path in sorted(Path("dask").glob("*.jsonl"))]
    assert rows == [12, 12]  # each case once
    assert sweep("run", "long.h5", "-o", "embedded")[0] == 0
    xr.testing.assert_identical(summary("dask"), summary("embedded"))


def test_an_executor_does_not_run_where_another_run_is_at_work(design, executable):
    todo = prepared(design, executable, "d", 1)
    command = [sys.executable, "-c", HOLD, "d/shard-1-of-1.lock"]
    holder = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    with holder, ThreadPoolExecutor(1) as executor:
        assert holder.stdout is not None
        holder.stdout.readline()
        with pytest.raises(SweepError, match="another run is processing shard 1/1"):
            run_with_executor(executable, design, Path("d"), todo, executor)
        holder.kill()


def test_a_broken_executor_is_an_error_and_another_goes_on(design, executable, reference, summary):
    todo = prepared(design, executable, "pool", 3)
    with DyingExecutor(1) as dying, pytest.raises(SweepError, match="worker died") as caught:
        run_with_executor(executable, design, Path("pool"), todo, dying)
    assert caught.value.code == 75
    with ProcessPoolExecutor(2) as executor:
        assert run_with_executor(executable, design, Path("pool"), todo, executor) == 0
    xr.testing.assert_identical(summary("pool"), reference)


@pytest.mark.parametrize(
    ("n_cases", "seconds", "workers", "count"),
    [
        (10, 0.02, 8, 1),  # a fifth of a second in all: one task
        (2000, 0.02, 2, 32),  # 16 a worker
        (2000, 0.02, 100, 40),  # a second each
        (5, 60.0, 8, 5),  # never less than a case
        (10**6, 0.02, 500, 1000),  # never more than a folder should hold
    ],
)
def test_tasks_take_at_least_a_second_and_are_about_16_a_worker(n_cases, seconds, workers, count):
    assert task_count(n_cases, seconds, workers) == count


def test_a_run_that_is_interrupted_goes_on(sweep, design, reference, summary):
    cases = "\n".join(map(str, range(24)))
    Path("all.txt").write_text(cases)
    with evolvent_sweep("run", design, "-o", "d", "--jobs", "1", stderr=subprocess.PIPE) as process:
        journal = Path("d/shard-1-of-1.jsonl")
        while process.poll() is None:
            if journal.exists() and journal.read_bytes().count(b"\n") > 3:
                process.send_signal(signal.SIGTERM)
                break
            time.sleep(0.002)
        process.communicate(timeout=60)
    before = journal.read_bytes().count(b"\n") - 1
    assert process.returncode in (0, 75)
    assert (process.returncode == 75) == (before < N_CASES)
    assert sweep("run", design, "-o", "d", "--jobs", "1")[0] == 0
    assert journal.read_bytes().count(b'"case":') == N_CASES  # none was repeated
    xr.testing.assert_identical(summary("d"), reference)


@machine.on_linux
def test_a_run_that_is_killed_leaves_nobody_and_the_same_command_goes_on(sweep, tmp_path):
    Path("slow.yaml").write_text(PLAN.replace("value: 0.02}", "value: 1}"))
    assert sweep("plan", "slow.yaml", "-o", "slow.h5")[0] == 0
    journal = Path("d/shard-1-of-1.jsonl")

    def rows() -> int:
        return journal.read_bytes().count(b'"case":') if journal.exists() else 0

    with evolvent_sweep("run", "slow.h5", "-o", "d", "--jobs", "2") as process:
        wait_for(lambda: rows() >= 2)
        (batch,) = children(process.pid)
        workers = children(batch)
        process.kill()
    wait_for(lambda: not any(map(is_alive, [batch, *workers])), 5.0)
    before = rows()
    assert len(workers) == 2
    assert before < N_CASES
    assert sweep("run", "slow.h5", "-o", "d", "--jobs", "2")[0] == 0
    assert rows() == N_CASES  # none was repeated


def test_a_folder_that_was_begun_in_four_shards_is_finished_in_four(sweep, design, executable):
    command = [executable, "batch", design, "-o", "d", "--shard", "2/4"]
    assert subprocess.run(command, capture_output=True, check=False).returncode == 0
    code, out, _ = sweep("run", design, "-o", "d")
    assert (code, out) == (0, "d: 24 cases: 24 done, 0 did not finish, 0 missing\n")
    rows = [path.read_bytes().count(b'"case":') for path in sorted(Path("d").glob("*.jsonl"))]
    assert rows == [6, 6, 6, 6]


FAILING = f"""
format: 1
case: {PAPER}
method: list
parameters:
- {{path: wheels.pinion.loads.0.value, name: load, values: [-1, -1, -1, -1, -1, -1]}}
- {{path: wheels.gear.loads.0.coefficient, name: brake, values: [10, -5, 10, -1, 10, 10]}}
- {{path: simulation.duration, value: 0.02}}
"""


@pytest.fixture
def failing(sweep, tmp_path) -> Path:
    """A design of 6 cases of which those with a negative brake are refused."""
    (tmp_path / "failing.yaml").write_text(FAILING)
    assert sweep("plan", "failing.yaml", "-o", "failing.h5")[0] == 1
    code, _, err = sweep("plan", "failing.yaml", "-o", "failing.h5", "--keep-refused")
    assert code == 0
    assert "2 of 6 cases would be refused" in err
    assert "2 x --set wheels.gear.loads.0.coefficient=-5" in err
    return tmp_path / "failing.h5"


def test_cases_that_fail_are_rows_with_their_reason_and_code_1(sweep, failing):
    code, out, _ = sweep("run", failing, "-o", "d")
    assert code == 1
    assert out.splitlines() == [
        "d: 6 cases: 4 done, 2 did not finish (0 failed, 2 refused), 0 missing",
        "why they did not finish: evolvent-sweep status d",
    ]
    out = sweep("status", "d")[1]
    assert re.search(r"2 x .*wheels\.gear.*coefficient.*\(case 1\)", out)
    assert sweep("run", failing, "-o", "d")[0] == 1  # nothing to do, but two failed
    assert Path("d/shard-1-of-1.jsonl").read_bytes().count(b'"case":') == 6


def test_retry_runs_the_failed_cases_and_the_named_ones_and_no_other(sweep, failing):
    assert sweep("run", failing, "-o", "d", "--shards", "2")[0] == 1
    assert sweep("retry", "d", "--failed", "--case", "4")[0] == 1
    again = [path.read_text().splitlines()[1:] for path in sorted(Path("d").glob("*.jsonl"))]
    cases = [[json.loads(line)["case"] for line in lines] for lines in again]
    assert [sorted(c) for c in cases] == [[0, 2, 4, 4], [1, 1, 3, 3, 5]]
    code, out, _ = sweep("collect", "d", "-o", "s.h5")
    assert code == 0
    assert "recorded more than once, the latest is used: 1, 3-4" in out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("retry", "d"), "select the cases to run again"),
        (("retry", "d", "--case", "6"), "the cases are 0 to 5"),
        (("run", "failing.h5", "-o", "d", "--scheduler", "tcp://x:1"), "only with --executor dask"),
    ],
)
def test_wrong_usage_is_code_2(sweep, failing, arguments, message):
    assert sweep("run", failing, "-o", "d")[0] == 1
    code, _, err = sweep(*arguments)
    assert code == 2
    assert message in " ".join(err.split())


def test_a_folder_of_another_design_is_refused_and_stays_as_it_is(sweep, design, failing):
    assert sweep("run", failing, "-o", "d")[0] == 1
    before = {path.name: path.read_bytes() for path in Path("d").iterdir()}
    code, out, err = sweep("run", design, "-o", "d")
    assert (code, out) == (3, "")
    assert err.startswith("evolvent-sweep: d: holds results of another design")
    assert {path.name: path.read_bytes() for path in Path("d").iterdir()} == before


def test_a_second_run_in_the_same_folder_is_refused_with_its_owner(sweep, design, executable):
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, "d/shard-1-of-1.lock"], stdin=subprocess.PIPE,
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    with holder:
        assert holder.stdout is not None
        holder.stdout.readline()
        code, _, err = sweep("run", design, "-o", "d")
        holder.kill()
    assert code == 3
    assert "pid 4242 on elsewhere" in err
    assert sweep("run", design, "-o", "d")[0] == 0  # the dead owner's lock is none


HOLD = """
import fcntl, pathlib, sys
path = pathlib.Path(sys.argv[1])
path.parent.mkdir(exist_ok=True)
with path.open("w") as file:
    fcntl.lockf(file, fcntl.LOCK_EX)
    print("pid 4242 on elsewhere since today", file=file, flush=True)
    print("held", flush=True)
    sys.stdin.read()
"""


def test_a_dry_run_shows_count_first_rows_and_time_and_writes_nothing(sweep, tmp_path):
    (tmp_path / "sweep.yaml").write_text(PLAN)
    code, out, err = sweep("plan", "sweep.yaml", "--dry-run")
    assert (code, err) == (0, "")
    lines = out.splitlines()
    assert lines[0] == "24 cases by factorial, seed 0"
    assert lines[1].split() == ["case", "load", "[N", "m]", "friction", "duration", "interval"]
    assert lines[2].split() == ["0", "-1", "0", "0.02", "0.001"]
    assert re.search(r"^about \d.* a case: about .* on \d+ cores here$", lines[-1])
    assert [path.name for path in tmp_path.iterdir()] == ["sweep.yaml"]


def test_cores_are_those_of_the_job(monkeypatch):
    from evolvent.sweep.program import cores

    monkeypatch.delenv("SLURM_CPUS_PER_TASK", raising=False)
    assert cores() == len(os.sched_getaffinity(0))
    monkeypatch.setenv("SLURM_CPUS_PER_TASK", "7")
    assert cores() == 7


def test_a_missing_program_is_named(sweep, design, monkeypatch):
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", "/nowhere/evolvent")
    code, _, err = sweep("run", design, "-o", "d")
    assert code == 2
    assert err == (
        "evolvent-sweep: EVOLVENT_EXECUTABLE=/nowhere/evolvent: is not an executable program\n"
    )
    assert read_design(design).n_cases == N_CASES
