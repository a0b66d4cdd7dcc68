"""The integrator's test library, loaded once."""

from __future__ import annotations

from pathlib import Path

import pytest

from integrator.radau import Library


@pytest.fixture(scope="session")
def library(kernel_test_library: Path) -> Library:
    """Binding of the library."""
    return Library(kernel_test_library)
