"""Independent oscillator with rectangular mesh stiffness: closed forms from event to event.

Time in units of one over the frequency of one tooth pair, deflection in units of F/k. While pairs
carry load, x'' + 2 z n x' + n x = 1 with n = 1 or 2 of them, else x'' = 1. They separate when their
force falls to zero. They touch again when x becomes positive or, if it stays positive, when the
force returns.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise

import numpy as np

RATIO, DAMPING = 1.638, 0.03  # contact ratio; damping ratio of a pair
WINDOW = 64  # pitches over which a non-periodic motion is evaluated
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


class Oscillator:
    """State integrated from event to event; a pitch starts when the second pair enters."""

    def __init__(self) -> None:
        self.x, self.v, self.touches = 0.6, 0.0, True

    def pitch(
        self, omega: float, position: float, pieces: list[tuple[float, ...]] | None = None
    ) -> None:
        """Integrate from a position in a pitch to the same position in the next one.

        omega: over the frequency of the mean stiffness.
        """
        length = 2 * math.pi / (omega * math.sqrt(RATIO))
        ends = sorted(
            {
                position,
                1 + position,
                1.0,
                *(b for b in (RATIO - 1, RATIO) if position < b < 1 + position),
            }
        )
        for begin, end in pairwise(ends):
            pairs = 2 if (begin + end) / 2 % 1 < RATIO - 1 else 1
            left = (end - begin) * length
            while left > 0:
                start = (float(pairs), self.x, self.v, float(self.touches))
                passed = self._carry(pairs, left) if self.touches else self._fly(left)
                if pieces is not None:
                    pieces.append((passed, *start))
                left -= passed

    def _carry(self, pairs: int, left: float) -> float:
        """Integrate with contact: x - 1/n = exp(-d t) (a cos w t + b sin w t)."""
        d, w, a, b = _constants(pairs, self.x, self.v)
        # of the force over n
        c, s = a + 2 * DAMPING * self.v, b - 2 * DAMPING * (w * a + d * b)

        def force(t: float) -> float:
            turned = c * math.cos(w * t) + s * math.sin(w * t)
            return 1 / pairs + math.exp(-d * t) * turned

        passed, parts = left, False
        if math.hypot(c, s) > 1 / pairs:
            turn = (
                math.atan2(w * s - d * c, w * c + d * s) % math.pi / w
            )  # the extrema of the force are half a cycle apart
            low = 0.0
            for k in range(math.ceil(left * w / math.pi) + 2):
                high = min(turn + k * math.pi / w, left)
                if force(high) < 0 and high > 1e-12:
                    passed, parts = _bisect(force, low, high), True
                    break
                low = high
        e, cos, sin = math.exp(-d * passed), math.cos(w * passed), math.sin(w * passed)
        self.x, self.v = (
            1 / pairs + e * (a * cos + b * sin),
            e * ((w * b - d * a) * cos - (w * a + d * b) * sin),
        )
        self.touches = not parts
        return passed

    def _fly(self, left: float) -> float:
        """Integrate without contact."""
        x, v = self.x, self.v
        clear = v**2 >= 2 * x
        if not clear:  # of x + 2 z v
            x, v = x + 2 * DAMPING * v, v + 2 * DAMPING
        t = -v + math.sqrt(max(v**2 - 2 * x, 0.0))
        self.touches, passed = t <= left, min(t, left)
        self.x = 0.0 if clear and self.touches else self.x + self.v * passed + passed**2 / 2
        self.v += passed
        return passed

    def settle(self, omega: float, position: float, most: int = 600) -> int:
        """Integrate until the motion repeats. @return number of pitches; 0: not within `most`."""
        seen: list[tuple[float, float]] = []
        for _ in range(most):
            self.pitch(omega, position)
            seen.append((self.x, self.v))
            for period in (1, 2, 4, 8):
                if len(seen) > 2 * period and all(
                    _near(seen[-1 - k * period], seen[-1 - (k + 1) * period]) for k in (0, 1)
                ):
                    return period
        return 0

    def deviation(self, omega: float, position: float, pitches: int) -> float:
        """Standard deviation of x over the next pitches."""
        pieces: list[tuple[float, ...]] = []
        for _ in range(pitches):
            self.pitch(omega, position, pieces)
        moments = np.zeros(3)
        for passed, pairs, x, v, touches in pieces:
            t = passed * (1 + NODES) / 2
            if touches:
                d, w, a, b = _constants(int(pairs), x, v)
                values = 1 / pairs + np.exp(-d * t) * (a * np.cos(w * t) + b * np.sin(w * t))
            else:
                values = x + v * t + t**2 / 2
            moments += [passed / 2 * float(WEIGHTS @ values**k) for k in range(3)]
        mean, square = moments[1:] / moments[0]
        return math.sqrt(square - mean**2)

    def follow(
        self, values: Iterable[float], position: float, pitches: int = 0
    ) -> Iterator[tuple[float, float]]:
        """Sweep over frequencies, and return the deviation at each; see `falls`."""
        for omega in values:
            for _ in range(pitches - WINDOW):
                self.pitch(omega, position)
            window = WINDOW if pitches else self.settle(omega, position) or WINDOW
            yield omega, self.deviation(omega, position, window)


def _constants(pairs: int, x: float, v: float) -> tuple[float, float, float, float]:
    d = DAMPING * pairs
    w = math.sqrt(pairs - d**2)
    a = x - 1 / pairs
    return d, w, a, (v + d * a) / w


def _bisect(f: Callable[[float], float], low: float, high: float) -> float:
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (low, middle) if f(middle) < 0 else (middle, high)
    return high


def _near(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return all(abs(p - q) < 1e-9 * (1 + abs(p)) for p, q in zip(a, b, strict=True))


def falls(
    values: Iterable[float], position: float, pitches: int = 0, motion: Oscillator | None = None
) -> list[tuple[float, float, float]]:
    """Sweep over frequencies, with each step at the same position of the pitch.

    pitches: at each frequency, independent of the motion; 0: until it repeats.
    Returns frequencies between which the deviation falls by more than a quarter, and its new value.
    """
    motions = (motion or Oscillator()).follow(values, position, pitches)
    return [(a, b, after) for (a, before), (b, after) in pairwise(motions) if after < before / 1.3]


def steps(first: float, last: float, step: float = 0.005) -> list[float]:
    """Frequencies from one value down to another."""
    return [round(first - k * step, 6) for k in range(round((first - last) / step) + 1)]
