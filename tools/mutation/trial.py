"""Tests that are run on a mutant: each within its time, and no process of theirs left behind."""

from __future__ import annotations

import ctypes
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest

from mutation import limit
from mutation.ground import Ground

SECONDS = 60  # each test may take; more of them where the machine does other things, too
PR_SET_CHILD_SUBREAPER = 36
BROKEN = re.compile(r"^ERROR (\S+)", re.MULTILINE)  # a file that is not even collected


@dataclass(frozen=True)
class Outcome:
    """Whether all tests passed; if not, which of them noticed, and how."""

    passed: bool
    by: str = ""
    how: str = ""  # if it did not simply fail
    left_behind: int = 0
    is_built: bool = True


def adopt_orphans() -> None:
    """Become the parent of what tests leave behind."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def end_what_is_left() -> int:
    """Kill all children of this process and theirs; tell how many there were."""
    count = 0
    while pids := _children(os.getpid()):
        for pid in pids:
            os.kill(pid, signal.SIGKILL)
            os.waitpid(pid, 0)
            count += 1
    return count


def _children(parent: int) -> list[int]:
    tasks = Path(f"/proc/{parent}/task").glob("*/children")
    return [int(pid) for task in tasks for pid in task.read_text().split()]


def run_tests(
    ground: Ground, tests: tuple[str, ...], folder: Path, first: Sequence[str] = ()
) -> Outcome:
    """Run tests until one fails: C files as the programs they are, then Python files by pytest.

    What tests in Python need is built only where the programs noticed nothing. `first` are tests
    that are asked before the others.
    """
    for test in [test for test in tests if test.endswith(".c")]:
        if not ground.make((test,)):
            return Outcome(passed=False, is_built=False)
        outcome = _program(ground, test)
        if not outcome.passed:
            return outcome
    python = [test for test in tests if not test.endswith(".c")]
    if python and not ground.make(tuple(python)):
        return Outcome(passed=False, is_built=False)
    return _pytest(ground, python, folder, first) if python else Outcome(passed=True)


def _program(ground: Ground, test: str) -> Outcome:
    command = [ground.build / "tests" / Path(test).stem]
    code, _ = _run(command, ground, ground.environment(), SECONDS)
    left = end_what_is_left()
    return Outcome(code == 0, "" if code == 0 else test, _how(code), left)


def _pytest(ground: Ground, tests: list[str], folder: Path, first: Sequence[str]) -> Outcome:
    running = folder / "running"
    running.write_text("collection")
    environment = {
        **ground.environment(),
        limit.SECONDS: str(SECONDS),
        limit.RUNNING: str(running),
        limit.FIRST: "\n".join(first),
    }
    options = ["-x", "-q", "-p", "no:cacheprovider", "-p", "mutation.limit", "--no-header"]
    options += [f"--basetemp={folder / 'pytest'}", "--ignore=tests/tools"]  # they hold the list
    command = [sys.executable, "-m", "pytest", *options, *tests]
    code, output = _run(command, ground, environment, 20 * SECONDS)
    (folder / "pytest.log").write_text(output)
    left = end_what_is_left()
    if code == 0:
        skipped = int(running.read_text())
        return Outcome(passed=True, how=f"{skipped} skipped" * bool(skipped), left_behind=left)
    broken = BROKEN.search(output) if code == pytest.ExitCode.INTERRUPTED else None
    by = broken[1] if broken else running.read_text()
    return Outcome(passed=False, by=by, how=_how(code), left_behind=left)


def _how(code: int) -> str:
    """Tell how a process ended that had no time to say so."""
    if code == -signal.SIGALRM:
        return f"not within {SECONDS} s"
    return signal.Signals(-code).name if code < 0 else ""


def _run(
    command: Sequence[str | Path], ground: Ground, environment: dict[str, str], seconds: float
) -> tuple[int, str]:
    """Exit code and output of a command; one that takes too long ends as by an alarm."""
    log = ground.log.with_name("test.log")
    with log.open("w") as output:
        process = subprocess.Popen(
            command, cwd=ground.tree, env=environment, stdin=subprocess.DEVNULL,
            stdout=output, stderr=output, start_new_session=True,
        )  # fmt: skip
        try:
            code = process.wait(seconds)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
            code = -signal.SIGALRM
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            raise
    time.sleep(0.01)  # what ends with its parent has ended
    return code, log.read_text(errors="replace")
