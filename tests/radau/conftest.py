"""The integrator's test library, loaded once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from radau.radau import Library

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def library() -> Library:
    """Binding of the library: that of EVOLVENT_RADAU_LIBRARY, else the first one built."""
    named = os.environ.get("EVOLVENT_RADAU_LIBRARY")
    name = Path("tests/radau/libradau_test.so")
    candidates = [Path(named)] if named else [ROOT / "build" / b / name for b in ("ci", "debug")]
    for candidate in candidates:
        if candidate.is_file():
            return Library(candidate)
    looked = ", ".join(map(str, candidates))
    pytest.fail(
        f"{name.name} is not built (looked for {looked}); run ./runtests, or configure with "
        "-DEVOLVENT_TESTS=ON, or set EVOLVENT_RADAU_LIBRARY",
        pytrace=False,
    )
