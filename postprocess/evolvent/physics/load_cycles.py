"""Load cycles of a signal: turning points, rainflow counting, and damage by an S-N line.

Equations and sources: docs/theory/load_spectra.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

Values = NDArray[np.float64]


@dataclass(frozen=True)
class Cycles:
    """Counted cycles of a signal, in its unit."""

    ranges: Values  # largest minus least value of each cycle
    means: Values
    counts: Values  # 1 for a cycle, 0.5 for a half cycle

    @property
    def largest(self) -> float:
        """Largest range; 0 without cycles."""
        return float(self.ranges.max(initial=0.0))


def turning_points(values: ArrayLike) -> Values:
    """Local extremes of a sequence, with its first and last value; equal neighbours count once."""
    x = np.asarray(values, dtype=float)
    x = x[np.append(True, np.diff(x) != 0.0)] if x.size else x
    if x.size < 3:
        return x
    is_turn = np.diff(x)[:-1] * np.diff(x)[1:] < 0.0
    return np.asarray(x[np.concatenate([[True], is_turn, [True]])])


def repeating(values: ArrayLike) -> Values:
    """Turning points of one period of a repeating history, from its largest value to that value.

    The count of cycles then does not depend on where the period is cut. Equation LS3.
    """
    x = np.asarray(values, dtype=float)
    first = int(np.argmax(x))
    return turning_points(np.concatenate([x[first:], x[: first + 1]]))


def count_cycles(values: ArrayLike, *, repeats: bool) -> Cycles:
    """Count the cycles of a signal by the rainflow method of ASTM E1049-85, section 5.4.4.

    Parameters
    ----------
    values : in order of time; only their turning points count.
    repeats : the values are one period of a repeating history, which has no residue. Otherwise
        half cycles remain for the residue.
    """
    from rainflow import extract_cycles

    points = repeating(values) if repeats else turning_points(values)
    if points.size < 2:
        return Cycles(*np.zeros((3, 0)))
    if points.size == 2:  # the package counts none between two points
        ranges, means = abs(points[1] - points[0]), points.mean()
        return Cycles(np.array([ranges]), np.array([means]), np.array([0.5]))
    found = np.array([cycle[:3] for cycle in extract_cycles(points.tolist())])
    return Cycles(found[:, 0], found[:, 1], found[:, 2])


@dataclass(frozen=True)
class SNLine:
    """S-N line: cycles to failure over the stress of constant cycles, linear in logarithms."""

    stresses: Values  # decreasing, of the points [Pa]
    cycles: Values  # to failure, at the points
    slope_above: float  # k of N ~ stress^-k above the first point
    slope_below: float  # below the last point; infinite: no damage there
    is_range: bool  # the stresses are ranges; else amplitudes

    def cycles_to_failure(self, ranges: ArrayLike) -> Values:
        """Cycles to failure under cycles of these stress ranges [Pa]. Equation LS4."""
        stress = np.asarray(ranges, dtype=float) * (1.0 if self.is_range else 0.5)
        with np.errstate(divide="ignore"):
            x = np.log(stress)
        at, log_n = np.log(self.stresses[::-1]), np.log(self.cycles[::-1])
        between = np.interp(x, at, log_n)
        above = log_n[-1] - self.slope_above * (x - at[-1])
        below = np.where(x < at[0], np.inf, log_n[0])
        if np.isfinite(self.slope_below):
            below = log_n[0] - self.slope_below * (x - at[0])
        with np.errstate(over="ignore"):
            return np.exp(np.where(x > at[-1], above, np.where(x < at[0], below, between)))

    def damage(self, cycles: Cycles) -> float:
        """Miner sum of counted cycles. Equation LS5."""
        return float(np.sum(cycles.counts / self.cycles_to_failure(cycles.ranges)))


def sn_line(given: Mapping[str, Any]) -> SNLine:
    """S-N line of the block `sn` of a material, with its stresses in Pa."""
    below = given["slope_below"]

    def numbers(values: Sequence[Any]) -> Values:
        return np.array([float(value) for value in values])

    return SNLine(
        stresses=numbers(given["stress"]),
        cycles=numbers(given["cycles"]),
        slope_above=float(given["slope_above"]),
        slope_below=np.inf if below == "none" else float(below),
        is_range=given["stress_type"] == "range",
    )
