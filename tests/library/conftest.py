"""The library is that of the build that the other tests use."""

from __future__ import annotations

from pathlib import Path

import pytest

from evolvent.library.binding import NAME, VARIABLE


@pytest.fixture(scope="session")
def library(executable: Path) -> Path:
    """Path of the library."""
    return executable.resolve().parent / NAME


@pytest.fixture(autouse=True)
def loaded(library: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What `evolvent.run` loads."""
    monkeypatch.setenv(VARIABLE, str(library))
