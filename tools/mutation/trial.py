"""Run the tests of a mutant: each with a time limit, and leave no process behind."""

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

SECONDS = 60  # limit of each test; set higher on a machine under other load
PR_SET_CHILD_SUBREAPER = 36
BROKEN = re.compile(r"^ERROR (\S+)", re.MULTILINE)  # a file that cannot be collected


@dataclass(frozen=True)
class Outcome:
    """Whether all tests passed; if not, the detecting test and the kind of failure."""

    passed: bool
    by: str = ""
    how: str = ""  # empty if it simply failed
    left_behind: int = 0
    is_built: bool = True


def adopt_orphans() -> None:
    """Become the parent of processes that tests leave behind."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def end_what_is_left() -> int:
    """Kill all descendants of this process; return their number."""
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
    """Run tests until one fails: C tests as programs, then Python files by pytest.

    Targets of tests in Python are built only if all C tests passed. `first` are tests
    to run before the others.
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
    options += [f"--basetemp={folder / 'pytest'}", "--ignore=tests/tools"]  # they check the list
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
    """Describe how a process ended by a signal."""
    if code == -signal.SIGALRM:
        return f"not within {SECONDS} s"
    return signal.Signals(-code).name if code < 0 else ""


def _run(
    command: Sequence[str | Path], ground: Ground, environment: dict[str, str], seconds: float
) -> tuple[int, str]:
    """Run a command, return exit code and output; a timeout counts as an alarm signal."""
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
    time.sleep(0.01)  # processes that end with their parent have ended
    return code, log.read_text(errors="replace")
