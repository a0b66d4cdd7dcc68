"""A batch that is killed, interrupted, or without disk space: no record is lost, and it resumes."""

from __future__ import annotations

import contextlib
import os
import random
import resource
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import machine
from designs import paper_case, read_folder, read_journal, write_design
from processes import children, ignores, is_alive, running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
TORQUE = "wheels.pinion.loads.0.value"
JOURNAL = "r/shard-1-of-1.jsonl"
HISTORIES = "r/shard-1-of-1.h5"
N_CASES = 40
KILLS = 30  # of workers, and of parents: half of them each, for each seed
SEEDS = (20110, *(pytest.param(i, marks=pytest.mark.long) for i in range(34)))  # 1050 kills


@pytest.fixture(scope="module")
def undisturbed(
    executable: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, dict[int, dict[str, object]], np.ndarray]:
    """A design of some 20 ms per case, with the results and histories of an undisturbed run."""
    folder = tmp_path_factory.mktemp("undisturbed")
    torques = list(-np.linspace(1.0, 3.0, N_CASES))
    design = write_design(
        folder / "design.h5", {TORQUE: torques}, paper_case(0.15), histories="normal_force"
    )
    subprocess.run([executable, "batch", design, "-o", "r", "-q"], cwd=folder, check=True)
    return design, read_folder(folder / "r"), read_histories(folder / HISTORIES)


@pytest.fixture
def endless(tmp_path: Path) -> Path:
    """A design of one case that never ends."""
    columns = {TORQUE: [-1.0], "simulation.duration": [1e6], "simulation.output_interval": [0.01]}
    return write_design(tmp_path / "endless.h5", columns)


def read_histories(path: Path) -> np.ndarray:
    """Normal force of all cases."""
    with xr.open_dataset(path, engine="h5netcdf") as stack:
        return stack.normal_force.values


def n_lines(folder: Path) -> int:
    """Complete lines of the journal."""
    journal = folder / JOURNAL
    return journal.read_bytes().count(b"\n") if journal.is_file() else 0


def wait_for_lines(folder: Path, number: int, process: subprocess.Popen[bytes]) -> None:
    """Wait until the journal has this number of lines, or the process has ended."""
    wait_for(lambda: n_lines(folder) >= number or process.poll() is not None)


def assert_undisturbed(
    folder: Path, undisturbed: tuple[Path, dict[int, dict[str, object]], np.ndarray]
) -> None:
    """Check that each case is recorded once, with the bits of the undisturbed run."""
    _, results, histories = undisturbed
    rows = read_journal(folder / JOURNAL).rows
    assert sorted(row["case"] for row in rows) == list(range(N_CASES))
    assert read_folder(folder / "r") == results
    np.testing.assert_array_equal(read_histories(folder / HISTORIES), histories)


# ---- kill -9 -------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", SEEDS)
def test_killed_workers_leave_no_trace(
    executable: Path,
    tmp_path: Path,
    undisturbed: tuple[Path, dict[int, dict[str, object]], np.ndarray],
    seed: int,
) -> None:
    """A killed case continues in the next process; a case that is killed twice has failed.

    Only workers started with the batch are killed: their cases were never handed out before.
    """
    when = random.Random(seed)
    killed, run = 0, 0
    while killed < KILLS // 2:
        command = [executable, "batch", undisturbed[0], "-o", "r", "--jobs", "4", "-q"]
        folder = tmp_path / str(run)
        folder.mkdir()
        with running(command, folder) as parent:
            wait_for_lines(folder, 2, parent)
            first = children(parent.pid)
            when.shuffle(first)
            for worker in first[: KILLS // 2 - killed]:
                time.sleep(when.uniform(0.0, 0.04))
                with contextlib.suppress(ProcessLookupError):
                    os.kill(worker, signal.SIGKILL)
                    killed += 1
        assert parent.returncode == 0
        assert_undisturbed(folder, undisturbed)
        run += 1


@pytest.mark.parametrize("seed", SEEDS)
def test_a_killed_parent_takes_its_workers_along_and_the_rest_is_run_by_resume(
    executable: Path,
    tmp_path: Path,
    undisturbed: tuple[Path, dict[int, dict[str, object]], np.ndarray],
    seed: int,
) -> None:
    when = random.Random(seed + 1)
    command = [executable, "batch", undisturbed[0], "-o", "r", "--jobs", "2", "--resume", "-q"]
    for _ in range(KILLS // 2):
        with running(command, tmp_path) as parent:
            time.sleep(when.uniform(0.0, 0.15))
            workers = children(parent.pid)
            parent.kill()
        for worker in workers:
            wait_for(lambda pid=worker: not is_alive(pid))
        if (tmp_path / HISTORIES).exists():
            assert read_histories(tmp_path / HISTORIES).shape == undisturbed[2].shape
    assert subprocess.run(command, cwd=tmp_path, check=False).returncode == 0
    assert_undisturbed(tmp_path, undisturbed)


def test_a_case_that_ends_its_process_twice_has_failed(
    executable: Path, tmp_path: Path, endless: Path
) -> None:
    with running([executable, "batch", endless, "-o", "r", "-q"], tmp_path) as parent:
        killed: set[int] = set()
        for _ in range(2):
            wait_for(lambda: not killed.issuperset(children(parent.pid)))
            (worker,) = set(children(parent.pid)) - killed
            os.kill(worker, signal.SIGKILL)
            killed.add(worker)
    assert parent.returncode == 1
    row = read_journal(tmp_path / JOURNAL).cases[0]
    assert (row["status"], row["exit"]) == ("failed", 4)
    assert row["message"] == "the process that ran it was ended by signal 9 (Killed), twice"
    assert row["steps"] is None


# ---- signals that request a stop ---------------------------------------------------------------


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGUSR1, signal.SIGINT])
def test_a_signal_ends_the_batch_and_resume_goes_on(
    executable: Path,
    tmp_path: Path,
    undisturbed: tuple[Path, dict[int, dict[str, object]], np.ndarray],
    number: signal.Signals,
) -> None:
    command = [executable, "batch", undisturbed[0], "-o", "r", "--jobs", "2"]
    with running(command, tmp_path, stderr=subprocess.PIPE, text=True) as parent:
        wait_for(lambda: n_lines(tmp_path) > 4)
        workers = children(parent.pid)
        parent.send_signal(number)
        said = parent.communicate(timeout=60)[1]
    assert parent.returncode == 75
    assert f"{JOURNAL}: interrupted by {number.name}; " in said
    assert not any(map(is_alive, workers))
    done = read_journal(tmp_path / JOURNAL)
    assert done.torn == 0
    assert 4 <= len(done.rows) < N_CASES
    assert subprocess.run([*command, "--resume", "-q"], cwd=tmp_path, check=False).returncode == 0
    assert_undisturbed(tmp_path, undisturbed)


def test_workers_leave_signals_to_their_parent(
    executable: Path, tmp_path: Path, endless: Path
) -> None:
    left = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGHUP)
    with running([executable, "batch", endless, "-o", "r", "-q"], tmp_path) as parent:
        wait_for(lambda: len(children(parent.pid)) == 1 and (tmp_path / JOURNAL).is_file())
        (worker,) = children(parent.pid)
        wait_for(lambda: all(ignores(worker, number) for number in left))
        for number in left:
            os.kill(worker, number)
        time.sleep(0.05)
        assert children(parent.pid) == [worker]
        parent.terminate()
    assert parent.returncode == 75


# ---- no disk space -------------------------------------------------------------------------------


def test_a_journal_that_may_not_grow_ends_the_batch_and_keeps_what_it_has(
    executable: Path, tmp_path: Path
) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: list(-np.linspace(1.0, 3.0, 8))})
    command = [executable, "batch", design, "-o", "r"]

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000))

    full = subprocess.run(
        command, cwd=tmp_path, preexec_fn=limit, check=False, capture_output=True, text=True
    )
    assert full.returncode == 74
    assert full.stderr == (
        f"{JOURNAL}: cannot be written: File too large; "
        "recorded cases are preserved, continue with --resume\n"
    )
    kept = read_journal(tmp_path / JOURNAL)
    assert kept.torn == 0
    assert 0 < len(kept.rows) < 8
    again = subprocess.run([*command, "--resume", "-q"], cwd=tmp_path, check=False)
    assert again.returncode == 0
    rows = read_journal(tmp_path / JOURNAL).rows
    assert rows[: len(kept.rows)] == kept.rows
    assert sorted(row["case"] for row in rows) == list(range(8))


def test_histories_that_may_not_grow_are_refused_before_any_case_runs(
    executable: Path, tmp_path: Path
) -> None:
    columns = {TORQUE: list(-np.linspace(1.0, 3.0, 100))}
    design = write_design(tmp_path / "design.h5", columns, histories="normal_force gap angle")

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))

    full = subprocess.run(
        [executable, "batch", design, "-o", "r"],
        cwd=tmp_path,
        preexec_fn=limit,
        check=False,
        capture_output=True,
        text=True,
    )
    assert full.returncode == 74
    assert full.stderr == (
        f"{HISTORIES}: cannot be written: File too large; select fewer histories, or free space\n"
    )
    assert read_journal(tmp_path / JOURNAL).rows == []
    assert not (tmp_path / HISTORIES).exists()


def test_a_full_disk_ends_the_batch_and_room_lets_it_go_on(
    executable: Path, tmp_path: Path
) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: list(-np.linspace(1.0, 3.0, 40))})
    (tmp_path / "disk").mkdir()
    script = (
        'mount -t tmpfs -o size=24k none disk || exit 99; "$0" batch "$1" -o disk/r; echo "$?"; '
        "cp disk/r/*.jsonl first; mount -o remount,size=10m disk; "
        '"$0" batch "$1" -o disk/r --resume -q; echo "$?"; cp disk/r/*.jsonl second'
    )
    done = machine.with_mounts([script, executable, design], tmp_path)
    assert done.stdout.split() == ["74", "0"], done.stderr
    assert "cannot be written: No space left on device; recorded cases are preserved" in done.stderr
    first, second = read_journal(tmp_path / "first"), read_journal(tmp_path / "second")
    assert 0 < len(first.rows) < 40
    assert second.rows[: len(first.rows)] == first.rows
    assert sorted(row["case"] for row in second.rows) == list(range(40))
    assert second.torn == 0
