"""Campbell diagram: intersections of the orders of a gearbox with its natural frequencies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]


@dataclass(frozen=True)
class Excitation:
    """A line through the origin: an order of a mesh or a wheel."""

    kind: str  # "mesh" or "wheel"
    name: str
    order: int
    per_turn: float  # periods per revolution of the wheel on the speed axis, at order 1

    def frequency(self, speed: Numbers) -> Numbers:
        """Frequency [Hz] at speeds [rad/s]."""
        return np.asarray(self.order * self.per_turn * speed / (2 * np.pi))

    def __str__(self) -> str:
        return f"{self.order} x {self.kind} {self.name}"


@dataclass(frozen=True)
class Crossing:
    """A speed at which an order meets a mode."""

    speed: float  # [rad/s]
    mode: int  # from 0, by frequency
    excitation: int  # index
    frequency: float  # [Hz]


def crossings(speed: Numbers, frequency: Numbers, excitations: list[Excitation]) -> list[Crossing]:
    """Find the intersections of orders and modes, sorted by speed.

    Parameters
    ----------
    speed : increasing [rad/s]; natural frequencies are linear between two speeds.
    frequency : natural frequencies [Hz], dims (speed, mode), NaN if there is none.
    excitations : the orders.
    """
    found = []
    for mode in range(frequency.shape[1]):
        natural = frequency[:, mode]
        for index, excitation in enumerate(excitations):
            difference = excitation.frequency(speed) - natural
            for i in range(speed.size - 1):
                a, b = difference[i], difference[i + 1]
                last = i == speed.size - 2 and b == 0.0
                if not (a * b < 0 or a == 0.0 or last):  # NaN: no crossing
                    continue
                share = 0.0 if a == b else a / (a - b)
                at = float(speed[i] + share * (speed[i + 1] - speed[i]))
                there = float(excitation.frequency(np.array(at)))
                found.append(Crossing(at, mode, index, there))
    return sorted(found, key=lambda crossing: (crossing.speed, crossing.mode))
