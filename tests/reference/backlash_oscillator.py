"""An oscillator with backlash, solved on its own: one tooth pair, one wheel at prescribed speed.

m x'' = p(t) - F(x, x') + F(y, y'), y = -x - j: x is the penetration of one flank and y that of the
other, j the backlash, p a triangle wave about a mean. F = max(k x + c x', 0) where x > 0, else 0.
Integrated piece by piece between the knots of p and the changes of contact, which are located.
"""

from __future__ import annotations

from dataclasses import dataclass
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


def solve(o: Oscillator, periods: int, times: Floats) -> Solution:
    """From rest at x = mean/stiffness."""
    # in units of the static penetration and of the natural frequency
    unit, frequency = o.mean / o.stiffness, np.sqrt(o.stiffness / o.mass)
    zeta2, gap = o.damping / (o.mass * frequency), o.backlash / unit
    corners, forces = o.knots(periods)
    found = Solution(np.full(len(times), np.nan), [], [])
    state, mode, t = np.array([1.0, 0.0]), PUSHING, 0.0
    flank = 1  # +1: x, -1: y
    taus = times * frequency
    for (t_0, t_1), (p_0, p_1) in zip(
        zip(corners[:-1], corners[1:], strict=True),
        zip(forces[:-1], forces[1:], strict=True),
        strict=True,
    ):
        start, end = t_0 * frequency, t_1 * frequency
        while t < end:

            def depth(z: Floats, side: int = flank) -> tuple[float, float]:
                return (z[0], z[1]) if side > 0 else (-z[0] - gap, -z[1])

            def rates(tau: float, z: Floats, mode: int = mode, side: int = flank) -> Floats:
                p = (p_0 + (p_1 - p_0) * (tau - start) / (end - start)) / o.mean
                h, v = depth(z)
                push = h + zeta2 * v if mode == PUSHING else 0.0
                return np.array([z[1], p - side * push])

            events: dict[str, Any] = {}
            if mode == FREE:
                events["x"] = (lambda tau, z: z[0], 1)
                events["y"] = (lambda tau, z: -z[0] - gap, 1)
            else:
                events["apart"] = (lambda tau, z: depth(z)[0], -1)
                direction = -1 if mode == PUSHING else 1
                events["clip"] = (lambda tau, z: depth(z)[0] + zeta2 * depth(z)[1], direction)
            functions = []
            for function, direction in events.values():
                function.terminal, function.direction = True, direction
                functions.append(function)
            piece = solve_ivp(
                rates, (t, end), state, method="DOP853", events=functions, dense_output=True,
                rtol=1e-11, atol=1e-13,
            )
            here = (taus >= t) & (taus <= piece.t[-1])
            if here.any():
                found.x[here] = unit * piece.sol(taus[here])[0]
            t, state = piece.t[-1], piece.y[:, -1]
            if piece.status != 1:
                break
            fired = [name for name, at in zip(events, piece.t_events, strict=True) if len(at)]
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
