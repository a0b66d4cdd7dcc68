"""`evolvent respond --method orbits` resumes after a stop with bitwise equal results."""

from __future__ import annotations

import random
import signal
import subprocess
import time
from pathlib import Path

import pytest
import xarray as xr

from processes import wait_for
from system.test_respond import SPEED, UNIT, write_rectangular

BUSY = f"{SPEED}={-1.2 * UNIT!r}:{-2.1 * UNIT!r}"  # a fold and a doubling on its branches


def command(executable: Path, case: Path, over: str, result: Path) -> list[object]:
    return [executable, "respond", case, "--over", over, "--method", "orbits", "-q", "-o", result]


def stop(words: list[object], after: float, sent: signal.Signals) -> tuple[int, str]:
    """Start the command, and send a signal after a delay; it may end before."""
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as process:
        time.sleep(after)
        process.send_signal(sent)
        _, messages = process.communicate(timeout=60)
    return process.returncode, messages


def load(path: Path) -> xr.Dataset:
    with xr.open_dataset(path, engine="h5netcdf") as file:
        return file.load()


@pytest.mark.parametrize("sent", [signal.SIGTERM, signal.SIGKILL])
def test_stopped_at_any_time_it_goes_on_with_the_same_bits(
    evolvent, executable, tmp_path: Path, sent: signal.Signals
) -> None:
    """Stopped ten times during the computation."""
    case = write_rectangular(tmp_path)
    whole, stopped = tmp_path / "whole.h5", tmp_path / "stopped.h5"
    began = time.monotonic()
    done = evolvent(*command(executable, case, BUSY, whole)[1:])
    assert done.returncode == 0, done.stderr
    took = time.monotonic() - began
    words = command(executable, case, BUSY, stopped)
    draw = random.Random(f"{sent.name} 1")
    far = 0
    for _ in range(10):
        code, messages = stop(words, draw.uniform(0.05, 0.25) * took, sent)
        if code == 0:
            break
        if sent == signal.SIGTERM:
            assert code == 75, messages
            assert "interrupted by SIGTERM" in messages
            assert "repeat the command to continue" in messages
            partial = load(Path(f"{stopped}.partial"))
            assert partial.attrs["status"] == "interrupted"
            assert partial.sizes["point"] >= far
            far = partial.sizes["point"]
        else:
            assert code == -signal.SIGKILL
    done = evolvent(*words[1:])
    assert done.returncode == 0, done.stderr
    assert not (tmp_path / "stopped.h5.parts").exists()
    xr.testing.assert_identical(load(whole), load(stopped))


def test_what_was_kept_of_other_orbits_is_refused(evolvent, executable, tmp_path: Path) -> None:
    """Another range, another case; motions over the same range; then it still resumes."""
    case, result = write_rectangular(tmp_path), tmp_path / "o.h5"
    long = ("--values", "8001")  # it takes some seconds
    words = [*command(executable, case, BUSY, result), *long]
    kept = tmp_path / "o.h5.parts" / "checkpoint.h5"
    with subprocess.Popen(words, stderr=subprocess.PIPE, text=True) as process:
        wait_for(kept.exists)
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=60)
    before = kept.read_bytes()
    narrow = f"{SPEED}={-1.2 * UNIT!r}:{-2.0 * UNIT!r}"
    for other in (
        [*command(executable, case, narrow, result), *long],
        [*words[:-1], "8000"],
        [*words, "--set", "meshes.ab.damping.value=0.04"],
        [*words, "--periods", "1000"],
        ["-", "respond", case, "--over", f"{BUSY}:5", "-q", "-o", result],
    ):
        done = evolvent(*other[1:])
        assert done.returncode == 3, done.stderr
        assert "another incomplete response" in done.stderr.splitlines()[-1]
    assert kept.read_bytes() == before
    assert evolvent(*words[1:]).returncode == 0
