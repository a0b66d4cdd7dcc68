"""The test library of the lanes, loaded once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from kernel.kernel import Kernel

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def kernel() -> Kernel:
    """Binding of the library: that of EVOLVENT_LANES_LIBRARY, else the first one built.

    It brings the kernel's shared library with it.
    """
    named = os.environ.get("EVOLVENT_LANES_LIBRARY")
    name = Path("tests/lanes/liblanes_test.so")
    candidates = [Path(named)] if named else [ROOT / "build" / b / name for b in ("ci", "debug")]
    for candidate in candidates:
        if candidate.is_file():
            return Kernel(candidate)
    looked = ", ".join(map(str, candidates))
    pytest.fail(
        f"{name.name} is not built (looked for {looked}); run ./runtests, or configure with "
        "-DEVOLVENT_TESTS=ON, or set EVOLVENT_LANES_LIBRARY",
        pytrace=False,
    )
