"""Start of programs in tests, and state of their processes in Linux."""

from __future__ import annotations

import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any


def wait_for(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until a condition is true; fail after a timeout."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.002)


@contextmanager
def running(
    command: Sequence[str | Path], folder: Path, **options: Any
) -> Iterator[subprocess.Popen[Any]]:
    """Run a command in a folder; wait for its end, or kill it if the test fails."""
    with subprocess.Popen(command, cwd=folder, **options) as process:
        try:
            yield process
        except BaseException:
            process.kill()
            raise


def _state_and_parent(pid: int) -> tuple[str, int] | None:
    """State letter and parent of a process; None if it has ended."""
    try:
        words = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return None
    return words[0], int(words[1])


def children(pid: int) -> list[int]:
    """Living processes that a process has started."""
    numbers = [int(entry.name) for entry in Path("/proc").glob("[0-9]*")]
    states = {number: _state_and_parent(number) for number in numbers}
    return [n for n, known in states.items() if known and known[1] == pid and known[0] != "Z"]


def is_alive(pid: int) -> bool:
    """Whether a process is running or stopped."""
    known = _state_and_parent(pid)
    return known is not None and known[0] != "Z"


def _has(pid: int, masks: tuple[str, ...], number: signal.Signals) -> bool:
    """Whether a signal is in one of these masks of a process."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return False
    words = dict(line.split(":", 1) for line in lines)
    return any(int(words[mask], 16) >> (number - 1) & 1 for mask in masks)


def catches(pid: int, number: signal.Signals) -> bool:
    """Whether a process has set a handler for a signal."""
    return _has(pid, ("SigCgt",), number)


def ignores(pid: int, number: signal.Signals) -> bool:
    """Whether a process ignores a signal."""
    return _has(pid, ("SigIgn",), number)


def awaits(pid: int, number: signal.Signals) -> bool:
    """Whether a signal is pending for a process."""
    return _has(pid, ("SigPnd", "ShdPnd"), number)
