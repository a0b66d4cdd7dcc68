"""The test library with its orbits, loaded once."""

from __future__ import annotations

import ctypes
from pathlib import Path

import pytest

from continuation.orbits import load


@pytest.fixture(scope="session")
def c(kernel_test_library: Path) -> ctypes.CDLL:
    """Binding of the library."""
    return load(kernel_test_library)
