"""The command evolvent-sweep as a fixture; what it asks is the program that is tested."""

from __future__ import annotations

from pathlib import Path

import pytest
from sweep_command import sweep

__all__ = ["sweep"]


@pytest.fixture(autouse=True)
def program(monkeypatch: pytest.MonkeyPatch, executable: Path) -> None:
    """Name the program to everything that asks it."""
    monkeypatch.setenv("EVOLVENT_EXECUTABLE", str(executable))
