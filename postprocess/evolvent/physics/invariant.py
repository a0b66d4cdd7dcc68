"""Rows of the table of invariants."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from evolvent.history.recording import Part, Recording, Values


@dataclass(frozen=True)
class Deviation:
    """Deviation of a history from an invariant, over its natural scale."""

    dims: tuple[str, ...]  # with `time`, if it is evaluated part by part
    values: Callable[[Part], Values] | Values
    # Names along the dimensions that are not those of the history.
    names: Mapping[str, Sequence[str]] = field(default_factory=dict)


DEPTH = "penetration"  # the larger of the maximum and the reference penetration


@dataclass(frozen=True)
class Invariant:
    """One row of the table."""

    name: str
    formula: str  # text, as in docs/theory/theory.md
    relative_to: str
    least_bound: float
    deviation: Callable[[Recording], Deviation]
    tolerances: float = 0.0  # minimum ratio of the bound to the tolerance of the case

    def bound(self, tolerance: float) -> float:
        """Largest deviation of a correct run with that tolerance."""
        return max(self.least_bound, self.tolerances * tolerance)


INVARIANTS: list[Invariant] = []


def invariant(
    name: str, formula: str, relative_to: str, least_bound: float, tolerances: float = 0.0
) -> Callable[[Callable[[Recording], Deviation]], Callable[[Recording], Deviation]]:
    """Register a function in the table."""

    def put(deviation: Callable[[Recording], Deviation]) -> Callable[[Recording], Deviation]:
        INVARIANTS.append(Invariant(name, formula, relative_to, least_bound, deviation, tolerances))
        return deviation

    return put


def of_some(run: Recording, dim: str, which: Values) -> dict[str, list[str]]:
    """Names of the selected meshes or wheels."""
    return {dim: [name for name, selected in zip(run.labels(dim), which, strict=True) if selected]}
