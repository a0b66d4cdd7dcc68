"""Problems with solutions in closed form, after DETEST, and the stiff ones of the literature.

Sources: T. E. Hull, W. H. Enright, B. M. Fellen, A. E. Sedgwick, SIAM J. Numer. Anal. 9 (1972)
603-637 (A1 to A4, C1, D1 to D5); E. Hairer, G. Wanner, Solving Ordinary Differential Equations
II, 2nd ed., IV.10.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipk

from integrator.radau import Problem

Floats = NDArray[np.float64]


class Solved(NamedTuple):
    """A problem and its solution from 0 to end."""

    problem: Problem
    end: float
    solution: Callable[[float], ArrayLike]


def decay() -> Solved:
    """DETEST A1."""
    return Solved(Problem(lambda t, y: -y, lambda t, y: -1, [1]), 20, lambda t: [np.exp(-t)])


def cubic_decay() -> Solved:
    """DETEST A2."""
    problem = Problem(lambda t, y: -(y**3) / 2, lambda t, y: -3 * y**2 / 2, [1])
    return Solved(problem, 20, lambda t: [1 / np.sqrt(1 + t)])


def oscillating_growth() -> Solved:
    """DETEST A3: the right-hand side depends on time."""
    problem = Problem(lambda t, y: y * np.cos(t), lambda t, y: np.cos(t), [1])
    return Solved(problem, 20, lambda t: [np.exp(np.sin(t))])


def logistic() -> Solved:
    """DETEST A4."""
    problem = Problem(lambda t, y: y / 4 * (1 - y / 20), lambda t, y: 0.25 - y / 40, [20])
    return Solved(problem, 20, lambda t: [20 / (1 + 19 * np.exp(-t / 4))])


def radioactive_chain() -> Solved:
    """DETEST C1: ten substances, each decays into the next; Poisson's distribution."""

    def f(t: float, y: Floats) -> Floats:
        rate = -y
        rate[1:] += y[:-1]
        rate[9] = y[8]
        return rate

    entries = [(i, i) for i in range(9)] + [(i + 1, i) for i in range(9)]
    problem = Problem(f, lambda t, y: [-1] * 9 + [1] * 9, [1] * 10, entries=entries)

    def solution(t: float) -> Floats:
        factorials = np.cumprod([1, *range(1, 9)])
        first = np.exp(-t) * t ** np.arange(9) / factorials
        return np.append(first, 1 - first.sum())

    return Solved(problem, 20, solution)


def orbit(eccentricity: float) -> Solved:
    """DETEST D1 to D5: a Kepler orbit, eccentricity 0.1 to 0.9."""
    e = eccentricity

    def f(t: float, y: Floats) -> list[float]:
        cube = np.hypot(y[0], y[1]) ** 3
        return [y[2], y[3], -y[0] / cube, -y[1] / cube]

    def jacobian(t: float, y: Floats) -> list[float]:
        r = np.hypot(y[0], y[1])
        a, b = -1 / r**3, 3 / r**5
        return [1, 1, a + b * y[0] ** 2, b * y[0] * y[1], b * y[0] * y[1], a + b * y[1] ** 2]

    def solution(t: float) -> list[float]:
        angle = t
        for _ in range(50):  # Kepler's equation by Newton
            angle -= (angle - e * np.sin(angle) - t) / (1 - e * np.cos(angle))
        c, s, root = np.cos(angle), np.sin(angle), np.sqrt(1 - e**2)
        speed = 1 / (1 - e * c)
        return [c - e, root * s, -speed * s, speed * root * c]

    entries = [(0, 2), (1, 3), (2, 0), (2, 1), (3, 0), (3, 1)]
    fastest = np.sqrt((1 + e) / (1 - e))
    problem = Problem(f, jacobian, [1 + e, 1 + e, fastest, fastest], entries=entries)
    return Solved(problem, 20, solution)


def pendulum(amplitude: float = 2.5) -> Solved:
    """Swing freely from rest: Jacobi's elliptic functions."""
    k = np.sin(amplitude / 2)
    problem = Problem(
        lambda t, y: [y[1], -np.sin(y[0])],
        lambda t, y: [1, -np.cos(y[0])],
        [amplitude, 2 * k],
        entries=[(0, 1), (1, 0)],
    )

    def solution(t: float) -> list[float]:
        sn, cn, _, _ = ellipj(ellipk(k**2) - t, k**2)
        return [2 * np.arcsin(k * sn), -2 * k * cn]

    return Solved(problem, 20, solution)


def attracted(rate: float = 1e6) -> Solved:
    """Prothero and Robinson: y' = -rate (y - cos t) - sin t, stiff; the solution is cos t."""
    problem = Problem(lambda t, y: -rate * (y - np.cos(t)) - np.sin(t), lambda t, y: -rate, [1])
    return Solved(problem, 20, lambda t: [np.cos(t)])


def whirl(frequency: float) -> Solved:
    """An undamped rotation about (cos t, sin t): a Jacobian with nothing on its diagonal."""
    w = frequency

    def f(t: float, y: Floats) -> list[float]:
        c, s = np.cos(t), np.sin(t)
        return [w * (y[1] - s) - s, -w * (y[0] - c) + c]

    problem = Problem(f, lambda t, y: [w, -w], [1, 1], entries=[(0, 1), (1, 0)])
    return Solved(problem, 20, lambda t: [np.cos(t), np.sin(t)])


SOLVED = {
    "A1": decay(),
    "A2": cubic_decay(),
    "A3": oscillating_growth(),
    "A4": logistic(),
    "C1": radioactive_chain(),
    **{f"D{i}": orbit(e) for i, e in zip(itertools.count(1), (0.1, 0.3, 0.5, 0.7, 0.9))},
    "pendulum": pendulum(),
    "stiff": attracted(),
}
