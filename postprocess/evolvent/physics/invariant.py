"""The rows of the table of invariants: what each of them is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import xarray as xr

Deviation = Callable[[xr.Dataset], xr.DataArray]
DEPTH = "penetration"  # the largest or the reference one, whichever is larger


@dataclass(frozen=True)
class Invariant:
    """One line of the table."""

    name: str
    formula: str  # text, as in docs/theory.md
    relative_to: str
    least_bound: float
    deviation: Deviation
    tolerances: float = 0.0  # the bound is at least so many times the tolerance of the case

    def bound(self, tolerance: float) -> float:
        """Largest deviation of a right run with that tolerance."""
        return max(self.least_bound, self.tolerances * tolerance)


INVARIANTS: list[Invariant] = []


def invariant(
    name: str, formula: str, relative_to: str, least_bound: float, tolerances: float = 0.0
) -> Callable[[Deviation], Deviation]:
    """Put a function into the table."""

    def put(deviation: Deviation) -> Deviation:
        INVARIANTS.append(Invariant(name, formula, relative_to, least_bound, deviation, tolerances))
        return deviation

    return put
