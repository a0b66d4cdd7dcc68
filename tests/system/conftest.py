"""Runs shared by the system tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from system.runs import Runs


@pytest.fixture(scope="session")
def runs(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Runs:
    """Return a function that makes a run, or returns an earlier one."""
    return Runs(executable, examples, tmp_path_factory.mktemp("runs"))
