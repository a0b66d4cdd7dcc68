"""`evolvent respond` resumes after signals to the same bytes as an uninterrupted run."""

from __future__ import annotations

import random
import signal
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path

import pytest
import yaml

from processes import catches, wait_for
from system.random_sets import seeds
from system.test_metrics import rectangular
from system.test_respond import SPEED, UNIT, speeds, write_rectangular

SIGNALS = [signal.SIGTERM, signal.SIGUSR1]
METHODS = {
    "motions": ["--over", speeds(1.3, 1.34, 0.01)],
    "orbits": ["--over", f"{SPEED}={-1.3 * UNIT!r}:{-1.4 * UNIT!r}", "--method", "orbits"],
}


@pytest.fixture(scope="module", params=METHODS)
def whole(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, executable: Path
) -> tuple[list[object], Path, float]:
    """A command without its result, the result of an uninterrupted run, and its time [s]."""
    folder = tmp_path_factory.mktemp("whole")
    words = [executable, "respond", write_rectangular(folder), *METHODS[request.param], "-q"]
    began = time.monotonic()
    done = subprocess.run([*words, "-o", "whole.h5"], cwd=folder, check=False)
    assert done.returncode == 0
    return words, folder / "whole.h5", time.monotonic() - began


def assert_same_after_stops(
    words: Sequence[object],
    whole: Path,
    folder: Path,
    delays: Sequence[float],
    sent: signal.Signals,
) -> None:
    """Stop a command after each delay from its first signal handler; then let it end."""
    command = [*words, "-o", "stopped.h5"]
    for delay in delays:
        with subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, text=True) as process:
            wait_for(
                lambda process=process: catches(process.pid, sent) or process.poll() is not None
            )
            time.sleep(delay)
            process.send_signal(sent)
            _, messages = process.communicate(timeout=120)
        assert process.returncode in (0, 75), messages
        if process.returncode == 75:
            assert f"interrupted by {sent.name}" in messages
            assert "repeat the command to continue" in messages
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert (folder / "stopped.h5").read_bytes() == whole.read_bytes()
    assert not list(folder.glob("*.par*"))


@pytest.mark.parametrize("sent", SIGNALS)
def test_a_signal_before_the_first_motion_loses_nothing(
    whole: tuple[list[object], Path, float], tmp_path: Path, sent: signal.Signals
) -> None:
    """The checkpoint then contains no state: the resumed command starts as given in the case."""
    words, result, _ = whole
    assert_same_after_stops(words, result, tmp_path, [0, 0.002, 0.005], sent)


@pytest.mark.parametrize("sent", SIGNALS)
@pytest.mark.parametrize("seed", seeds(range(5), 200))
def test_a_signal_at_any_instant_loses_nothing(
    whole: tuple[list[object], Path, float], tmp_path: Path, seed: int, sent: signal.Signals
) -> None:
    """Every second signal comes within the first hundredths of a second."""
    words, result, took = whole
    draw = random.Random(seed)
    longest = 0.03 if seed % 2 else took
    delays = [draw.uniform(0, longest) for _ in range(draw.randint(1, 3))]
    assert_same_after_stops(words, result, tmp_path, delays, sent)


@pytest.mark.parametrize("sent", SIGNALS)
@pytest.mark.parametrize("seed", seeds(range(3), 200))
def test_a_run_that_goes_on_from_a_checkpoint_has_the_bytes_of_one_that_ran_through(
    executable: Path, tmp_path: Path, seed: int, sent: signal.Signals
) -> None:
    """`run` with checkpoints, stopped at any time: its history without the record of the stops."""
    case = rectangular(1.3, 50, 20, "radau")
    (tmp_path / "case.yaml").write_text(yaml.safe_dump(case))
    words = [executable, "run", "case.yaml", "-q", "--checkpoint", "60"]
    whole = subprocess.run([*words, "-o", "whole.h5"], cwd=tmp_path, check=False)
    assert whole.returncode == 0
    draw = random.Random(seed)
    kept = tmp_path / "stopped.h5.parts" / "checkpoint.h5"
    for _ in range(3):
        more = ["--continue"] if kept.exists() else []
        command = [*words, "-o", "stopped.h5", *more]
        with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
            wait_for(
                lambda process=process: catches(process.pid, sent) or process.poll() is not None
            )
            time.sleep(draw.uniform(0, 0.02 if seed % 2 else 0.2))
            process.send_signal(sent)
            _, messages = process.communicate(timeout=120)
        assert process.returncode in (0, 75), messages
        if process.returncode == 0:
            break
    if process.returncode == 75:
        more = ["--continue"] if kept.exists() else []
        command = [*words, "-o", "stopped.h5", *more]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert states(tmp_path / "stopped.h5") == states(tmp_path / "whole.h5")


def states(path: Path) -> dict[str, bytes]:
    """All arrays of numbers of the root of a history."""
    import h5py

    with h5py.File(path, "r") as file:
        return {
            name: data[...].tobytes()
            for name, data in file.items()
            if isinstance(data, h5py.Dataset) and data.dtype.kind in "fi"
        }
