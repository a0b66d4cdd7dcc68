"""Processes left behind by a test: the test fails, and the process is terminated.

A process whose parent has ended becomes a child of the tests, so that none escapes. Processes
started by fixtures are excluded: they may last longer than a test.
"""

from __future__ import annotations

import ctypes
import os
import signal
import time
from collections.abc import Generator
from pathlib import Path

import pytest

from processes import is_alive

PR_SET_CHILD_SUBREAPER = 36
SECONDS = 5.0  # time limit for the end of a terminated process
OF_PYTHON = "multiprocessing.resource_tracker"  # lasts as long as the process that uses it
STARTED = pytest.StashKey[set[int]]()


def _children() -> set[int]:
    tasks = Path("/proc/self/task").glob("*/children")
    return {int(pid) for task in tasks for pid in task.read_text().split()}


def _command(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode().strip()
    except OSError:
        return ""


def pytest_sessionstart() -> None:
    """Become the parent of orphaned processes."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Record the processes that the test itself starts."""
    before = _children()
    try:
        return (yield)
    finally:
        item.stash[STARTED] = _children() - before


@pytest.hookimpl(wrapper=True)
def pytest_runtest_teardown(item: pytest.Item) -> Generator[None, None, None]:
    """Fail if any of them is still running after the test."""
    yield
    started = item.stash.get(STARTED, set())
    end = time.monotonic() + SECONDS
    while any(map(is_alive, started)) and time.monotonic() < end:
        time.sleep(0.02)
    left = {pid: _command(pid) for pid in started if is_alive(pid)}
    left = {pid: command for pid, command in left.items() if OF_PYTHON not in command}
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    if left:
        reported = ", ".join(f"{pid} ({command[:200]})" for pid, command in left.items())
        pytest.fail(f"the test left processes behind: {reported}", pytrace=False)
