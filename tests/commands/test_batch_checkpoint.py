"""A stopped case of a batch resumes at its checkpoint, and has the row of an undisturbed one."""

from __future__ import annotations

import contextlib
import os
import random
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from designs import paper_case, read_folder, read_journal, write_design
from processes import children, is_alive, running, wait_for
from system.random_sets import seeds

Undisturbed = tuple[Path, dict[int, dict[str, object]], np.ndarray]
TORQUE = "wheels.pinion.loads.0.value"
JOURNAL, HISTORIES = "r/shard-1-of-1.jsonl", "r/shard-1-of-1.h5"
FOLDER = Path("r/shard-1-of-1.checkpoints")
SOON = "0.0005"  # minutes, for cases that take ten times that
GOES_ON = re.compile(r"case (\d+) continues from its checkpoint at t = (\S+) s")
STOPS = 8  # maximum stops of a batch
N_SEEDS = 25  # 200 stops


@pytest.fixture(scope="module")
def undisturbed(executable: Path, tmp_path_factory: pytest.TempPathFactory) -> Undisturbed:
    """Cases of some tenths of a second, one of them by IDA, with their results."""
    folder = tmp_path_factory.mktemp("undisturbed")
    columns = {
        TORQUE: [-50.0, -40.0, -60.0, -5.0],
        "simulation.integrator": ["radau", "radau", "ida", "radau"],
        "simulation.duration": [1.0, 1.0, 0.2, 1.0],
    }
    design = write_design(
        folder / "design.h5",
        columns,
        paper_case(1.0, "spur-pair.yaml") + "  metrics: {from: 0.05 s}\n",
        numbers="all",
    )
    subprocess.run(
        [executable, "batch", design, "-o", "r", "-q", "--checkpoint", "0"], cwd=folder, check=True
    )
    return design, read_folder(folder / "r"), np.empty(0)


@pytest.fixture(scope="module")
def long_case(executable: Path, tmp_path_factory: pytest.TempPathFactory) -> Undisturbed:
    """One case with a history."""
    folder = tmp_path_factory.mktemp("long")
    text = paper_case(1.0, "spur-pair.yaml") + "  integrator: radau\n"
    design = write_design(
        folder / "design.h5",
        {TORQUE: [-50.0]},
        text,
        histories="normal_force pair_normal_force",
        every=100,
    )
    subprocess.run(
        [executable, "batch", design, "-o", "r", "-q", "--checkpoint", "0"], cwd=folder, check=True
    )
    return design, read_folder(folder / "r"), read_histories(folder)


def read_histories(folder: Path) -> np.ndarray:
    """Normal force of all cases."""
    with xr.open_dataset(folder / HISTORIES, engine="h5netcdf") as stack:
        return np.asarray(stack.pair_normal_force.values)


def batch(executable: Path, design: Path, *more: str | Path) -> list[str | Path]:
    """Command that starts or resumes a batch."""
    return [executable, "batch", design, "-o", "r", "--resume", "--checkpoint", SOON, *more]


def run(command: list[str | Path], folder: Path) -> str:
    """Run the command to its end; return its messages."""
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stderr


def stop(
    command: list[str | Path], folder: Path, number: signal.Signals = signal.SIGKILL
) -> tuple[int, str]:
    """Stop it when a checkpoint before the last one exists; return exit code and messages."""
    with running(command, folder, stderr=subprocess.PIPE, text=True) as parent:
        wait_for(lambda: any((folder / FOLDER).glob("*/checkpoint-before.h5")))
        workers = children(parent.pid)
        parent.send_signal(number)
        said = parent.communicate(timeout=60)[1]
    for worker in workers:
        wait_for(lambda pid=worker: not is_alive(pid))
    return parent.returncode, said


def assert_undisturbed(folder: Path, design: Undisturbed) -> None:
    """Each case is recorded once, with the bits of an undisturbed run; no checkpoint remains."""
    rows = read_journal(folder / JOURNAL).rows
    assert sorted(row["case"] for row in rows) == sorted(design[1])
    assert read_folder(folder / "r") == design[1]
    if design[2].size:
        np.testing.assert_array_equal(read_histories(folder), design[2])
    assert not (folder / FOLDER).exists()


@pytest.mark.parametrize("seed", seeds(range(2), N_SEEDS))
def test_a_batch_stopped_at_random_records_what_one_does_that_was_not(
    executable: Path,
    tmp_path: Path,
    undisturbed: Undisturbed,
    seed: int,
    record_property: Callable[[str, object], None],
) -> None:
    """Batch and workers are stopped; a case may lose one process."""
    rng = random.Random(seed)
    command = batch(executable, undisturbed[0], "--jobs", "2")
    stops = 0
    for _ in range(STOPS):
        how = rng.choice(["worker", signal.SIGKILL, signal.SIGKILL, signal.SIGTERM, signal.SIGUSR1])
        with running(command, tmp_path, stderr=subprocess.PIPE, text=True) as parent:
            time.sleep(rng.uniform(0.05, 0.3))
            workers = children(parent.pid)
            if isinstance(how, signal.Signals):
                parent.send_signal(how)
            elif workers:
                wait_for(
                    lambda p=parent: any((tmp_path / FOLDER).glob("*/*.h5")) or p.poll() is not None
                )
                with contextlib.suppress(ProcessLookupError):
                    os.kill(rng.choice(workers), signal.SIGKILL)
            said = parent.communicate(timeout=60)[1]
        assert parent.returncode in (0, 75, -9), said
        for worker in workers:
            wait_for(lambda pid=worker: not is_alive(pid))
        stops += 1 if parent.returncode != 0 or how == "worker" else 0
        if parent.returncode == 0:
            break
    record_property("stops", stops)
    run(command, tmp_path)
    assert_undisturbed(tmp_path, undisturbed)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGUSR1, signal.SIGINT, signal.SIGKILL])
def test_a_case_goes_on_where_it_was(
    executable: Path, tmp_path: Path, long_case: Undisturbed, number: signal.Signals
) -> None:
    command = batch(executable, long_case[0])
    code, said = stop(command, tmp_path, number)
    assert code == (-9 if number == signal.SIGKILL else 75), said
    with h5py.File(tmp_path / FOLDER / "0" / "checkpoint.h5") as file:
        kept = float(np.frombuffer(bytes(file["time"][:]))[0])
    found = GOES_ON.search(run(command, tmp_path))
    assert found
    assert found[1] == "0"
    assert float(found[2]) == pytest.approx(kept, rel=1e-8)  # nine digits are printed
    assert kept > 0
    assert_undisturbed(tmp_path, long_case)


def test_a_worker_that_was_killed_loses_no_more_than_since_the_last_checkpoint(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    command = batch(executable, long_case[0])
    with running(command, tmp_path, stderr=subprocess.PIPE, text=True) as parent:
        wait_for(lambda: any((tmp_path / FOLDER).glob("*/checkpoint-before.h5")))
        (worker,) = children(parent.pid)
        os.kill(worker, signal.SIGKILL)
        said = parent.communicate(timeout=60)[1]
    assert parent.returncode == 0
    assert GOES_ON.search(said)
    assert_undisturbed(tmp_path, long_case)


def reach(folder: Path) -> float:
    """Model time of the checkpoint of case 0; 0 if there is none."""
    try:
        with h5py.File(folder / FOLDER / "0" / "checkpoint.h5") as file:
            return float(np.frombuffer(bytes(file["time"][:]))[0])
    except OSError:  # none, or it is being replaced
        return 0.0


def test_a_case_whose_workers_die_is_not_given_up_as_long_as_it_gets_on(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    n_deaths, last, killed = 3, 0.0, set[int]()
    with running(batch(executable, long_case[0]), tmp_path, stderr=subprocess.DEVNULL) as parent:
        for _ in range(n_deaths):
            wait_for(lambda: not killed.issuperset(children(parent.pid)))
            wait_for(lambda reached=last: reach(tmp_path) > reached)
            (worker,) = children(parent.pid)
            os.kill(worker, signal.SIGSTOP)  # so that nothing happens in between
            last = reach(tmp_path)
            os.kill(worker, signal.SIGKILL)
            killed.add(worker)
    assert len(killed) == n_deaths
    assert parent.returncode == 0
    assert_undisturbed(tmp_path, long_case)


def test_a_case_whose_workers_die_twice_at_the_same_checkpoint_is_given_up(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    stop(batch(executable, long_case[0]), tmp_path)
    command = [*batch(executable, long_case[0])[:-1], "10", "-q"]  # no more of them
    found, killed = reach(tmp_path), set[int]()
    assert found > 0
    with running(command, tmp_path) as parent:
        for _ in range(2):
            wait_for(lambda: not killed.issuperset(children(parent.pid)))
            (worker,) = set(children(parent.pid)) - killed
            os.kill(worker, signal.SIGKILL)
            killed.add(worker)
    assert parent.returncode == 1
    row = read_journal(tmp_path / JOURNAL).cases[0]
    assert row["status"] == "failed"
    assert row["message"] == "the process that ran it was ended by signal 9 (Killed), twice"


def test_cases_shorter_than_the_interval_make_no_file(executable: Path, tmp_path: Path) -> None:
    design = write_design(tmp_path / "design.h5", {TORQUE: list(np.linspace(-2.0, -1.0, 20))})
    with running([executable, "batch", design, "-o", "r", "-q"], tmp_path) as parent:
        while parent.poll() is None:
            assert not (tmp_path / FOLDER).exists()
    assert parent.returncode == 0
    assert not (tmp_path / FOLDER).exists()


def test_the_processor_time_of_a_case_is_that_of_all_its_pieces(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    command = batch(executable, long_case[0])
    (whole,) = read_journal(long_case[0].parent / JOURNAL).rows
    stop(command, tmp_path)
    assert GOES_ON.search(run(command, tmp_path))
    (row,) = read_journal(tmp_path / JOURNAL).rows
    # A piece is at least some hundredths of it; the machine may be twice as slow, or fast.
    assert 0.5 < row["cpu_time"] / whole["cpu_time"] < 3


def damage(path: Path) -> None:
    """Truncate the last byte."""
    path.write_bytes(path.read_bytes()[:-1])


def test_of_a_damaged_checkpoint_the_one_before_it_is_taken_with_a_warning(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    command = batch(executable, long_case[0])
    stop(command, tmp_path)
    damage(tmp_path / FOLDER / "0" / "checkpoint.h5")
    said = run(command, tmp_path)
    assert "checkpoint.h5' is damaged, or is not a checkpoint: case 0 continues from the" in said
    assert GOES_ON.search(said)
    assert_undisturbed(tmp_path, long_case)


def test_without_a_checkpoint_that_is_whole_a_case_begins_anew_with_a_warning(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    command = batch(executable, long_case[0])
    stop(command, tmp_path)
    for path in (tmp_path / FOLDER).glob("0/*.h5"):
        damage(path)
    said = run(command, tmp_path)
    assert "checkpoint.h5' is damaged, or is not a checkpoint: case 0 restarts from time 0" in said
    assert not GOES_ON.search(said)
    assert_undisturbed(tmp_path, long_case)


def test_a_checkpoint_of_another_case_does_not_count(
    executable: Path, tmp_path: Path, long_case: Undisturbed, undisturbed: Undisturbed
) -> None:
    """Neither of another design nor of another case of this one."""
    command = batch(executable, undisturbed[0])
    (tmp_path / "other").mkdir()
    stop(batch(executable, long_case[0]), tmp_path / "other")
    stop(command, tmp_path)
    here = tmp_path / FOLDER
    shutil.copytree(here / "0", here / "1", dirs_exist_ok=True)
    shutil.rmtree(here / "0")
    shutil.copytree(tmp_path / "other" / FOLDER / "0", here / "0")
    said = run(command, tmp_path)
    assert "the checkpoint is of another case: 'case 0 of the design" in said
    assert "'case 1 of the design" in said
    assert "case 0 restarts from time 0" in said
    assert "case 1 restarts from time 0" in said
    assert_undisturbed(tmp_path, undisturbed)


def test_checkpoints_of_recorded_cases_go_when_the_batch_begins(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    """They remain if the batch was killed in between."""
    command = batch(executable, long_case[0])
    stop(command, tmp_path)
    shutil.copytree(tmp_path / FOLDER, tmp_path / "copy")
    run(command, tmp_path)
    shutil.copytree(tmp_path / "copy", tmp_path / FOLDER)
    run(command, tmp_path)
    assert_undisturbed(tmp_path, long_case)


def test_a_case_that_is_run_again_goes_on_too(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    command = batch(executable, long_case[0])
    run(command, tmp_path)
    (tmp_path / "list").write_text("after 1\n0\n")
    again = [*command, "--cases", "list"]
    stop(again, tmp_path)
    assert GOES_ON.search(run(again, tmp_path))
    assert len(read_journal(tmp_path / JOURNAL).rows) == 2
    assert read_folder(tmp_path / "r") == long_case[1]
    assert not (tmp_path / FOLDER).exists()


def test_checkpoints_are_not_written_through_a_link(
    executable: Path, tmp_path: Path, long_case: Undisturbed
) -> None:
    (tmp_path / "r").mkdir()
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / FOLDER).symlink_to(tmp_path / "elsewhere")
    done = subprocess.run(
        batch(executable, long_case[0]), cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 74
    assert done.stderr == f"evolvent: {FOLDER}: cannot be written: Not a directory\n"
    assert not any((tmp_path / "elsewhere").iterdir())


@pytest.mark.parametrize("minutes", ["-1", "soon", "nan", "inf"])
def test_minutes_that_mean_nothing_are_wrong_usage(
    executable: Path, tmp_path: Path, long_case: Undisturbed, minutes: str
) -> None:
    words = ["batch", str(long_case[0]), "-o", "r", "--checkpoint", minutes]
    done = subprocess.run(
        [executable, *words], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert f"--checkpoint {minutes}: write minutes, or 0" in done.stderr
    assert not (tmp_path / "r").exists()
