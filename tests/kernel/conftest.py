"""The kernel's parts, loaded once."""

from __future__ import annotations

from pathlib import Path

import pytest

from kernel.kernel import Kernel


@pytest.fixture(scope="session")
def kernel(kernel_library: Path) -> Kernel:
    """Binding of the kernel's shared library."""
    return Kernel(kernel_library)
