"""A pytest plugin: a test that takes too long ends the run; detecting tests come first."""

from __future__ import annotations

import os
import signal
from collections.abc import Generator
from pathlib import Path

import pytest

SECONDS = "EVOLVENT_MUTATE_SECONDS"
RUNNING = "EVOLVENT_MUTATE_RUNNING"  # a file: the running test; at the end, the number skipped
FIRST = "EVOLVENT_MUTATE_FIRST"  # tests to run before the others, a line each
SKIPPED: set[str] = set()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Run tests first that detected other mutants of the file."""
    first = os.environ.get(FIRST, "").splitlines()
    rank = {name: index for index, name in enumerate(first)}
    items.sort(key=lambda item: rank.get(item.nodeid, len(rank)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Record the running test; the default action of the alarm ends it, also in compiled code."""
    Path(os.environ[RUNNING]).write_text(item.nodeid)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(int(os.environ[SECONDS]))
    try:
        return (yield)
    finally:
        signal.alarm(0)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Record skipped tests."""
    if report.skipped:
        SKIPPED.add(report.nodeid)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(exitstatus: int) -> None:
    """Write the number of skipped tests: they give no verdict on a surviving mutant."""
    if exitstatus == 0:
        Path(os.environ[RUNNING]).write_text(str(len(SKIPPED)))
