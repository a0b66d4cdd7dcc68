"""`evolvent run --checkpoint`: parts, checkpoints, resumption and rejected checkpoints."""

from __future__ import annotations

import re
import resource
import shlex
import shutil
import signal
import struct
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from histories import contents
from processes import running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

BLOCK = 512  # bytes before a checkpoint's HDF5 file
SOON = "0.002"  # minutes, of a run that takes longer
RADAU = ["--set", "simulation.integrator=radau"]


@pytest.fixture
def case(examples: Path, tmp_path: Path) -> Path:
    """A case with at least half a second of work, in the folder of the runs."""
    text = (examples / "spur-pair.yaml").read_text()
    path = tmp_path / "case.yaml"
    path.write_text(text.replace("duration: 50 ms", "duration: 3 s"))
    return path


@pytest.fixture
def stopped(evolvent: Evolvent, case: Path, tmp_path: Path) -> Path:
    """Folder of a run that was stopped twice: two checkpoints, some parts."""
    for more in ([], ["--continue"]):
        result = evolvent("run", case, "-o", "a.h5", "-q", "--max-time", SOON, *more)
        assert result.returncode == 75, result.stderr
    folder = tmp_path / "a.h5.parts"
    assert {"checkpoint.h5", "checkpoint-before.h5", "part-0001.h5", "part-0002.h5"} <= {
        path.name for path in folder.iterdir()
    }
    return folder


def go_on(evolvent: Evolvent, case: Path, *more: str) -> subprocess.CompletedProcess[str]:
    """Resume the stopped run."""
    return evolvent("run", case, "-o", "a.h5", "-q", "--continue", *more)


def check_sum(data: bytes) -> int:
    """FNV-1a of 64 bits."""
    total = 0xCBF29CE484222325
    for byte in data:
        total = (total ^ byte) * 0x100000001B3 % 2**64
    return total


def check_anew(path: Path) -> None:
    """Update the checksum of a modified checkpoint."""
    data = path.read_bytes()[BLOCK:]
    line = f"evolvent checkpoint 1, FNV-1a {check_sum(data):016x} of the {len(data)} bytes"
    path.write_bytes(f"{line} behind byte 512\n".encode().ljust(BLOCK, b"\0") + data)


def test_checkpoints_change_no_bit_of_a_history_by_radau(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    assert evolvent("run", case, "-o", "plain.h5", "-q").returncode == 0
    result = evolvent("run", case, "-o", "a.h5", "-q", "--checkpoint", "0.0005")
    assert result.returncode == 0, result.stderr
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")
    assert not (tmp_path / "a.h5.parts").exists()


def test_checkpoints_of_ida_are_at_the_first_step_from_the_times_that_are_asked_for(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    words: list[str | Path] = ["run", examples / "paper.yaml", "-q"]
    result = evolvent(*words, "-o", "a.h5", "--checkpoint-at", "0.5,1.25")
    assert result.returncode == 0, result.stderr
    with h5py.File(tmp_path / "a.h5") as file:
        times = [float(time) for time in file.attrs["checkpoints"].split(",")]
    interval = 0.01  # an output at each, and a step is no longer
    for time, asked in zip(times, (0.5, 1.25), strict=True):
        assert 0 <= time - asked < interval
    assert evolvent(*words, "-o", "plain.h5").returncode == 0
    assert contents(tmp_path / "a.h5") != contents(tmp_path / "plain.h5")


def test_the_command_that_a_stopped_run_names_completes_it_whatever_its_file_is_called(
    evolvent: Evolvent, executable: Path, case: Path, tmp_path: Path
) -> None:
    odd = tmp_path / "it's a $(case) .yaml"
    shutil.copy(case, odd)
    sets = ["--set", "meshes.0.contact={law: johnson}", "--outputs", "energies,gap"]
    words = ["run", odd.name, *sets, "-o", "a.h5", "-q"]
    result = evolvent(*words, "--max-time", SOON)
    assert result.returncode == 75
    assert len(result.stderr.splitlines()) == 1
    command = result.stderr.strip().split("continue from here with: ")[1]
    assert shlex.split(command)[0] == "evolvent"
    path = {"PATH": f"{executable.parent}:/usr/bin:/bin"}
    subprocess.run(command, shell=True, cwd=tmp_path, env=path, check=True)
    assert evolvent(*words[:-3], "-o", "plain.h5", "-q").returncode == 0
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGUSR1])
def test_a_signal_stops_a_run_with_a_checkpoint_and_code_75(
    executable: Path, case: Path, tmp_path: Path, number: signal.Signals
) -> None:
    words = ["--set", "simulation.duration=1000", "--checkpoint", "0.0005", "-q", "-o", "a.h5"]
    with running(
        [executable, "run", case, *words], tmp_path, stderr=subprocess.PIPE, text=True
    ) as process:
        wait_for(lambda: (tmp_path / "a.h5.parts" / "checkpoint-before.h5").exists())
        process.send_signal(number)
        _, errors = process.communicate()
    assert process.returncode == 75
    assert re.search(rf"t = .* s: interrupted by {number.name}; continue from here with: ", errors)
    assert not [*tmp_path.glob("a.h5.parts/*.partial")]
    assert not (tmp_path / "a.h5.partial").exists()


def test_parts_are_read_in_python_while_the_run_goes_on(
    executable: Path, evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    words = ["--set", "simulation.duration=1000", "--checkpoint", "0.0005", "-q", "-o", "a.h5"]
    folder = tmp_path / "a.h5.parts"
    with running([executable, "run", case, *words], tmp_path) as process:
        wait_for(lambda: len([*folder.glob("part-????.h5")]) > 3)
        with xr.open_mfdataset(
            sorted(folder.glob("part-????.h5")),
            engine="h5netcdf",
            combine="nested",
            concat_dim="time",
            data_vars="minimal",
            coords="minimal",
            compat="override",
            join="override",
        ) as history:
            time, force = history.time.values, history.normal_force.values
            teeth = history.teeth.values
            assert history.attrs["status"] == "part"
        process.kill()
        process.wait()
    assert len(time) > 3
    end = time[-1] + 1e-3
    whole = evolvent("run", case, "-q", "-o", "plain.h5", "--set", f"simulation.duration={end}")
    assert whole.returncode == 0, whole.stderr
    with xr.open_dataset(tmp_path / "plain.h5", engine="h5netcdf") as history:
        assert np.array_equal(history.time.values[: len(time)], time)
        assert np.array_equal(history.normal_force.values[: len(time)], force)
        assert np.array_equal(history.teeth.values, teeth)


def test_a_second_run_at_the_same_parts_is_refused(
    executable: Path, evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    words = ["--set", "simulation.duration=1000", "--checkpoint", "0.0005", "-q", "-o", "a.h5"]
    with running([executable, "run", case, *words], tmp_path) as process:
        wait_for(lambda: (tmp_path / "a.h5.parts" / "checkpoint.h5").exists())
        for more in ([], ["--continue"]):
            result = evolvent("run", case, *words, *more)
            assert result.returncode == 3
            assert f"another run uses this folder (pid {process.pid} " in result.stderr
        process.kill()
        process.wait()


@pytest.mark.parametrize(
    ("words", "wrong"),
    [
        (["--set", "wheels.pinion.loads.0.value=-31"], "value: -50}' there, '- {kind: torque,"),
        (["--set", "simulation.tolerance=1e-7"], "another case: 'tolerance: "),
        (["--outputs", "energies"], "' there, 'outputs: energies' here"),
    ],
)
def test_a_checkpoint_of_another_case_is_refused(
    evolvent: Evolvent, case: Path, stopped: Path, words: list[str], wrong: str
) -> None:
    before = sorted((path.name, path.stat().st_size) for path in stopped.iterdir())
    result = go_on(evolvent, case, *words)
    assert result.returncode == 3
    assert wrong in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert sorted((path.name, path.stat().st_size) for path in stopped.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "word"),
    [("program", "version"), ("integrator", "integrator"), ("kernel", "kernel")],
)
def test_a_checkpoint_of_another_program_is_refused_by_the_name_of_what_differs(
    evolvent: Evolvent, case: Path, stopped: Path, name: str, word: str
) -> None:
    path = stopped / "checkpoint.h5"
    with h5py.File(path, "r+") as file:
        file[name][0] = ord("X")
        theirs = bytes(file[name][:-1]).decode()
    check_anew(path)
    result = go_on(evolvent, case)
    assert result.returncode == 3
    assert f"the checkpoint is of another {word}: '{theirs[:40]}" in result.stderr
    assert len(result.stderr.splitlines()) == 1


def test_of_a_damaged_checkpoint_the_one_before_it_is_taken_with_a_word(
    evolvent: Evolvent, case: Path, stopped: Path, tmp_path: Path
) -> None:
    path = stopped / "checkpoint.h5"
    path.write_bytes(path.read_bytes()[:-1])
    result = go_on(evolvent, case)
    assert result.returncode == 0
    assert "checkpoint.h5' is damaged" in result.stderr
    assert "continues from the previous checkpoint" in result.stderr
    assert evolvent("run", case, "-o", "plain.h5", "-q").returncode == 0
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")


def test_no_flipped_byte_of_a_checkpoint_gets_by(
    evolvent: Evolvent, case: Path, stopped: Path
) -> None:
    (stopped / "checkpoint-before.h5").unlink()
    path = stopped / "checkpoint.h5"
    whole = path.read_bytes()
    rng = np.random.default_rng(1)
    for offset in rng.integers(0, len(whole), 60):
        damaged = bytearray(whole)
        damaged[offset] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        result = go_on(evolvent, case)
        assert result.returncode == 3
        assert "is damaged, or is not a checkpoint; start again without --continue" in result.stderr
        assert len(result.stderr.splitlines()) == 1
    path.write_bytes(whole)
    assert go_on(evolvent, case).returncode == 0


def test_a_part_that_is_missing_or_holds_less_is_refused(
    evolvent: Evolvent, case: Path, stopped: Path
) -> None:
    first, second = stopped / "part-0001.h5", stopped / "part-0002.h5"
    shutil.copy(second, first)
    result = go_on(evolvent, case)
    assert result.returncode == 3
    assert "its parts hold" in result.stderr
    first.unlink()
    result = go_on(evolvent, case)
    assert result.returncode == 3
    assert "part-0001.h5: the part is missing, or damaged" in result.stderr


def test_what_a_stopped_run_left_is_not_overwritten_by_another(
    evolvent: Evolvent, case: Path, stopped: Path
) -> None:
    result = evolvent("run", case, "-o", "a.h5", "-q", "--checkpoint", "1")
    assert result.returncode == 3
    assert "a stopped run can be resumed from here; add --continue" in result.stderr
    assert (stopped / "checkpoint.h5").exists()


def test_what_is_newer_than_the_checkpoint_goes(
    evolvent: Evolvent, case: Path, stopped: Path, tmp_path: Path
) -> None:
    for name in ("part-0099.h5", "part-0100.h5.partial", "checkpoint.h5.partial"):
        (stopped / name).write_bytes(b"half")
    (stopped / "note.txt").write_text("of the user")
    assert go_on(evolvent, case).returncode == 0
    assert [path.name for path in stopped.iterdir()] == ["note.txt"]
    assert evolvent("run", case, "-o", "plain.h5", "-q").returncode == 0
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")


def test_nothing_to_go_on_from_is_refused_also_when_the_history_is_complete(
    evolvent: Evolvent, case: Path
) -> None:
    for _ in range(2):
        result = go_on(evolvent, case)
        assert result.returncode == 3
        assert "there is no checkpoint in" in result.stderr
        result = evolvent("run", case, "-o", "a.h5", "-q", "--checkpoint", "1")
        assert result.returncode == 0


@pytest.mark.parametrize(
    "words",
    [
        ["--checkpoint", "0"],
        ["--checkpoint", "soon"],
        ["--max-time", "-1"],
        ["--checkpoint-at", "2,1"],
        ["--checkpoint-at", "1,x"],
        ["--checkpoint-at", ","],
    ],
)
def test_numbers_that_mean_nothing_are_wrong_usage(
    evolvent: Evolvent, case: Path, tmp_path: Path, words: list[str]
) -> None:
    result = evolvent("run", case, *words)
    assert result.returncode == 2
    assert words[0] in result.stderr.splitlines()[0]
    assert not [*tmp_path.glob("*.h5*")]


def test_a_folder_that_cannot_be_made_is_an_output_that_cannot_be_written(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    for name in ("nowhere/a.h5", "file/a.h5"):
        (tmp_path / "file").touch()
        result = evolvent("run", case, "-q", "-o", name, "--checkpoint", "1")
        assert result.returncode == 74
        assert f"cannot write '{name}.parts'" in result.stderr
        assert len(result.stderr.splitlines()) == 1


def test_where_no_room_is_left_the_checkpoint_before_stands_and_the_run_goes_on_from_it(
    executable: Path, evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    words: list[str | Path] = ["run", case, "-o", "a.h5", "-q"]
    assert evolvent(*words, "--max-time", SOON).returncode == 75
    folder = tmp_path / "a.h5.parts"
    kept = (folder / "checkpoint.h5").read_bytes()
    for limit in (len(kept) // 2, 3000, 100):
        result = subprocess.run(
            [executable, *words, "--continue", "--checkpoint", "0.0001"],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=partial(resource.setrlimit, resource.RLIMIT_FSIZE, (limit, limit)),
        )
        assert result.returncode == 74, result.stderr
        assert "then continue from t = " in result.stderr
        assert len(result.stderr.splitlines()) == 1
        assert (folder / "checkpoint.h5").read_bytes() == kept
    assert go_on(evolvent, case).returncode == 0
    assert evolvent("run", case, "-o", "plain.h5", "-q").returncode == 0
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")


def test_a_run_that_fails_leaves_what_it_leaves_without_checkpoints(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    torque = "wheels.pinion.loads.0.value=-1e9"  # the teeth are pressed through each other
    words: list[str | Path] = ["run", examples / "paper.yaml", "-q", "--set", torque]
    words += ["--set", "meshes.0.tracking=closed_form", "--set", "simulation.integrator=radau"]
    for name, more in (("plain.h5", []), ("a.h5", ["--checkpoint", "0.0001"])):
        result = evolvent(*words, "-o", name, *more)
        assert result.returncode == 4, result.stderr
        assert f"the history up to there is in '{name}.partial'" in result.stderr
    assert contents(tmp_path / "a.h5.partial") == contents(tmp_path / "plain.h5.partial")
    assert not (tmp_path / "a.h5.parts").exists()


SPENT = re.compile(r"the run is not complete after (\d+) steps; .*continues from here with: (.*)$")


def spend(evolvent: Evolvent, words: list[str | Path], most: int, *more: str) -> tuple[int, str]:
    """Exceed the step limit; return the number of steps, and the command to resume."""
    limit = f"simulation.max_steps={most}"
    result = evolvent(*words, "-o", "a.h5", "-q", "--set", limit, *more)
    assert result.returncode == 4, result.stderr
    (line,) = result.stderr.splitlines()
    reported = SPENT.search(line)
    assert reported, line
    return int(reported[1]), reported[2]


@pytest.mark.parametrize("integrator", ["radau", "ida"])
def test_a_run_whose_steps_are_over_goes_on_with_more_of_them(
    evolvent: Evolvent, examples: Path, tmp_path: Path, integrator: str
) -> None:
    words: list[str | Path] = ["run", examples / "rattle.yaml"]
    words += ["--set", f"simulation.integrator={integrator}", "--set", "simulation.duration=0.3"]
    at_once = 1000  # steps of IDA between two checks
    made, command = spend(evolvent, words, 2000, "--checkpoint", "60")
    assert 2000 <= made <= 2000 + at_once
    assert command.endswith("--set simulation.max_steps=2000 --continue")
    assert list(tmp_path.rglob("*.partial")) == []  # all outputs are before the checkpoint
    # without checkpoint it stops at once; the steps so far count
    made_since, _ = spend(evolvent, words, 2000, "--continue")
    assert made <= made_since <= made + at_once
    made_in_all, _ = spend(evolvent, words, 4000, "--continue", "--set", "title=any other")
    assert 4000 <= made_in_all <= 4000 + at_once
    more = ["--set", "simulation.max_steps=none"]
    assert evolvent(*words, *more, "-o", "a.h5", "-q", "--continue").returncode == 0
    assert not (tmp_path / "a.h5.parts").exists()
    with h5py.File(tmp_path / "a.h5") as file:
        assert int(file.attrs["integrator_steps"]) > made_in_all
        at = ["--checkpoint-at", file.attrs["checkpoints"]] if integrator == "ida" else []
    assert evolvent(*words, *more, "-o", "plain.h5", "-q", *at).returncode == 0
    assert contents(tmp_path / "a.h5") == contents(tmp_path / "plain.h5")


def entries(state: bytes) -> list[tuple[int, int]]:
    """Offsets and lengths of the saved entries: a length precedes each."""
    found, at = [], 0
    while at < len(state):
        (length,) = struct.unpack_from("<Q", state, at)
        found.append((at + 8, length))
        at += 8 + -(-length // 8) * 8
    return found


def test_where_outputs_show_a_missed_event_the_run_begins_anew_at_its_checkpoint(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """A checkpoint in which a pressed pair is marked as separated: no run reaches such a state.

    The outputs detect it eight at a time, and then one by one: the same message the second time
    shows that the run was reset to the checkpoint.
    """
    words: list[str | Path] = ["run", examples / "paper-friction.yaml", "-q"]
    for given in ("tracking=closed_form", "integrator=radau", "duration=400"):
        words += ["--set", f"{'meshes.0' if 'tracking' in given else 'simulation'}.{given}"]
    assert evolvent(*words, "-o", "plain.h5").returncode == 0
    assert evolvent(*words, "-o", "a.h5", "--max-time", "0.0005").returncode == 75
    path = tmp_path / "a.h5.parts" / "checkpoint.h5"
    with h5py.File(path, "r+") as file:
        state = bytearray(file["state"][:].tobytes())
        t = float(np.frombuffer(file["time"][:].tobytes())[0])
        integers, length = entries(bytes(state))[7]  # after the head, t, y and y'
        modes = list(struct.unpack_from(f"<{length // 4}i", state, integers))
        assert (len(modes), modes[2]) == (4, 1)  # pressed
        modes[2] = 0
        struct.pack_into(f"<{length // 4}i", state, integers, *modes)
        file["state"][:] = np.frombuffer(bytes(state), np.uint8)
    check_anew(path)
    result = evolvent(*words, "-o", "a.h5", "--continue")
    assert result.returncode == 4, result.stderr
    assert "counts as open: an event was missed" in result.stderr
    with h5py.File(tmp_path / "a.h5.partial") as part, h5py.File(tmp_path / "plain.h5") as whole:
        n = len(part["time"])
        assert t - 0.02 < part["time"][-1] <= t + 0.02  # one output per 0.01 s
        for name in ("time", "normal_force", "penetration"):
            assert np.array_equal(part[name][: n - 1], whole[name][: n - 1])
    assert not (tmp_path / "a.h5.parts").exists()
