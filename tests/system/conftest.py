"""The runs that the system tests share."""

from __future__ import annotations

from pathlib import Path

import pytest

from system.runs import Runs


@pytest.fixture(scope="session")
def runs(executable: Path, examples: Path, tmp_path_factory: pytest.TempPathFactory) -> Runs:
    """Make a run, or give the one made before."""
    return Runs(executable, examples, tmp_path_factory.mktemp("runs"))
