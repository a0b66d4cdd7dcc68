"""A pytest plugin: a test that takes too long ends the whole run; tests that noticed come first."""

from __future__ import annotations

import os
import signal
from collections.abc import Generator
from pathlib import Path

import pytest

SECONDS = "EVOLVENT_MUTATE_SECONDS"
RUNNING = "EVOLVENT_MUTATE_RUNNING"  # a file: the test that runs; at the end, how many were skipped
FIRST = "EVOLVENT_MUTATE_FIRST"  # tests that are asked before the others, a line each
SKIPPED: set[str] = set()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Ask those first that noticed other mutants of the file."""
    first = os.environ.get(FIRST, "").splitlines()
    rank = {name: place for place, name in enumerate(first)}
    items.sort(key=lambda item: rank.get(item.nodeid, len(rank)))


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Note the test that runs, and let the alarm's own action end it, also in compiled code."""
    Path(os.environ[RUNNING]).write_text(item.nodeid)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(int(os.environ[SECONDS]))
    try:
        return (yield)
    finally:
        signal.alarm(0)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Note what was not asked."""
    if report.skipped:
        SKIPPED.add(report.nodeid)


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(exitstatus: int) -> None:
    """Tell how many were skipped: a mutant that survives those was not looked at."""
    if exitstatus == 0:
        Path(os.environ[RUNNING]).write_text(str(len(SKIPPED)))
