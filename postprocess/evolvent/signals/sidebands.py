"""Sidebands: what the turning of a wheel does to the lines of its mesh."""

from __future__ import annotations

import cmath
from dataclasses import dataclass

from evolvent.errors import USAGE, HistoryError
from evolvent.signals.sampling import Record
from evolvent.signals.spectrum import line_at
from evolvent.signals.turning import Turning, ratio
from evolvent.signals.windows import window


@dataclass(frozen=True)
class Sideband:
    """A pair of lines beside a mesh order."""

    mesh_order: int  # n, the carrier
    wheel: str
    wheel_order: int  # k: the lines stand k orders of the wheel beside the carrier
    spacing: float  # of the lines from the carrier, in orders of the mesh: k/z
    carrier: complex  # A exp(-i phase)
    lower: complex
    upper: complex

    @property
    def amplitude_modulation(self) -> float:
        """m of A (1 + m cos(2 pi k u - psi)) cos(2 pi n xi - phase).

        With p = (line over carrier): m = |p_upper + conj(p_lower)|.
        """
        return abs(self.upper / self.carrier + (self.lower / self.carrier).conjugate())

    @property
    def phase_modulation(self) -> float:
        """b of A cos(2 pi n xi - phase + b cos(2 pi k u - psi)) [rad].

        |p_upper - conj(p_lower)|, 2 J_1(b)/J_0(b): b itself to the second order.
        """
        return abs(self.upper / self.carrier - (self.lower / self.carrier).conjugate())


def sidebands(
    records: dict[str, Record], wheels: list[Turning], mesh: Turning, n: int, k: int, name: str
) -> list[Sideband]:
    """Sidebands 1..k of each wheel beside the mesh orders 1..n.

    Parameters
    ----------
    records : by the name of the wheel, over the mesh and of whole turns of the wheel, so that its
        lines and those of the mesh leak into none of each other.
    name : of the window.

    Raises
    ------
    HistoryError
        Lines of more than half a mesh order meet those of the next one.
    """
    found = []
    for wheel in wheels:
        record = records[wheel.name]
        spacing = ratio(wheel, mesh)
        weights = window(name, record.values.size)
        if k * spacing * 2 >= 1:
            raise HistoryError(
                f"{k} sidebands of {wheel} reach those of the next mesh order; "
                f"choose at most {(spacing.denominator - 1) // 2 // spacing.numerator} by --sides",
                USAGE,
            )

        def line(place: float, record: Record = record, weights=weights) -> complex:  # type: ignore[no-untyped-def]
            return line_at(record.values, record.first, record.step, weights, place)

        for order in range(1, n + 1):
            carrier = line(float(order))
            for side in range(1, k + 1):
                apart = float(side * spacing)
                found.append(
                    Sideband(
                        order,
                        wheel.name,
                        side,
                        apart,
                        carrier,
                        line(order - apart),
                        line(order + apart),
                    )
                )
    return found


def phase(line: complex) -> float:
    """Phase of a line, as in A cos(2 pi n xi - phase) [rad]."""
    return -cmath.phase(line)
