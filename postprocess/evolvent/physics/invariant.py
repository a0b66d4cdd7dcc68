"""The rows of the table of invariants: what each of them is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from evolvent.history.recording import Part, Recording, Values


@dataclass(frozen=True)
class Deviation:
    """How far a history is from what should be, over its natural scale."""

    dims: tuple[str, ...]  # with `time`, if it is found part by part
    values: Callable[[Part], Values] | Values
    # Names along the dimensions that are not those of the history.
    names: Mapping[str, Sequence[str]] = field(default_factory=dict)


DEPTH = "penetration"  # the largest or the reference one, whichever is larger


@dataclass(frozen=True)
class Invariant:
    """One line of the table."""

    name: str
    formula: str  # text, as in docs/theory.md
    relative_to: str
    least_bound: float
    deviation: Callable[[Recording], Deviation]
    tolerances: float = 0.0  # the bound is at least so many times the tolerance of the case

    def bound(self, tolerance: float) -> float:
        """Largest deviation of a right run with that tolerance."""
        return max(self.least_bound, self.tolerances * tolerance)


INVARIANTS: list[Invariant] = []


def invariant(
    name: str, formula: str, relative_to: str, least_bound: float, tolerances: float = 0.0
) -> Callable[[Callable[[Recording], Deviation]], Callable[[Recording], Deviation]]:
    """Put a function into the table."""

    def put(deviation: Callable[[Recording], Deviation]) -> Callable[[Recording], Deviation]:
        INVARIANTS.append(Invariant(name, formula, relative_to, least_bound, deviation, tolerances))
        return deviation

    return put


def of_some(run: Recording, dim: str, which: Values) -> dict[str, list[str]]:
    """Names of some of the meshes or wheels."""
    return {dim: [name for name, kept in zip(run.labels(dim), which, strict=True) if kept]}
