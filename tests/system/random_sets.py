"""Seeds of the random sets of cases: some in every run, all of them with --long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def seeds(always: Iterable[int], n: int, without: Iterable[int] = ()) -> list[Any]:
    """Return the first n seeds as parameters; those not in `always` are marked `long`."""
    short = sorted(set(always))
    rest = [seed for seed in range(n) if seed not in {*short, *without}]
    return [*short, *(pytest.param(seed, marks=pytest.mark.long) for seed in rest)]
