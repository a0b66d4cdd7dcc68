"""Stiff problems of the literature and their solutions, for the tests of the integrator.

The problems are those of E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd
ed., IV.10: van der Pol with 1/epsilon = 1e6 in the scaled form, Robertson, and HIRES.

The solutions were recorded from this script: scipy's Radau (order 5) with a relative tolerance of
1e-13 (scipy 1.17.1, IEEE double). scipy's LSODA at 1e-12, an independent method, differs by 2e-11
of a component at most: the recorded digits are good to about that. The values for van der Pol
and HIRES agree to that with F. Mazzia, C. Magherini, Test Set for Initial Value Problem Solvers
(2008). Run it as ``python tests/reference/stiff_problems.py`` (a minute).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class StiffProblem(NamedTuple):
    """y' = f(t, y), y(0) = start, y(end) = solution."""

    f: Callable[[float, NDArray[Any]], Any]
    jacobian: Callable[[float, NDArray[Any]], Any]
    start: tuple[float, ...]
    end: float
    scale: tuple[float, ...]  # size of each component, the unit of its error
    solution: tuple[float, ...]


EPSILON = 1e-6


def van_der_pol(t: float, y: NDArray[Any]) -> list[float]:
    return [y[1], ((1 - y[0] ** 2) * y[1] - y[0]) / EPSILON]


def van_der_pol_jacobian(t: float, y: NDArray[Any]) -> list[list[float]]:
    return [[0, 1], [(-2 * y[0] * y[1] - 1) / EPSILON, (1 - y[0] ** 2) / EPSILON]]


def robertson(t: float, y: NDArray[Any]) -> list[float]:
    slow, fast, dimer = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return [fast - slow, slow - fast - dimer, dimer]


def robertson_jacobian(t: float, y: NDArray[Any]) -> list[list[float]]:
    a, b, c = 1e4 * y[2], 1e4 * y[1], 6e7 * y[1]
    return [[-0.04, a, b], [0.04, -a - c, -b], [0, c, 0]]


def hires(t: float, y: NDArray[Any]) -> list[float]:
    bound = 280 * y[5] * y[7] - 1.81 * y[6]
    return [
        -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
        1.71 * y[0] - 8.75 * y[1],
        -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
        8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
        -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6],
        -280 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
        bound,
        -bound,
    ]


def hires_jacobian(t: float, y: NDArray[Any]) -> NDArray[np.float64]:
    j = np.zeros((8, 8))
    j[0, :3] = -1.71, 0.43, 8.32
    j[1, :2] = 1.71, -8.75
    j[2, 2:5] = -10.03, 0.43, 0.035
    j[3, 1:4] = 8.32, 1.71, -1.12
    j[4, 4:7] = -1.745, 0.43, 0.43
    j[5, 3:8] = 0.69, 1.71, -0.43 - 280 * y[7], 0.69, -280 * y[5]
    j[6, 5:8] = 280 * y[7], -1.81, 280 * y[5]
    j[7] = -j[6]
    return j


PROBLEMS = {
    "van der Pol": StiffProblem(
        van_der_pol,
        van_der_pol_jacobian,
        (2.0, 0.0),
        2.0,
        (2.0, 1.0),
        (1.7061677321705, -0.89280970102479),
    ),
    "Robertson": StiffProblem(
        robertson,
        robertson_jacobian,
        (1.0, 0.0, 0.0),
        40.0,
        (1.0, 1e-5, 1.0),
        (0.71582706871941, 9.1855347645578e-06, 0.28416374574583),
    ),
    "HIRES": StiffProblem(
        hires,
        hires_jacobian,
        (1.0, 0, 0, 0, 0, 0, 0, 0.0057),
        321.8122,
        (1e-3, 1e-3, 1e-4, 1e-3, 1e-3, 1e-2, 1e-3, 1e-3),
        (
            0.00073713125733254,
            0.00014424857263161,
            5.8887297409671e-05,
            0.0011756513432831,
            0.0023863561988306,
            0.0062389682527406,
            0.0028499983951853,
            0.0028500016048147,
        ),
    ),
}


def main() -> None:
    """Print the solutions and how well the two methods agree."""
    from scipy.integrate import solve_ivp

    for name, problem in PROBLEMS.items():
        ends = []
        for method, rtol in (("Radau", 1e-13), ("LSODA", 1e-12)):
            result = solve_ivp(
                problem.f,
                (0, problem.end),
                problem.start,
                method=method,
                rtol=rtol,
                atol=rtol * 1e-3 * np.array(problem.scale),
                jac=problem.jacobian,
            )
            ends.append(result.y[:, -1])
        print(name, [float(f"{y:.13e}") for y in ends[0]])
        print("  LSODA differs by", np.abs(ends[1] / ends[0] - 1))


if __name__ == "__main__":
    main()
