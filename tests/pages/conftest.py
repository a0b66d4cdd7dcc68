"""Histories of examples, and the pages made of them."""

from __future__ import annotations

import fcntl
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from headless import Browser, programs
from long_history import million

from evolvent import open_events, open_history
from evolvent.pages.report import report


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """Folder of all workers: what takes seconds is made once."""
    base = tmp_path_factory.getbasetemp()
    folder = (base if worker_id == "master" else base.parent) / "pages"
    folder.mkdir(exist_ok=True)
    return folder


def once(path: Path, make: Callable[[Path], object]) -> Path:
    """Make a file if no worker has made it yet."""
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not path.exists():
            make(path)
    return path


@pytest.fixture(scope="session")
def example_run(executable: Path, examples: Path, shared: Path) -> Callable[[str], Path]:
    """Run an example: the path of its history."""

    def run(name: str) -> Path:
        command = [executable, "run", examples / f"{name}.yaml", "-o"]
        return once(
            shared / f"{name}.h5",
            lambda path: subprocess.run(
                [*command, path], check=True, capture_output=True, timeout=120
            ),
        )

    return run


@pytest.fixture(scope="session")
def page_of(example_run: Callable[[str], Path], shared: Path) -> Callable[[str, bool], Path]:
    """Make the page of an example, or of the long history: its path."""

    def make(name: str, interactive: bool) -> Path:
        source = example_run("paper" if name == "million" else name)

        def write(path: Path) -> None:
            with open_history(source) as history, open_events(source) as events:
                shown = million(history) if name == "million" else history
                path.write_text(report(shown, events, interactive), encoding="utf-8")

        return once(shared / f"{name}-{interactive}.html", write)

    return make


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Chromium without a window."""
    opened = Browser(programs(), tmp_path_factory.mktemp("profile"))
    yield opened
    opened.driver.quit()
