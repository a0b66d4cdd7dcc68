"""Duffing's oscillator with two wells: its period doubles again and again on smaller branches.

x'' + 0.3 x' - x + x^3 = c cos 1.2 t, with c as the parameter.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from continuation.orbits import Floats, Point, System
from continuation.test_orbits import swept

FREQUENCY, DAMPING = 1.2, 0.3
PERIOD = 2 * np.pi / FREQUENCY
DISTANCE = 0.02  # that of `respond`: some branches are entered nearer to their doubling


@pytest.fixture(scope="module")
def cascade(c) -> list[tuple[Point, Point]]:
    """Return five doublings, and with each the first orbit of twice its period."""
    system = System(c, "duffing", [FREQUENCY, DAMPING, -1, 1, 0.2], 4)
    system.find(swept(system, [1, 0], 0.2, 200))
    found = []
    for level in range(5):
        system.options(between=(0.2, 0.4), steps=(0.02, 1e-7, 0.1), most=8)
        points = system.follow(0, with_tangent=level > 0)
        i = next(i for i, point in enumerate(points) if point.kind == "doubling")
        found.append((points[i], system.switch(i, DISTANCE)))
    return found


def variational_flow(y: Floats, amplitude: float, periods: int) -> tuple[Floats, Floats]:
    """Return where periods by DOP853 end, and their derivative, by the variational equation."""

    def f(t, u):
        x, v = u[:2]
        change = np.array([[0, 1], [1 - 3 * x**2, -DAMPING]]) @ u[2:].reshape(2, 2)
        force = amplitude * np.cos(FREQUENCY * t)
        return [v, force - DAMPING * v + x - x**3, *change.ravel()]

    start = [*y, 1, 0, 0, 1]
    run = solve_ivp(f, (0, periods * PERIOD), start, "DOP853", rtol=1e-12, atol=1e-13)
    return run.y[:2, -1], run.y[2:, -1].reshape(2, 2)


def test_periods_double_to_32_where_an_independent_program_has_a_multiplier_minus_1(cascade):
    def equations(u, periods):
        end, derivative = variational_flow(u[:2], u[2], periods)
        return [*(end - u[:2]), np.linalg.det(derivative + np.eye(2))]

    for level, (doubling, _) in enumerate(cascade):
        assert doubling.periods == 2**level
        start = [*doubling.y, doubling.parameter]
        solution = fsolve(equations, start, (doubling.periods,), xtol=1e-12)
        assert doubling.parameter == pytest.approx(solution[2], abs=1e-9)


def test_a_branch_of_twice_the_period_is_entered_before_the_next_doubling(cascade):
    """The stable range of each is 4.67 times smaller than that before: there are orbits nearby."""
    parameters = np.array([doubling.parameter for doubling, _ in cascade])
    assert np.all(np.diff(parameters) > 0)
    for (doubling, orbit), end in zip(cascade, [*parameters[1:], 0.4], strict=True):
        assert orbit.periods == 2 * doubling.periods
        assert doubling.parameter < orbit.parameter < end
        end_of_it, derivative = variational_flow(orbit.y, orbit.parameter, orbit.periods)
        assert end_of_it == pytest.approx(orbit.y, abs=1e-9)
        assert max(abs(np.linalg.eigvals(derivative))) < 1
        half, _ = variational_flow(orbit.y, orbit.parameter, doubling.periods)
        assert np.linalg.norm(half - orbit.y) > 0.5 * np.linalg.norm(orbit.y - doubling.y)


def test_the_distances_of_doublings_shrink_as_feigenbaum_found(cascade):
    parameters = [doubling.parameter for doubling, _ in cascade]
    shrinks = np.diff(parameters)[:-1] / np.diff(parameters)[1:]
    assert shrinks[-2:] == pytest.approx([4.6692016, 4.6692016], rel=0.005)
