"""A pytest plugin: a test that takes too long ends the whole run, also inside compiled code."""

from __future__ import annotations

import os
import signal
from collections.abc import Generator
from pathlib import Path

import pytest

SECONDS = "EVOLVENT_MUTATE_SECONDS"
RUNNING = "EVOLVENT_MUTATE_RUNNING"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Note the test that runs, and let the alarm's own action end it."""
    Path(os.environ[RUNNING]).write_text(item.nodeid)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(int(os.environ[SECONDS]))
    try:
        return (yield)
    finally:
        signal.alarm(0)
