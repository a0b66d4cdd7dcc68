"""Branches at a touch where a force jumps: x'' + 2 z x' + x = c cos Wt, less f where x > d.

Between switches all is linear, so an orbit follows from its two switching times: closed forms,
solved by scipy. Below the touch the orbit is the linear vibration, which touches at
c = d |1 - W^2 + 2izW|. Near it one with a short time beyond d exists on one side of that alone.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import fsolve

from continuation.orbits import Point, System, special

DAMPING, DISTANCE = 0.05, 1.0
# the frequency, the force, whether an orbit with the force exists below the touch alone: a fold
CASES = [(0.7, 0.2, False), (0.7, -0.2, True), (1.3, 0.2, True), (1.3, -0.2, False)]


def touch_of(frequency: float) -> float:
    """Amplitude of the load at which the linear vibration just comes to the distance."""
    return DISTANCE * abs(1 - frequency**2 + 2j * DAMPING * frequency)


def forced(t: float, frequency: float, amplitude: float, shift: float):
    """Return x and x' of the motion that repeats under the load alone, less a constant force."""
    z = amplitude * np.exp(1j * frequency * t) / (1 - frequency**2 + 2j * DAMPING * frequency)
    return np.array([z.real - shift, (1j * frequency * z).real])


MATRIX = np.array([[0, 1], [-1, -2 * DAMPING]])


def closed_form(frequency: float, amplitude: float, force: float, enter: float, leave: float):
    """Return the state on the section of the orbit with one time beyond d, if there is one."""
    period = 2 * np.pi / frequency

    def onwards(y, t, end, shift):
        free = y - forced(t, frequency, amplitude, shift)
        return forced(end, frequency, amplitude, shift) + expm(MATRIX * (end - t)) @ free

    def equations(u):
        enter, leave, speed = u
        y = onwards(np.array([DISTANCE, speed]), enter, leave, force)
        back = onwards(y, leave, enter + period, 0.0)
        return [y[0] - DISTANCE, back[0] - DISTANCE, back[1] - speed]

    start = [enter, leave, forced(enter, frequency, amplitude, 0.0)[1]]
    (enter, leave, speed), _, _, _ = fsolve(equations, start, xtol=1e-13, full_output=True)
    if max(abs(np.array(equations([enter, leave, speed])))) > 1e-12 or leave <= enter:
        return None
    quarter = period / 4 + period * np.floor((enter - period / 4) / period) + period
    y = onwards(np.array([DISTANCE, speed]), enter, leave, force)
    return onwards(y, leave, quarter, 0.0)


def follow(
    c,
    frequency: float,
    force: float,
    begin: float,
    rising: bool = True,
    values=(),
    steps=(0.01, 1e-7, 0.05),
) -> list[Point]:
    touch = touch_of(frequency)
    system = System(c, "switched", [frequency, DAMPING, begin * touch, DISTANCE, force], 2)
    system.options(between=(0.5 * touch, 1.5 * touch), rising=rising, steps=steps, most=300)
    if len(values) > 0:
        system.values(values)
    start = swept_to(system, begin * touch)
    system.find(start, begin * touch)
    return system.follow()


def swept_to(system: System, amplitude: float):
    """Return where a long run comes to."""
    y = np.array([0.0, 0.0])
    for _ in range(300):
        y, _ = system.flow(y, 2 * np.pi / system.p[0], amplitude)
    return y


@pytest.fixture(scope="module", params=CASES, ids=lambda case: f"{case[0]}-{case[1]}")
def branch(request, c):
    frequency, force, turns = request.param
    return frequency, force, turns, follow(c, frequency, force, 0.5)


def at_touch(points: list[Point]) -> int:
    return next(i for i, point in enumerate(points) if point.kind.startswith("touch"))


def test_the_touch_is_where_the_linear_vibration_touches(branch):
    frequency, _, _, points = branch
    point = points[at_touch(points)]
    assert point.root == 1
    assert point.parameter == pytest.approx(touch_of(frequency), abs=1e-9)  # as near as 1e-10
    period = 2 * np.pi / frequency
    assert point.y == pytest.approx(forced(period / 4, frequency, point.parameter, 0), abs=1e-8)
    # stability is told of the side before it, where nothing grows
    expected = np.linalg.eigvals(expm(period * MATRIX))
    assert np.sort_complex(point.multipliers) == pytest.approx(np.sort_complex(expected), abs=1e-8)


def test_the_branch_goes_on_behind_the_touch_and_turns_back_where_orbits_are_on_one_side(branch):
    frequency, _, turns, points = branch
    i = at_touch(points)
    assert points[i].kind == ("touch_fold" if turns else "touch")
    assert points[-1].parameter == 1.5 * touch_of(frequency)  # it comes to the end of the range
    beyond = points[i + 1].parameter - points[i].parameter
    assert beyond < 0 if turns else beyond > 0
    # a stable orbit and one with a large positive multiplier meet at a fold, at the other touch
    # the orbit behind it is unstable with a negative one
    assert max(abs(points[i - 1].multipliers)) < 1
    largest = points[i + 1].multipliers[0].real
    assert largest > 3 if turns else largest < -3
    assert len(special(points, "touch_fold")) == int(turns)
    assert len(special(points, "touch")) == int(not turns)
    assert len(special(points, "fold")) == int(turns)  # where the branch turns once more


def from_closed_form(point: Point, frequency: float, force: float) -> float:
    """Distance of the state from that of an orbit with one time beyond the distance."""
    top = -np.angle(1 / (1 - frequency**2 + 2j * DAMPING * frequency)) / frequency
    found = [  # at a fold two of them have one amplitude
        closed_form(frequency, point.parameter, force, top - half, top + half)
        for half in (0.02, 0.1, 0.3, 0.6, 1.0)
    ]
    return min(max(abs(point.y - state)) for state in found if state is not None)


def test_orbits_behind_the_touch_are_those_of_the_closed_form(branch):
    frequency, force, _, points = branch
    i = at_touch(points)
    behind = [point for point in points[i + 1 :] if point.kind == "ordinary"]
    for point in behind[:15]:
        assert from_closed_form(point, frequency, force) < 1e-8


@pytest.mark.parametrize("rising", [True, False])
@pytest.mark.parametrize(("frequency", "force", "turns"), CASES)
def test_orbits_that_are_told_on_both_sides_of_the_touch_are_those_of_closed_forms(
    c, frequency: float, force: float, turns: bool, rising: bool
):
    """At values up and down; what is told comes within 1e-8 of an orbit."""
    touch, period = touch_of(frequency), 2 * np.pi / frequency
    values = touch * np.linspace(0.8, 1.2, 81)
    points = follow(c, frequency, force, 0.5 if rising else 1.5, rising, values)
    i = at_touch(points)
    linear, beyond = (
        [point for point in side if point.is_recorded]
        for side in (points[:i], points[i + 1 :])[:: 1 if rising else -1]
    )
    assert sorted(point.parameter for point in linear) == values[values < touch].tolist()
    for point in linear:
        exact = forced(period / 4, frequency, point.parameter, 0)
        assert point.y == pytest.approx(exact, abs=1e-7)
    reported = [point.parameter for point in beyond]
    assert len(reported) == len(set(reported)) >= 30
    assert set(reported) <= set(values.tolist())
    # those behind a fold begin below it; behind the other touch the first ones are unstable
    assert (min(reported) < touch) == turns
    for point in beyond:
        assert from_closed_form(point, frequency, force) < 1e-7


@pytest.mark.parametrize(("frequency", "force"), [case[:2] for case in CASES if not case[2]])
def test_unstable_orbits_close_behind_a_touch_are_at_no_value(c, frequency: float, force: float):
    """Multipliers jump at a touch, so that they are asked at each value."""
    touch = touch_of(frequency)
    points = follow(c, frequency, force, 0.5)
    behind = points[at_touch(points) + 1]
    assert abs(behind.multipliers[0]) > 1
    values = np.linspace(touch, behind.parameter, 7)[1:-1]
    points = follow(c, frequency, force, 0.5, True, values)
    assert not {point.parameter for point in points} & set(values.tolist())


@pytest.mark.parametrize("rising", [True, False])
def test_a_step_from_one_branch_to_another_is_tried_shorter(c, rising: bool):
    """Longer than the way from the touch to the fold: what lies between is found all the same."""
    short, long = (
        [
            (point.kind, round(point.parameter, 5))
            for point in follow(c, 1.3, 0.2, 0.5 if rising else 1.5, rising, steps=steps)
            if point.kind != "ordinary"
        ]
        for steps in [(0.01, 1e-7, 0.05), (0.5, 1e-7, 2.0)]
    )
    assert long == short
    assert {kind for kind, _ in long} == {"touch_fold", "fold"}


@pytest.mark.parametrize(
    ("force", "begin", "step"),
    [(0.2, 0.85, 0.8), (0.5, 0.8, 0.8), (0.5, 0.85, 0.6), (1.0, 0.75, 0.8)],
)
def test_a_long_step_to_another_branch_leads_to_the_touch_at_once(
    c, force: float, begin: float, step: float
):
    """Orbits to both sides of the touch are found, far from each other: nothing is smooth there,
    and no shorter step is tried first."""
    points = follow(c, 1.3, force, begin, steps=(step, 1e-7, 2.0))
    assert points[1].kind == "touch_fold"
    assert points[1].parameter == pytest.approx(touch_of(1.3), abs=1e-9)


def test_multipliers_grow_as_one_over_the_distance_from_the_touch(branch):
    """The derivative of a root: the product of multiplier and way has a limit."""
    _, _, _, points = branch
    i = at_touch(points)
    products = []
    for point in points[i + 1 : i + 3]:
        way = [*(point.y - points[i].y), point.parameter - points[i].parameter]
        products.append(point.multipliers[0].real * np.linalg.norm(way))
    assert products[1] == pytest.approx(products[0], rel=0.2)  # the next order in the way


@pytest.mark.parametrize(("frequency", "force", "turns"), CASES)
def test_a_branch_comes_to_the_touch_from_behind(c, frequency: float, force: float, turns: bool):
    """From large amplitudes down: at a fold the branch goes up again, else down."""
    points = follow(c, frequency, force, 1.5, rising=False)
    i = at_touch(points)
    assert points[i].kind == ("touch_fold" if turns else "touch")
    assert points[i].parameter == pytest.approx(touch_of(frequency), abs=1e-9)
    assert points[-1].parameter == 0.5 * touch_of(frequency)
    period = 2 * np.pi / frequency
    for point in points[i + 1 :]:
        linear = forced(period / 4, frequency, point.parameter, 0)
        assert point.y == pytest.approx(linear, abs=1e-9)
