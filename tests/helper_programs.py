"""Programs started by tests: they must be listed in machine.txt; their failures are reported.

pytest hooks, a plugin of conftest.py.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest

import machine

ROOT = Path(__file__).resolve().parents[1]
SYSTEM = ("/usr", "/bin", "/sbin")  # builds, environments and scripts of tests are elsewhere
STARTERS = (subprocess.__file__, os.__file__)
SKIPS = "EVOLVENT_SKIPS"  # variable with the path of the file for the list of skipped tests
LAST_LINES = 40  # of the output of a failed program


def is_listed(name: str) -> bool:
    """Whether a test may start a program of this name or path: listed, or created by tests."""
    if name in ("sh", "/bin/sh", sys.executable) or Path(name).name in machine.LISTED:
        return True
    found = name if os.sep in name else shutil.which(name)
    path = Path(found or "/bin/missing").absolute()
    return not any(path.is_relative_to(folder) for folder in SYSTEM)


def _is_ours() -> bool:
    """Whether code of the project, not of a library, starts the program."""
    frame = sys._getframe(2)
    while frame is not None and frame.f_code.co_filename in STARTERS:
        frame = frame.f_back
    path = Path(frame.f_code.co_filename) if frame is not None else Path()
    return path.is_relative_to(ROOT) and not path.is_relative_to(sys.prefix)


def _check(event: str, arguments: tuple[Any, ...]) -> None:
    if event in ("subprocess.Popen", "os.exec", "os.posix_spawn") and _is_ours():
        name = os.fsdecode(arguments[0])
        if not is_listed(name):
            raise AssertionError(f"{name} is not in {machine.LIST.name}: add its row there")


def pytest_sessionstart() -> None:
    """Reject programs started by the project's code that are not in machine.txt."""
    sys.addaudithook(_check)


def _failures(error: BaseException | None) -> Generator[Any]:
    """Errors of programs among an exception and its causes."""
    while error is not None:
        if isinstance(error, (subprocess.CalledProcessError, subprocess.TimeoutExpired)):
            yield error
        error = error.__cause__ or error.__context__


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    call: pytest.CallInfo[None],
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Report the output of a program whose failure ended the test."""
    report = yield
    for error in _failures(call.excinfo.value if call.excinfo else None):
        for stream, printed in (("stdout", error.stdout), ("stderr", error.stderr)):
            text = printed.decode(errors="replace") if isinstance(printed, bytes) else printed
            if text:
                last = "\n".join(text.splitlines()[-LAST_LINES:])
                report.sections.append((f"{stream} of {error.cmd}", last))
    return report


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Write the number of skipped tests by reason to the file named in the environment."""
    path = os.environ.get(SKIPS)
    if path is None:
        return
    skipped = terminalreporter.stats.get("skipped", [])
    reasons = Counter(report.longrepr[2].removeprefix("Skipped: ") for report in skipped)
    lines = [f"{number:5d}  {reason}\n" for reason, number in reasons.most_common()]
    Path(path).write_text("".join(lines), encoding="utf-8")
