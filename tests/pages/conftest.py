"""Histories of examples, and the pages made of them."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from headless import Browser, programs
from long_history import million

from evolvent import open_events, open_history
from evolvent.pages.report import report


@pytest.fixture(scope="session")
def example_run(
    executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str], Path]:
    """Run an example once: the path of its history."""
    folder = tmp_path_factory.mktemp("pages")

    def run(name: str) -> Path:
        path = folder / f"{name}.h5"
        if not path.exists():
            command = [executable, "run", examples / f"{name}.yaml", "-o", path]
            subprocess.run(command, check=True, capture_output=True, timeout=120)
        return path

    return run


@pytest.fixture(scope="session")
def page_of(
    example_run: Callable[[str], Path], tmp_path_factory: pytest.TempPathFactory
) -> Callable[[str, bool], Path]:
    """Make the page of an example, or of the long history, once: its path."""
    folder = tmp_path_factory.mktemp("html")

    def make(name: str, interactive: bool) -> Path:
        path = folder / f"{name}-{interactive}.html"
        if not path.exists():
            source = example_run("paper" if name == "million" else name)
            with open_history(source) as history, open_events(source) as events:
                shown = million(history) if name == "million" else history
                path.write_text(report(shown, events, interactive), encoding="utf-8")
        return path

    return make


@pytest.fixture(scope="session")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    """Chromium without a window."""
    found = programs()
    if found is None:
        pytest.skip("no Chromium with its driver; Debian: apt install chromium chromium-driver")
    opened = Browser(found, tmp_path_factory.mktemp("profile"))
    yield opened
    opened.driver.quit()
