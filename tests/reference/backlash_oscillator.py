"""An oscillator with backlash, solved on its own: one tooth pair, one wheel at prescribed speed.

m x'' = p(t) - F(x, x') + F(y, y'), y = -x - j: x is the penetration of one flank and y that of the
other, j the backlash, p a triangle wave about a mean. F = max(k x + c x', 0) where x > 0, else 0.
Integrated piece by piece between the knots of p and the changes of contact, which are located.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

Floats = NDArray[np.float64]
FREE, PUSHING, CLIPPED = range(3)  # apart; loaded; overlapping, but the damper would pull


@dataclass(frozen=True)
class Oscillator:
    """Parameters in SI units."""

    mass: float
    stiffness: float
    damping: float
    backlash: float
    mean: float  # of p [N]
    amplitude: float  # of its triangle wave [N]
    period: float  # [s]

    def knots(self, periods: int) -> tuple[Floats, Floats]:
        """Times and values of the corners of p: it starts at its largest."""
        n = np.arange(2 * periods + 1)
        return n * self.period / 2, self.mean + self.amplitude * (-1.0) ** n


@dataclass
class Solution:
    """Penetration at given times, and when contact opened and closed."""

    x: Floats
    opened: list[float]
    closed: list[float]


@dataclass(frozen=True)
class Piece:
    """Motion between two changes, in units of the static penetration and natural frequency."""

    damping: float  # twice the damping ratio
    backlash: float
    load: tuple[float, float]  # p at the ends of `span`
    span: tuple[float, float]
    mode: int
    flank: int  # +1: x, -1: y

    def depth(self, z: Floats) -> tuple[float, float]:
        """Penetration of the flank in contact, and its rate."""
        return (z[0], z[1]) if self.flank > 0 else (-z[0] - self.backlash, -z[1])

    def rates(self, tau: float, z: Floats) -> Floats:
        """Return x' and x''."""
        (p_0, p_1), (start, end) = self.load, self.span
        p = p_0 + (p_1 - p_0) * (tau - start) / (end - start)
        push = self.force(tau, z) if self.mode == PUSHING else 0.0
        return np.array([z[1], p - self.flank * push])

    def force(self, _: float, z: Floats) -> float:
        """Force without the clip."""
        h, v = self.depth(z)
        return h + self.damping * v

    def events(self) -> dict[str, Any]:
        """What can end it, and in which direction it passes zero."""
        if self.mode == FREE:
            found = {
                "x": (lambda _, z: z[0], 1),
                "y": (lambda _, z: -z[0] - self.backlash, 1),
            }
        else:
            found = {
                "apart": (lambda _, z: self.depth(z)[0], -1),
                "clip": (lambda tau, z: self.force(tau, z), -1 if self.mode == PUSHING else 1),
            }
        for function, direction in found.values():
            function.terminal, function.direction = True, direction  # type: ignore[attr-defined]
        return {name: function for name, (function, _) in found.items()}


def solve(o: Oscillator, periods: int, times: Floats) -> Solution:
    """From rest at x = mean/stiffness."""
    unit, frequency = o.mean / o.stiffness, np.sqrt(o.stiffness / o.mass)
    corners, forces = o.knots(periods)
    found = Solution(np.full(len(times), np.nan), [], [])
    state, mode, flank, t = np.array([1.0, 0.0]), PUSHING, 1, 0.0
    taus = times * frequency
    loads, spans = pairwise(forces / o.mean), pairwise(corners * frequency)
    for load, span in zip(loads, spans, strict=True):
        while t < span[1]:
            piece = Piece(
                o.damping / (o.mass * frequency), o.backlash / unit, load, span, mode, flank
            )
            events = piece.events()
            way = solve_ivp(
                piece.rates,
                (t, span[1]),
                state,
                method="DOP853",
                events=list(events.values()),
                dense_output=True,
                rtol=1e-11,
                atol=1e-13,
            )
            here = (taus >= t) & (taus <= way.t[-1])
            if here.any():
                found.x[here] = unit * way.sol(taus[here])[0]
            t, state = way.t[-1], way.y[:, -1]
            if way.status != 1:
                break
            fired = [name for name, at in zip(events, way.t_events, strict=True) if len(at)]
            match fired[0]:
                case "clip":
                    mode = CLIPPED if mode == PUSHING else PUSHING
                case "apart":
                    mode = FREE
                    found.opened.append(t / frequency)
                case side:
                    mode, flank = PUSHING, 1 if side == "x" else -1
                    found.closed.append(t / frequency)
    return found
