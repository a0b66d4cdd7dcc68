"""What was told to be done is on the disk: the machine may lose its power right afterwards."""

from __future__ import annotations

import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
import pytest

from designs import paper_case, read_folder, write_design
from io_faults.commands import CASE, DESIGN, JOURNAL, POST, STACK, SWEEP, SWEEPS, TORQUE
from io_faults.power import Machine
from processes import children, running, wait_for

N_CASES = 100
Results = Mapping[int, tuple[Mapping[str, object], bytes]]
NewMachine = Callable[[Path], Machine]


@pytest.fixture
def machine(power_layer: Path, tmp_path: Path) -> NewMachine:
    """Make a machine with the files of a folder."""

    def make(origin: Path) -> Machine:
        shutil.copytree(origin, tmp_path / "disk")
        return Machine(tmp_path / "disk", tmp_path / "store", power_layer)

    return make


def results(folder: Path) -> Results:
    """Rows of a batch with their histories, by the cases."""
    rows = read_folder(folder)
    if not rows:
        return {}
    with h5py.File(folder / STACK) as file:
        histories = np.asarray(file["normal_force"])
    return {case: (row, histories[case].tobytes()) for case, row in rows.items()}


@pytest.fixture(scope="module")
def undisturbed(executable: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Results]:
    """A folder with a design of some 20 ms a case, and its results."""
    root = tmp_path_factory.mktemp("undisturbed")
    (root / "begin").mkdir()
    torques = {TORQUE: list(-np.linspace(1.0, 3.0, N_CASES))}
    design = root / "begin" / DESIGN
    write_design(design, torques, paper_case(0.15), histories="normal_force")
    subprocess.run([executable, "batch", design, "-o", root / "r", "-q"], check=True)
    return root / "begin", results(root / "r")


def batch_words(executable: Path) -> Sequence[str | Path]:
    return [executable, "batch", DESIGN, "-o", "r/", "--jobs", "2"]


def assert_rows_are_left(
    machine: Machine, executable: Path, reported: int, expected: Results, root: Path
) -> None:
    """As many as were told, with their histories, to the bit; --resume runs the others."""
    left = machine.after_loss(root / "left")
    rows = results(left / "r")
    assert len(rows) >= reported
    assert all(rows[case] == expected[case] for case in rows)
    command = [*batch_words(executable), "--resume", "-q"]
    assert subprocess.run(command, cwd=left, check=False).returncode == 0
    assert results(left / "r") == expected


@pytest.mark.parametrize("at", [3, 5])  # far from both ends of the batch, also on a slow disk
def test_rows_that_progress_tells_are_on_the_disk(
    executable: Path,
    undisturbed: tuple[Path, Results],
    machine: NewMachine,
    tmp_path: Path,
    at: int,
) -> None:
    origin, expected = undisturbed
    disk = machine(origin)
    done = disk.run(
        batch_words(executable),
        EVOLVENT_PROGRESS_INTERVAL="0.02",
        POWER_WORD=" done, ",
        POWER_AT=str(at),
    )
    assert done.returncode == -signal.SIGKILL
    reported = int(re.findall(rf"(\d+) of {N_CASES} done", done.stderr)[-1])
    assert 0 < reported < N_CASES
    assert_rows_are_left(disk, executable, reported, expected, tmp_path)


def test_rows_that_the_last_line_tells_are_on_the_disk(
    executable: Path, undisturbed: tuple[Path, Results], machine: NewMachine, tmp_path: Path
) -> None:
    origin, expected = undisturbed
    disk = machine(origin)
    done = disk.run(batch_words(executable), POWER_WORD=f"{N_CASES} cases, ")
    assert done.returncode == -signal.SIGKILL
    assert_rows_are_left(disk, executable, N_CASES, expected, tmp_path)


def test_rows_that_an_interrupted_batch_tells_are_on_the_disk(
    executable: Path, undisturbed: tuple[Path, Results], machine: NewMachine, tmp_path: Path
) -> None:
    origin, expected = undisturbed
    disk = machine(origin)
    journal = disk.folder / "r" / JOURNAL
    with running(
        [*batch_words(executable), "-q"],
        disk.folder,
        env=disk.environment(POWER_WORD="interrupted by"),
        stderr=subprocess.PIPE,
        text=True,
    ) as parent:
        wait_for(lambda: journal.exists() and journal.read_bytes().count(b"\n") > 5)
        parent.terminate()
        said = parent.communicate(timeout=60)[1]
    assert parent.returncode == -signal.SIGKILL
    reported = re.search(rf"(\d+) of {N_CASES} cases were finished", said)
    assert reported
    assert_rows_are_left(disk, executable, int(reported[1]), expected, tmp_path)


def test_a_row_is_on_the_disk_a_second_after_it_was_recorded(
    executable: Path, machine: NewMachine, tmp_path: Path
) -> None:
    """Nothing but the time asks for it: no progress is told, and both workers are in endless cases.

    The bound of three seconds leaves two for a busy machine.
    """
    n_short = 6
    origin = tmp_path / "origin"
    origin.mkdir()
    columns = {
        TORQUE: [-1.0] * (n_short + 2),
        "simulation.duration": [0.01] * n_short + [1e6] * 2,
        "simulation.output_interval": [0.001] * n_short + [0.01] * 2,
    }
    write_design(origin / DESIGN, columns)
    disk = machine(origin)
    journal, environment = disk.folder / "r" / JOURNAL, disk.environment()
    with running([*batch_words(executable), "-q"], disk.folder, env=environment) as parent:
        wait_for(lambda: journal.exists() and journal.read_bytes().count(b"\n") == n_short + 1)
        wait_for(lambda: disk.on_disk(f"r/{JOURNAL}").count(b"\n") == n_short + 1, seconds=3.0)
        parent.kill()


def test_the_file_of_histories_is_whole_before_its_first_row(
    executable: Path, machine: NewMachine, tmp_path: Path
) -> None:
    """A clock that stands still leaves no sync but those at the beginning, which name it."""
    origin = tmp_path / "origin"
    origin.mkdir()
    columns = {"simulation.duration": [1e6], "simulation.output_interval": [1e3]}
    write_design(origin / DESIGN, columns, histories="normal_force")
    disk = machine(origin)
    stack, environment = f"r/{STACK}", disk.environment(POWER_CLOCK="1e-6")
    with running([*batch_words(executable), "-q"], disk.folder, env=environment) as parent:
        wait_for(lambda: len(children(parent.pid)) == 1)  # all names are on the disk by then
        found = disk.on_disk(stack)
        parent.kill()
    assert found == (disk.folder / stack).read_bytes()


def test_a_batch_syncs_no_more_than_once_a_second(
    executable: Path, undisturbed: tuple[Path, Results], machine: NewMachine
) -> None:
    disk = machine(undisturbed[0])
    before, start = disk.n_syncs, time.monotonic()
    assert disk.run([*batch_words(executable), "-q"]).returncode == 0
    # Journal and histories: once a second and at the end. Once: the mark, the new file of
    # histories and its name, the names in two folders.
    assert disk.n_syncs - before <= 2 * (time.monotonic() - start + 1) + 5


def test_a_wheel_that_has_its_name_is_whole(
    executable: Path, machine: NewMachine, tmp_path: Path
) -> None:
    """Its name may come to the disk at any time: then its content has to be there."""
    origin = tmp_path / "origin"
    origin.mkdir()
    columns = {"wheels.pinion.compliance": ["{hub_diameter: 0.026, order: 5}"]}
    write_design(origin / DESIGN, columns, paper_case(0.001, "spur-pair.yaml"))
    disk = machine(origin)
    assert disk.run([executable, "batch", DESIGN, "-o", "r", "-q"]).returncode == 0
    names = "import os; os.fsync(os.open('r', os.O_RDONLY))"
    assert disk.run([sys.executable, "-c", names]).returncode == 0
    left = disk.after_loss(tmp_path / "left")
    (wheel,) = (left / "r").glob("compliance-*.h5")
    assert wheel.read_bytes() == (disk.folder / "r" / wheel.name).read_bytes()


def test_a_history_that_is_told_is_on_the_disk(
    executable: Path, machine: NewMachine, tmp_path: Path
) -> None:
    origin = tmp_path / "origin"
    origin.mkdir()
    (origin / CASE).write_text(paper_case(0.002))
    subprocess.run([executable, "run", CASE, "-o", "new.h5", "-q"], cwd=origin, check=True)
    (origin / "h.h5").write_bytes(b"an older one")
    disk = machine(origin)
    done = disk.run([executable, "run", CASE, "-o", "h.h5"], POWER_WORD=" steps, ")
    assert done.returncode == -signal.SIGKILL
    left = disk.after_loss(tmp_path / "left")
    assert (left / "h.h5").read_bytes() == (origin / "new.h5").read_bytes()


@pytest.mark.parametrize("name", ["plan", "report"])
def test_what_python_tells_to_be_written_is_on_the_disk(
    executable: Path, machine: NewMachine, tmp_path: Path, name: str
) -> None:
    origin = tmp_path / "origin"
    origin.mkdir()
    (origin / CASE).write_text(paper_case(0.002))
    (origin / "sweep.yaml").write_text(SWEEP)
    subprocess.run([executable, "run", CASE, "-o", "h.h5", "-q"], cwd=origin, check=True)
    words = {
        "plan": [*SWEEPS, "plan", "sweep.yaml", "-o", "out"],
        "report": [*POST, "report", "h.h5", "-o", "out"],
    }
    reported = {"plan": "out: 4 cases", "report": "out"}
    disk = machine(origin)
    assert disk.run(words[name], POWER_WORD=reported[name]).returncode == -signal.SIGKILL
    left = disk.after_loss(tmp_path / "left")
    assert (left / "out").stat().st_size > 0
    assert (left / "out").read_bytes() == (disk.folder / "out").read_bytes()
