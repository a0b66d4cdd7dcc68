"""A batch with compliant wheels: each wheel is computed once for the folder, by any process."""

from __future__ import annotations

import contextlib
import json
import os
import re
import signal
import subprocess
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from designs import paper_case, read_folder, read_journal, write_checksum, write_design
from processes import children, running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
HUBS = [0.026, 0.028, 0.030]
N_CASES = 24
JOURNAL = "r/shard-1-of-1.jsonl"


def compliant_case() -> str:
    """The spur pair with a short duration."""
    return paper_case(0.002, "spur-pair.yaml")


def columns(hubs: Sequence[float], n: int = N_CASES) -> dict[str, list[Any]]:
    """Cases with as many geometries as hubs, in turns; elements of order 5 are fast."""
    return {
        "wheels.pinion.compliance": [
            f"{{hub_diameter: {hubs[i % len(hubs)]!r}, order: 5}}" for i in range(n)
        ],
        "wheels.pinion.loads.0.value": [-40.0 - i for i in range(n)],
    }


@pytest.fixture
def design(tmp_path: Path) -> Path:
    """A design of three geometries."""
    return write_design(tmp_path / "design.h5", columns(HUBS), compliant_case())


@pytest.fixture(scope="module")
def alone(executable: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[int, dict[str, Any]]:
    """Results of the cases, each from its own folder and process."""
    folder = tmp_path_factory.mktemp("alone")
    results = {}
    all_columns = columns(HUBS)
    for case in range(0, N_CASES, 5):
        one = {path: [values[case]] for path, values in all_columns.items()}
        write_design(folder / f"{case}.h5", one, compliant_case())
        command = [executable, "batch", f"{case}.h5", "-o", f"r{case}", "-q"]
        subprocess.run(command, cwd=folder, check=True)
        results[case] = {**read_folder(folder / f"r{case}")[0], "case": case}
        assert results[case]["status"] == "done"
    return results


def files(folder: Path) -> list[Path]:
    """Files of wheels in the folder."""
    return sorted(folder.glob("compliance-*"))


def n_computed(reported: str) -> int:
    """Number of computed wheels reported by a batch."""
    found = re.search(r"compliances of wheels computed: (\d+)", reported)
    return int(found[1]) if found else 0


def assert_alone(folder: Path, alone: dict[int, dict[str, Any]]) -> None:
    """Check that all cases are done, with the bits of separate runs."""
    results = read_folder(folder)
    assert sorted(results) == list(range(N_CASES))
    assert {case: results[case] for case in alone} == alone


# ---- once ----------------------------------------------------------------------------------------


def test_a_worker_computes_each_geometry_once_and_the_folder_has_a_file_of_each(
    evolvent: Evolvent, design: Path, tmp_path: Path, alone: dict[int, dict[str, Any]]
) -> None:
    result = evolvent("batch", design, "-o", "r")
    assert result.returncode == 0, result.stderr
    assert n_computed(result.stderr) == len(HUBS)
    assert len(files(tmp_path / "r")) == len(HUBS)
    assert_alone(tmp_path / "r", alone)


def test_four_workers_of_each_of_two_batches_share_the_files_of_one_folder(
    executable: Path, design: Path, tmp_path: Path, alone: dict[int, dict[str, Any]]
) -> None:
    """A worker computes a wheel even while others compute it, but the first file counts."""
    command = [executable, "batch", design, "-o", "r", "--jobs", "4", "--shard"]
    with (
        running([*command, "1/2"], tmp_path, stderr=subprocess.PIPE, text=True) as first,
        running([*command, "2/2"], tmp_path, stderr=subprocess.PIPE, text=True) as second,
    ):
        reported = [process.communicate()[1] for process in (first, second)]
    assert (first.returncode, second.returncode) == (0, 0)
    assert len(files(tmp_path / "r")) == len(HUBS)
    assert len(HUBS) <= sum(map(n_computed, reported)) <= 8 * len(HUBS)
    assert_alone(tmp_path / "r", alone)


def test_the_order_of_the_cases_and_who_computed_before_change_no_bit(
    evolvent: Evolvent, design: Path, tmp_path: Path, alone: dict[int, dict[str, Any]]
) -> None:
    """From the last case to the first; then the others, which find all wheels."""
    last = N_CASES - len(HUBS)
    (tmp_path / "some").write_text("".join(f"{i}\n" for i in range(N_CASES - 1, last - 1, -1)))
    result = evolvent("batch", design, "-o", "r", "--cases", "some")
    assert n_computed(result.stderr) == len(HUBS)
    result = evolvent("batch", design, "-o", "r", "--resume")
    assert "compliances" not in result.stderr
    assert f"{last} of them now" in result.stderr
    assert len(files(tmp_path / "r")) == len(HUBS)
    assert_alone(tmp_path / "r", alone)


def test_a_sweep_of_loads_with_histories_computes_its_one_wheel_once(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """The parent creates the first case to lay out the histories; workers get its wheel."""
    write_design(
        tmp_path / "design.h5", columns(HUBS[:1]), compliant_case(), histories="normal_force"
    )
    result = evolvent("batch", "design.h5", "-o", "r", "--jobs", "3")
    assert result.returncode == 0, result.stderr
    assert n_computed(result.stderr) == 1
    assert len(files(tmp_path / "r")) == 1


def test_a_sweep_without_compliance_has_no_such_files_and_says_nothing_of_them(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    one = {"wheels.pinion.loads.0.value": [-40.0, -50.0]}
    write_design(tmp_path / "design.h5", one, compliant_case())
    result = evolvent("batch", "design.h5", "-o", "r")
    assert result.returncode == 0
    assert "compliance" not in result.stderr
    assert files(tmp_path / "r") == []


@pytest.mark.parametrize("command", ["run", "show", "modes"])
def test_a_command_of_one_case_leaves_no_such_file(
    evolvent: Evolvent, examples: Path, tmp_path: Path, command: str
) -> None:
    options = [f"{path}={values[0]}" for path, values in columns(HUBS[:1]).items()]
    given = [word for option in options for word in ("--set", option)]
    short = ["--set", "simulation.duration=0.002", "-o", "x.h5"] if command == "run" else []
    result = evolvent(command, examples / "spur-pair.yaml", *given, *short)
    assert result.returncode == 0, result.stderr
    assert [path.name for path in tmp_path.iterdir()] == (["x.h5"] if short else [])


def test_a_check_of_many_cases_writes_no_file(
    evolvent: Evolvent, design: Path, tmp_path: Path
) -> None:
    result = evolvent("batch", design, "--check")
    assert json.loads(result.stdout)["refused"] == 0
    assert [path.name for path in tmp_path.iterdir()] == ["design.h5"]


# ---- the file ------------------------------------------------------------------------------------


def fnv(*arrays: np.ndarray) -> int:
    """FNV-1a of 64 bits, as in docs/reference/result_format.md."""
    value = 0xCBF29CE484222325
    for byte in b"".join(array.tobytes() for array in arrays):
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return value


def test_the_file_is_what_the_documentation_says(
    evolvent: Evolvent, design: Path, tmp_path: Path
) -> None:
    assert evolvent("batch", design, "-o", "r", "-q").returncode == 0
    radii = []
    for path in files(tmp_path / "r"):
        with h5py.File(path) as file:
            key, numbers = file["key"][:], file["numbers"][:]
            assert set(file.attrs) == {"evolvent_wheel_format", "evolvent_version"}
            assert file.attrs["evolvent_wheel_format"] == 1
        content = path.read_bytes()
        write_checksum(path, at_end=True)
        assert path.read_bytes() == content
        assert path.name == f"compliance-{fnv(key):016x}.h5"
        assert path.stat().st_mode & 0o444 == 0o444 & ~current_umask()
        assert list(key[[0, 1, 8]]) == [2.0, 5.0, 19.0]  # version, order, teeth
        radii.append(key[2])
        rho, own = numbers[:17], numbers[17:34]
        assert np.all(np.diff(rho) > 0)
        assert np.all(np.diff(own) > 0)
        assert len(numbers) == 34 + 7 * 81
    assert sorted(radii) == pytest.approx([hub / 2 / 0.003 for hub in HUBS])


def current_umask() -> int:
    """Permission bits that new files do not get."""
    mask = os.umask(0)
    os.umask(mask)
    return mask


def soften(path: Path) -> None:
    """Write other values into a file, as if computed on another machine."""
    with h5py.File(path, "r+") as file:
        numbers = file["numbers"][:]
        numbers[17:34] *= 1.1
        file["numbers"][:] = numbers
    write_checksum(path, at_end=True)


def test_the_file_that_is_there_counts_for_all_cases_of_its_geometry_and_no_others(
    evolvent: Evolvent, design: Path, tmp_path: Path, alone: dict[int, dict[str, Any]]
) -> None:
    (tmp_path / "one").write_text("0\n")
    assert evolvent("batch", design, "-o", "r", "--cases", "one", "-q").returncode == 0
    (file,) = files(tmp_path / "r")
    soften(file)
    (tmp_path / JOURNAL).unlink()
    result = evolvent("batch", design, "-o", "r", "--jobs", "2")
    assert result.returncode == 0, result.stderr
    results = read_folder(tmp_path / "r")
    for case, expected in alone.items():
        assert (results[case] == expected) == (case % len(HUBS) != 0)


def test_a_damaged_file_ends_the_batch_with_its_name_and_nothing_false_is_recorded(
    evolvent: Evolvent, design: Path, tmp_path: Path, alone: dict[int, dict[str, Any]]
) -> None:
    (tmp_path / "one").write_text("1\n")
    assert evolvent("batch", design, "-o", "r", "--cases", "one", "-q").returncode == 0
    (file,) = files(tmp_path / "r")
    content = bytearray(file.read_bytes())
    with h5py.File(file) as opened:
        content[opened["numbers"].id.get_offset() + 1001] ^= 16
    file.write_bytes(content)
    result = evolvent("batch", design, "-o", "r", "--resume", "-q")
    assert result.returncode == 3
    assert result.stderr == (
        f"evolvent: r/{file.name}: is damaged: its checksum is wrong; delete it and continue with "
        "--resume; it is computed again\n"
    )
    recorded = read_journal(tmp_path / JOURNAL).cases
    assert sorted(recorded) == [0, 1, 2, 3]
    assert {row["status"] for row in recorded.values()} == {"done"}
    file.unlink()
    assert evolvent("batch", design, "-o", "r", "--resume", "-q").returncode == 0
    assert_alone(tmp_path / "r", alone)


@pytest.mark.parametrize("jobs", ["1", "3"])
def test_a_batch_killed_again_and_again_leaves_only_files_that_count(
    executable: Path, evolvent: Evolvent, tmp_path: Path, jobs: str
) -> None:
    """One geometry per case, so that workers write all the time."""
    n = 16
    hubs = np.linspace(0.0255, 0.032, n).tolist()
    design = write_design(tmp_path / "design.h5", columns(hubs, n), compliant_case())
    command = [executable, "batch", design, "-o", "r", "-q", "--resume", "--jobs", jobs]
    for kill in range(6):
        with running(command, tmp_path) as process:
            n_before = len(files(tmp_path / "r"))
            wait_for(
                lambda n_before=n_before, process=process: (
                    len(files(tmp_path / "r")) > n_before or process.poll() is not None
                )
            )
            time.sleep(0.003 * kill)
            for pid in [process.pid, *children(process.pid)]:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
    result = evolvent("batch", design, "-o", "r", "--resume", "--jobs", jobs)
    assert result.returncode == 0, result.stderr
    whole = [path for path in files(tmp_path / "r") if path.suffix == ".h5"]
    assert len(whole) == n
    assert set(read_folder(tmp_path / "r")) == set(range(n))


def test_what_a_killed_writer_left_is_removed_by_the_next_batch(
    evolvent: Evolvent, design: Path, tmp_path: Path
) -> None:
    """Ten minutes after it was written; a younger one may still have a writer."""
    folder = tmp_path / "r"
    folder.mkdir()
    names = {
        "compliance-0123456789abcdef.h5.aB3xY9": 700,  # age [s]
        "compliance-0123456789abcdee.h5.aB3xY9": 60,
        "compliance-0123456789abcdef.h5.aB3xY9.kept": 700,
        "compliance-mine.h5.aB3xY9": 700,
        "compliance-0123456789abcded.h5": 700,
    }
    for name, age in names.items():
        (folder / name).write_text("")
        os.utime(folder / name, (time.time() - age,) * 2)
    assert evolvent("batch", design, "-o", "r", "-q").returncode == 0
    assert {name for name in names if not (folder / name).exists()} == {next(iter(names))}
