"""The derivative of the flow, through events, against closed forms and differences."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from continuation.orbits import System
from integrator.radau import Library

SYSTEMS = {
    # name: parameters, state on the section, events on the way, periods
    "duffing": ([1.1, 0.1, 1, 1, 0.4], [0.6, -0.3], 0, 2),
    "backlash": ([0.7, 0.05, 0.1, 0.3], [0.3, 0.5], 3, 3),
    "ball": ([1, 0.6, 0.05, 0.5, 0.5], [1.9, -0.2, 1.5], 5, 2),
    "remembering_stop": ([0.8, 0.03, 0.2, 0.4, 0.3], [-0.5, 0.4, 0.7], 3, 2),
    "van_der_pol": ([1], [1.5, 0.3], 0, 1),
    "duffing_with_phase": ([1.1, 0.1, 1, 1, 0.4], [0.6, -0.3, 0.2], 0, 2),
    "stop": ([0.7, 0.05, 0.9, 1, 2], [0.4, 0.5], 2, 2),
    "parting": ([0.9, 1.638, 0.03, 1], [2.5, 1], 5, 3),
}


def differences(system: System, y, duration: float, size: float = 1e-5):
    columns = [
        system.flow(np.add(y, size * e), duration)[0]
        - system.flow(np.subtract(y, size * e), duration)[0]
        for e in np.eye(system.n)
    ]
    return np.array(columns).T / (2 * size)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_derivative_is_that_of_differences_of_flows(c, name):
    parameters, y, events, periods = SYSTEMS[name]
    system = System(c, name, parameters)
    duration = periods * (5.0 if name == "van_der_pol" else 2 * np.pi / parameters[0])
    _, derivative = system.flow(y, duration)
    assert system.events >= events
    assert system.ties == 0
    # differences: third derivatives times 1e-10, and the error of a flow, 1e-12, over 1e-5
    assert derivative == pytest.approx(
        differences(system, y, duration), abs=2e-7 * abs(derivative).max()
    )


def test_a_memory_that_is_set_at_first_touch_has_its_part_in_the_derivative(c):
    parameters, y, _, periods = SYSTEMS["remembering_stop"]
    system = System(c, "remembering_stop", parameters)
    _, derivative = system.flow(y, periods * 2 * np.pi / 0.8)
    # what is remembered at the end is a speed of the past; what was remembered before is forgotten
    assert np.abs(derivative[2, :2]).min() > 1e-3
    assert np.all(derivative[:, 2] == 0)


@pytest.mark.parametrize("damping", [0, 0.1, 0.3, 0.7, 1])
def test_the_error_of_a_piece_is_below_twenty_times_the_product_of_two_pairs(
    kernel_test_library, damping
):
    """D' = z D by the method's tables: p the last two coefficients, q = p^2 over those before."""
    tables = Library(kernel_test_library).tables()
    a, to_chebyshev = tables["integral"][:7, :7], tables["chebyshev"]
    for size in np.linspace(0.8, 4, 33):
        z = size * (1j * np.sqrt(1 - damping**2) - damping)
        increments = np.linalg.solve(np.eye(7) - z * a, z * a @ np.ones(7))
        error = 1 + increments[-1] - np.exp(z)
        for turn in np.exp(1j * np.linspace(0, np.pi / 2, 13)):  # two entries a quarter apart
            c = to_chebyshev @ np.append(turn * increments, 0)
            estimates = []
            for part in (c.real, c.imag):
                p, before = np.hypot(part[6], part[7]), np.hypot(part[4], part[5])
                estimates.append(20 * p * p * min(1, p / before) if p > 0 else 0)
            assert abs(error) < max(estimates) + 1e-15


def product(frequency, ratio, damping, start=0.0):
    """Two exponentials: the section lies in the middle of the time with one pair."""
    a = {n: np.array([[0, 1], [-n, -2 * damping * n]]) for n in (1, 2)}
    pitch = 2 * np.pi / frequency
    half = expm(a[1] * (1 - ratio / 2) * pitch)
    return half @ expm(a[2] * (ratio - 1) * pitch) @ half


@pytest.mark.parametrize("frequency", [0.02, 0.3, 1.2, 2.4, 20])
@pytest.mark.parametrize(("ratio", "damping"), [(1.638, 0.03), (1.1, 0), (1.95, 0.4)])
def test_modes_at_rest_have_the_derivative_of_two_exponentials(c, frequency, ratio, damping):
    # the state stays 0, so nothing but the derivative itself bounds its pieces: at the lowest
    # frequency it rings 70 times
    system = System(c, "meissner", [frequency, ratio, damping, 0])
    end, derivative = system.flow([0, 0], 2 * np.pi / frequency)
    assert np.all(end == 0)
    assert system.steps <= 3
    # 1e-12 a piece, of at most a hundred
    assert derivative == pytest.approx(product(frequency, ratio, damping), abs=1e-10)


def ball_map(frequency, e, share, amplitude, gravity):
    """Return the orbit with one impact a period, and the derivative of the map between impacts.

    With T the period, u the table's speed, v the ball's after the impact and w the approach:
    v = gT/2 = w - u and v = u + (e + s w) w. The map takes time, v and w of an impact to the next,
    which is where z(t) + v d - g d^2/2 = z(t'), d = t' - t.
    """
    period = 2 * np.pi / frequency
    v = gravity * period / 2
    w = brentq(lambda w: (w - v) + (e + share * w) * w - v, 0, 10)
    t = np.arccos((w - v) / (amplitude * frequency)) / frequency
    bend = -amplitude * frequency**2 * np.sin(frequency * t)
    time = np.array([1, period / w, 0])
    arrival = np.array([gravity, 1, 0]) - gravity * time
    approach = bend * time - arrival
    start = bend * time + (e + share * w) * approach + np.array([0, 0, share * w])
    back = t - period  # of the last impact before the section
    z = amplitude * np.sin(frequency * t) - v * back - gravity * back**2 / 2
    return [z, v + gravity * back, w], np.array([time, start, approach])


@pytest.mark.parametrize("share", [0, 0.05, -0.03])
@pytest.mark.parametrize(("e", "amplitude"), [(0.6, 0.5), (0.8, 0.3)])
def test_a_bouncing_ball_with_memory_has_the_multipliers_of_its_map(c, e, amplitude, share):
    # the event depends on time, and so does the jump; the memory is the approach of the last impact
    state, derivative = ball_map(1, e, share, amplitude, 0.5)
    orbit = System(c, "ball", [1, e, share, amplitude, 0.5]).find(np.array(state) + 1e-3)
    assert orbit.y == pytest.approx(state, abs=1e-9)  # residual 1e-10
    expected = np.linalg.eigvals(derivative)
    order = np.lexsort((-expected.imag, -abs(expected).round(9)))
    # an error of 1e-10 of the orbit, and 1e-12 of the flow
    assert orbit.multipliers == pytest.approx(expected[order], abs=1e-8)
    if share == 0:  # the memory has no effect: det = e^2
        assert np.prod(orbit.multipliers[:2]) == pytest.approx(e**2, abs=1e-8)


def test_liouvilles_formula_holds_along_van_der_pols_orbit(c):
    """The product of the multipliers is exp of the integral of the trace, mu (1 - x^2)."""
    system = System(c, "van_der_pol", [1])
    orbit = system.find([2, 0], period=6.5)
    assert orbit.period == pytest.approx(6.66328686, abs=1e-8)  # to all digits that are known
    times, weights = np.polynomial.legendre.leggauss(60)
    times = (times + 1) * orbit.period / 2
    states = np.array([system.flow(orbit.y, t)[0] for t in times])
    trace = weights @ (1 - states[:, 0] ** 2) * orbit.period / 2
    assert orbit.multipliers[0] == pytest.approx(1, abs=1e-10)
    assert orbit.multipliers[1] == pytest.approx(np.exp(trace), rel=1e-8)
