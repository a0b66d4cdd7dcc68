"""The test library of the lanes, loaded once."""

from __future__ import annotations

from pathlib import Path

import pytest

from kernel.kernel import Kernel


@pytest.fixture(scope="session")
def kernel(lanes_library: Path) -> Kernel:
    """Binding of the library, which brings the kernel's with it."""
    return Kernel(lanes_library)
