"""Histories to work on, written once a session in the layout of result_format."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import xarray as xr
from gearbox_reference import solve
from synthetic import make_events, make_history, write_history

from evolvent.commands.post.app import main
from evolvent.library import binding
from kernel.gearbox import event_names
from kernel.kernel import Kernel


@pytest.fixture(scope="session", autouse=True)
def library(executable: Path) -> Iterator[None]:
    """Load the library beside the program under test."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(binding.VARIABLE, str(executable.resolve().with_name(binding.NAME)))
        binding.load.cache_clear()
        yield
    binding.load.cache_clear()


@dataclass(frozen=True)
class Run:
    """A history in memory and on file."""

    history: xr.Dataset
    events: xr.Dataset
    path: Path


def _run(folder: Path, name: str, solution: dict[str, Any], kinds: list[str]) -> Run:
    history, events = make_history(solution), make_events(solution, kinds)
    return Run(history, events, write_history(folder / f"{name}.h5", history, events))


@pytest.fixture(scope="session")
def kinds(kernel: Kernel) -> list[str]:
    """Names of the kinds of events, in the order of their numbers in a history."""
    return event_names(kernel)


@pytest.fixture(scope="session")
def friction_run(tmp_path_factory: pytest.TempPathFactory, kinds: list[str]) -> Run:
    """3 s with f = 0.3: one tooth switch and three ends of the friction law's linear part."""
    folder = tmp_path_factory.mktemp("runs")
    return _run(folder, "friction", solve(friction=0.3, t_end=3.0), kinds)


@pytest.fixture(scope="session")
def smooth_run(tmp_path_factory: pytest.TempPathFactory, kinds: list[str]) -> Run:
    """Half a second without friction: no event at all."""
    folder = tmp_path_factory.mktemp("runs")
    return _run(folder, "smooth", solve(friction=0.0, t_end=0.5), kinds)


@pytest.fixture
def post(monkeypatch, capsys, tmp_path):
    """Run evolvent-post in an empty folder: exit code, stdout, stderr."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["evolvent-post", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            main()
        captured = capsys.readouterr()
        return int(stopped.value.code or 0), captured.out, captured.err

    return run
