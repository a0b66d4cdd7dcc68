"""Sidebands: modulation of the mesh orders by the rotation of a wheel."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

import numpy as np

from evolvent.errors import USAGE, HistoryError
from evolvent.signals.sampling import Record
from evolvent.signals.turning import Turning, ratio

WORST = 100.0  # condition number of a fit: amplification of contents outside its lines


@dataclass(frozen=True)
class Sideband:
    """A pair of lines beside a mesh order."""

    mesh_order: int  # n, the carrier
    wheel: str
    wheel_order: int  # k: the lines are k orders of the wheel beside the carrier
    spacing: float  # of the lines from the carrier, in orders of the mesh: k/z
    carrier: complex  # A exp(-i phase)
    lower: complex
    upper: complex

    @property
    def amplitude_modulation(self) -> float:
        """Index m of A (1 + m cos(2 pi k u - psi)) cos(2 pi n xi - phase).

        With p = (line over carrier): m = |p_upper + conj(p_lower)|. Equation S3.
        """
        return abs(self.upper / self.carrier + (self.lower / self.carrier).conjugate())

    @property
    def phase_modulation(self) -> float:
        """Index b of A cos(2 pi n xi - phase + b cos(2 pi k u - psi)) [rad].

        |p_upper - conj(p_lower)|, 2 J_1(b)/J_0(b): b itself to the second order. Equation S3.
        """
        return abs(self.upper / self.carrier - (self.lower / self.carrier).conjugate())


def sidebands(
    record: Record, label: str, wheels: list[Turning], mesh: Turning, n: int, k: int
) -> list[Sideband]:
    """Compute sidebands 1..k of each wheel beside the mesh orders 1..n.

    All these lines, the mean, order n + 1 and the first k orders of the wheels are fitted
    simultaneously, so that no line leaks into another, for any length of the record.

    Parameters
    ----------
    record : over the mesh, of whole pitches.

    Raises
    ------
    HistoryError
        Sidebands extend beyond half a mesh order and meet those of the next one, or the record is
        too short to distinguish the lines of the wheels.
    """
    spacings = {wheel.name: ratio(wheel, mesh) for wheel in wheels}
    for wheel in wheels:
        spacing = spacings[wheel.name]
        if k * spacing * 2 >= 1:
            raise HistoryError(
                f"{label}: {k} sidebands of {wheel} reach those of the next mesh order; choose at "
                f"most {(spacing.denominator - 1) // 2 // spacing.numerator} by --sides",
                USAGE,
            )
    sides = {s * i for s in spacings.values() for i in range(1, k + 1)}
    orders = {Fraction(order) for order in range(1, n + 2)} | sides
    orders |= {order + sign * s for order in range(1, n + 1) for s in sides for sign in (-1, 1)}
    ordered = sorted(orders)
    lines, condition = fitted(record, [float(order) for order in ordered])
    if condition > WORST:
        closest = min(b - a for a, b in pairwise(ordered))
        raise HistoryError(
            f"{label}: {record.periods:.4g} pitches are too few to separate lines that are "
            f"{float(closest):.3g} mesh orders from each other; run the case for "
            f"{math.ceil(1 / closest)} pitches, or choose fewer with --sides",
            USAGE,
        )
    line = dict(zip(ordered, lines, strict=True))
    return [
        Sideband(
            order,
            name,
            side,
            float(side * spacing),
            line[Fraction(order)],
            line[order - side * spacing],
            line[order + side * spacing],
        )
        for name, spacing in spacings.items()
        for order in range(1, n + 1)
        for side in range(1, k + 1)
    ]


def fitted(record: Record, orders: list[float]) -> tuple[list[complex], float]:
    """Fit lines A exp(-i phase) and the mean by least squares; return the condition number, too.

    The normal equations of c_0 + sum (c_k exp(i a_k) + its conjugate)/2, whose sums over
    equidistant samples are geometric series.
    """
    n, step = record.values.size, record.step
    both = np.array([0.0, *orders, *(-order for order in orders)])
    apart = both[None, :] - both[:, None]
    turn = np.exp(2j * math.pi * step * apart)
    whole = np.exp(2j * math.pi * step * n * apart)
    same = np.eye(both.size, dtype=bool)
    gram = np.where(same, 1.0, (whole - 1) / np.where(same, 1.0, n * (turn - 1)))
    s = step * np.arange(n)
    measured = [np.exp(-2j * math.pi * order * s) @ record.values / n for order in both]
    solved = np.linalg.solve(gram, np.array(measured))[1 : 1 + len(orders)]
    shift = np.exp(-2j * math.pi * np.array(orders) * record.first)
    return [complex(line) for line in 2.0 * solved * shift], float(np.linalg.cond(gram))


def phase(line: complex) -> float:
    """Phase of a line, as in A cos(2 pi n xi - phase) [rad]."""
    return -cmath.phase(line)
