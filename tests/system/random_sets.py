"""Seeds of the random sets of cases: some always, all of them with --long."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def seeds(always: Iterable[int], n: int, without: Iterable[int] = ()) -> list[Any]:
    """Give the first n seeds as parameters, those that are not tested `always` marked `long`."""
    short = sorted(set(always))
    rest = [seed for seed in range(n) if seed not in {*short, *without}]
    return [*short, *(pytest.param(seed, marks=pytest.mark.long) for seed in rest)]
