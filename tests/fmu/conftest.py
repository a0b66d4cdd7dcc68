"""FMUs are made by the program that the other tests use."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from fmu.importer import Make

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def make(evolvent: Evolvent, tmp_path: Path) -> Make:
    """`evolvent fmu` of a case; its file."""

    def make(case: Path, *options: str) -> Path:
        path = tmp_path / f"{case.stem}.fmu"
        result = evolvent("fmu", case, "-o", path, "-q", *options)
        assert (result.returncode, result.stdout) == (0, ""), result.stderr
        return path

    return make
