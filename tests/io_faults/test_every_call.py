"""Whichever call fails, a command ends as it promises, loses nothing, and can be made good."""

from __future__ import annotations

import errno
import re
import subprocess
from pathlib import Path

import pytest

from io_faults.commands import FILES, commands
from io_faults.every_call import try_all
from io_faults.trial import HALF_THEN_FULL, KINDS, NOT_WRITTEN, Fault, Workshop
from io_faults.warm import starter

NAMES = tuple(commands(Path()))
PYTHON = ("plan", "collect", "collect-refers", "plot", "report")
MEMORY = "malloc"


@pytest.mark.parametrize("name", NAMES)
def test_some_calls_that_fail(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str
) -> None:
    kinds = tuple(k for k in KINDS if k != MEMORY)
    # HDF5 crashes over some of the many writes of a history.
    most = 12 if name == "run" else 2 if name in PYTHON else 3
    counts, reported = try_all(commands(executable)[name], faults_layer, tmp_path, kinds, most)
    assert counts["tried"] > 1
    assert not [line for line in reported if not line.startswith("missed")]


def test_a_python_that_has_its_modules_calls_for_files_as_one_that_loads_them(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    command = commands(executable)["collect"]
    cold = Workshop(command, faults_layer, tmp_path / "cold").whole.calls[0]
    with starter(command.words, faults_layer, tmp_path / "warm") as start:
        warm = Workshop(command, faults_layer, tmp_path / "trials", start).whole.calls[0]
    assert {kind: warm[kind] for kind in FILES} == {kind: cold[kind] for kind in FILES}
    assert cold["write"] > 0


@pytest.mark.parametrize("name", [name for name in NAMES if name not in PYTHON])
def test_lack_of_memory_is_one_line_and_one_code(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str
) -> None:
    _, reported = try_all(commands(executable)[name], faults_layer, tmp_path, (MEMORY,), 4)
    assert not [line for line in reported if not line.startswith("missed")]


def test_every_call_for_memory_of_show_ends_in_one_line_and_one_code(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    """Of a table, of the kernel's and of the program's texts: every 27th; all by --long."""
    _, reported = try_all(commands(executable)["show"], faults_layer, tmp_path, (MEMORY,), 96)
    assert not reported


def test_a_library_that_cannot_be_prepared_for_lack_of_memory_is_not_used(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    """HDF5 would take locks of its own, and find those of the batch in its way."""
    workshop = Workshop(commands(executable)["batch"], faults_layer, tmp_path / "trials")
    for at in range(1, 25):
        assert workshop.judge(Fault(MEMORY, 0, at, errno.ENOMEM)) == []


@pytest.mark.long
@pytest.mark.parametrize("name", ["show", "records", "resume", "run", "batch"])
def test_every_call_for_memory(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str
) -> None:
    _, reported = try_all(commands(executable)[name], faults_layer, tmp_path, (MEMORY,))
    assert not [line for line in reported if not line.startswith("missed")]


def test_the_program_answers_for_gfortrans_library_where_there_is_no_memory(
    executable: Path,
) -> None:
    """The loader has to see its answers, whatever the linker optimises."""
    command = ["nm", "--dynamic", "--defined-only", executable]
    shown = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split()
    assert {"_gfortran_os_error", "_gfortran_os_error_at", "_gfortran_string_trim"} <= set(shown)


def test_a_line_for_which_there_is_no_memory_is_not_the_end_of_a_journal(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    workshop = Workshop(commands(executable)["records"], faults_layer, tmp_path / "trials")
    assert 0 < workshop.whole.calls[0][MEMORY] < 100
    for fault in workshop.faults([MEMORY]):
        assert workshop.judge(fault) == []


@pytest.mark.long
@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind != MEMORY])
@pytest.mark.parametrize("name", NAMES)
def test_every_call_that_fails(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str, kind: str
) -> None:
    _, reported = try_all(commands(executable)[name], faults_layer, tmp_path, (kind,))
    assert not [line for line in reported if not line.startswith("missed")]


@pytest.mark.parametrize(
    ("name", "error", "code"),
    [
        ("batch", errno.EAGAIN, 3),  # another run holds it
        ("batch", errno.EACCES, 3),  # so it is said elsewhere
        ("batch", errno.ENOLCK, 0),  # this folder cannot lock
        ("run", errno.EAGAIN, 74),
        ("run", errno.ENOLCK, 0),
    ],
)
def test_who_is_refused_a_lock_stays_out_unless_there_are_none(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str, error: int, code: int
) -> None:
    workshop = Workshop(commands(executable)[name], faults_layer, tmp_path / "trials")
    fault = Fault("lock", 0, 1, error)
    assert workshop.judge(fault) == []
    assert workshop.last.code == code
    if code != 0:
        assert len(re.findall("another run (?:is|uses) ", workshop.last.said)) == 1


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("run", "No space left on device; free some space"),
        ("batch", "cannot be written: No space left on device"),
    ],
)
def test_a_full_disk_ends_a_command_with_74_and_room_lets_it_end(
    executable: Path, faults_layer: Path, tmp_path: Path, name: str, said: str
) -> None:
    """Without a file system of its own, which few containers allow."""
    workshop = Workshop(commands(executable)[name], faults_layer, tmp_path / "trials")
    middle = workshop.whole.calls[0]["write"] // 2
    assert workshop.judge(Fault("write", 0, middle, HALF_THEN_FULL)) == []
    assert workshop.last.code == NOT_WRITTEN
    assert said in workshop.last.said


def test_a_read_only_folder_ends_a_run_with_74(
    executable: Path, faults_layer: Path, tmp_path: Path
) -> None:
    workshop = Workshop(commands(executable)["run"], faults_layer, tmp_path / "trials")
    said = []
    for at in range(1, workshop.whole.calls[0]["open"] + 1):
        assert workshop.judge(Fault("open", 0, at, errno.EROFS, lasts=True)) == []
        said.append(workshop.last.said)
        assert workshop.last.code == NOT_WRITTEN or "h.h5" not in workshop.last.said
    assert any("Read-only file system; write to a folder" in line for line in said)
