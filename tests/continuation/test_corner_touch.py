"""Branches at a touch where the flow has a corner: a stop whose damper only pushes.

x'' + 2 z x' + x = c cos Wt, less k (x - d) + b x' where x > d and that is positive. Near the touch
the damper takes b times what x comes beyond d out of the speed, as it goes in and not as it comes
out: the derivative of the flow jumps there, and stays finite. Between events all is linear, so an
orbit follows from the two times of its push: closed forms, solved by scipy.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import fsolve

from continuation.orbits import Floats, System, special
from continuation.test_grazing_passage import DAMPING, DISTANCE, MATRIX, at_touch, forced, touch_of

STIFFNESS = 1.0
# the frequency, the damper, whether the branch turns back at the touch
CASES = [(1.3, 4.0, True), (1.3, 2.5, True), (1.3, 0.8, False), (0.7, 4.0, False)]


def multipliers_at(frequency: float, damper: float) -> Floats:
    """Return those of the linear vibration (no damper), or of the orbits just behind the touch."""
    push = np.eye(2) - damper * np.outer([0, 1], [1, 0])
    return np.linalg.eigvals(expm(2 * np.pi / frequency * MATRIX) @ push)


def closed_form(frequency: float, amplitude: float, damper: float, enter: float, leave: float):
    """Return the state on the section of the orbit with one push, from its times and speed."""
    period = 2 * np.pi / frequency
    pushed = MATRIX - np.array([[0, 0], [STIFFNESS, damper]])
    size = amplitude / (1 + STIFFNESS - frequency**2 + 1j * (2 * DAMPING + damper) * frequency)

    def forced_pushed(t):
        z = size * np.exp(1j * frequency * t)
        rest = STIFFNESS * DISTANCE / (1 + STIFFNESS)
        return np.array([z.real + rest, (1j * frequency * z).real])

    def free(y, t, end):
        particular = [forced(at, frequency, amplitude, 0.0) for at in (t, end)]
        return particular[1] + expm(MATRIX * (end - t)) @ (y - particular[0])

    def through(enter, leave, speed):
        start = np.array([DISTANCE, speed]) - forced_pushed(enter)
        return forced_pushed(leave) + expm(pushed * (leave - enter)) @ start

    def equations(u):
        enter, leave, speed = u
        if abs(leave - enter) > period:
            return [1.0, 1.0, 1.0]
        y = through(enter, leave, speed)
        back = free(y, leave, enter + period)
        push = STIFFNESS * (y[0] - DISTANCE) + damper * y[1]
        return [push, back[0] - DISTANCE, back[1] - speed]

    start = [enter, leave, forced(enter, frequency, amplitude, 0.0)[1]]
    (enter, leave, speed), _, _, _ = fsolve(equations, start, xtol=1e-13, full_output=True)
    if max(abs(np.array(equations([enter, leave, speed])))) > 1e-12 or leave <= enter:
        return None
    if speed <= 0:
        return None
    quarter = period / 4 + period * np.floor((leave - period / 4) / period) + period
    return free(through(enter, leave, speed), leave, quarter)


def orbit_behind(frequency: float, amplitude: float, damper: float) -> list[Floats]:
    """Return the states of all orbits with one push that are found."""
    top = -np.angle(1 / (1 - frequency**2 + 2j * DAMPING * frequency)) / frequency
    found = [
        closed_form(frequency, amplitude, damper, top - before, top)
        for before in (1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6, 1.0, 1.5)
    ]
    return [state for state in found if state is not None]


def system_at(c, frequency: float, damper: float, amplitude: float) -> System:
    parameters = [frequency, DAMPING, amplitude, DISTANCE, STIFFNESS, damper]
    return System(c, "one_sided", parameters, 2)


@pytest.fixture(scope="module", params=[True, False], ids=["up", "down"])
def rising(request) -> bool:
    return request.param


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]}-{case[1]}")
def branch(request, c, rising):
    """Follow the branch over the touch, from below or from above."""
    frequency, damper, turns = request.param
    touch = touch_of(frequency)
    low, high = 0.5 * touch, 1.2 * touch
    system = system_at(c, frequency, damper, low if rising else high)
    system.options(between=(low, high), rising=rising, steps=(0.02, 1e-7, 0.05))
    y = np.array([0.0, 0.0])
    for _ in range(300):
        y, _ = system.flow(y, 2 * np.pi / frequency)
    system.find(y)
    return frequency, damper, turns, system.follow()


def test_a_branch_comes_over_the_corner_and_turns_back_there_where_a_multiplier_passes_1(branch):
    frequency, damper, turns, points = branch
    i = at_touch(points)
    assert points[i].parameter == pytest.approx(touch_of(frequency), abs=1e-9)
    before, behind = (np.prod(multipliers_at(frequency, b) - 1).real for b in (0.0, damper))
    assert turns == (before * behind < 0)  # else orbits on one side have both signs
    assert points[i].kind == ("touch_fold" if turns else "touch")
    assert len(special(points, "touch")) + len(special(points, "touch_fold")) == 1
    assert len(special(points, "fold")) == int(turns)  # where the branch turns once more
    ends = sorted([points[0].parameter, points[-1].parameter])
    assert ends == [0.5 * touch_of(frequency), 1.2 * touch_of(frequency)]


def test_orbits_on_both_sides_of_the_corner_are_those_of_closed_forms(branch, rising):
    frequency, damper, _, points = branch
    i = at_touch(points)
    linear, pushed = (points[:i], points[i + 1 :])[:: 1 if rising else -1]
    for point in linear:
        exact = forced(np.pi / 2 / frequency, frequency, point.parameter, 0)
        assert point.y == pytest.approx(exact, abs=1e-9)
    assert len(pushed) > 5
    for point in pushed:
        if point.kind == "ordinary":
            states = orbit_behind(frequency, point.parameter, damper)
            assert min(max(abs(point.y - state)) for state in states) < 1e-8


@pytest.mark.parametrize(("frequency", "damper", "turns"), CASES)
def test_behind_the_corner_multipliers_are_others_and_finite(c, frequency, damper, turns):
    amplitude = touch_of(frequency) * (1 - 1e-8 if turns else 1 + 1e-8)
    (state,) = orbit_behind(frequency, amplitude, damper)[:1]
    point = system_at(c, frequency, damper, amplitude).find(state)
    expected = np.sort_complex(multipliers_at(frequency, damper))
    # what the spring adds grows with the root of the way
    assert np.sort_complex(point.multipliers) == pytest.approx(expected, abs=2e-3)
