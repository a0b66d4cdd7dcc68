"""The backlash oscillator: folds, the unstable branch between them, a doubling and its branch."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from continuation.orbits import OrbitError, Point, System, special
from continuation.test_orbits import swept

BACKLASH = [0.7, 0.05, 0.1, 0.3]


def backlash_flow(y, frequency):
    """Period of the backlash oscillator by DOP853, stopped where its spring begins and ends."""
    _, damping, mean, amplitude = BACKLASH

    def f(t, y, mode):
        force = mean + amplitude * np.cos(frequency * t)
        return [y[1], force - 2 * damping * y[1] - abs(mode) * (y[0] - mode)]

    def reach(border):
        def event(t, y, mode):
            return y[0] - border

        event.terminal = True
        return event

    t, end = 0.0, 2 * np.pi / frequency
    mode = 0 if abs(y[0]) <= 1 else int(np.sign(y[0]))
    while t < end:
        borders = [reach(1), reach(-1)] if mode == 0 else [reach(mode)]
        start = y + 1e-13 * np.array(f(t, y, mode)) if t > 0 else y
        run = solve_ivp(
            f, (t, end), start, "DOP853", events=borders, args=(mode,), rtol=1e-12, atol=1e-14
        )
        t, y = run.t[-1], run.y[:, -1]
        if run.status == 1:
            mode = (1 if len(run.t_events[0]) else -1) if mode == 0 else 0
    return y


def is_stable(point: Point) -> bool:
    return bool(max(abs(point.multipliers)) < 1)


@pytest.fixture(scope="module")
def backlash(c):
    """Follow the backlash oscillator from high frequencies to low ones."""
    system = System(c, "backlash", BACKLASH)
    start = swept(system, [1, 0], 2.0, 200)
    system.options(between=(0.5, 2.0), rising=False)
    system.find(start, 2.0)
    return system, system.follow()


def test_a_branch_is_one_of_orbits_and_its_stability_changes_where_it_is_said(backlash):
    system, points = backlash
    assert all(point.residual <= 1e-10 for point in points)
    assert points[-1].parameter == 0.5
    changes = 0
    for before, point, after in zip(points, points[1:], points[2:], strict=False):
        if point.kind in ("fold", "doubling", "neimark_sacker"):
            assert is_stable(before) != is_stable(after)
            changes += 1
        elif before.kind == point.kind == "ordinary":
            assert is_stable(before) == is_stable(point)
    assert changes == 4
    for point in points[:: len(points) // 10]:
        end, _ = system.flow(point.y, point.period, point.parameter)
        assert end == pytest.approx(point.y, abs=1e-10)


def test_the_unstable_branch_is_followed_between_two_folds(backlash):
    _, points = backlash
    first, last = [i for i, point in enumerate(points) if point.kind == "fold"]
    between = points[first + 1 : last]
    assert len(between) > 20
    assert not any(is_stable(point) for point in between)
    # one real multiplier above 1 all the way; both parameters of the folds bound it
    assert all(point.multipliers[0].real > 1 for point in between)
    parameters = [point.parameter for point in between]
    assert np.all(np.diff(parameters) > 0)
    assert points[first].parameter < parameters[0]
    assert parameters[-1] < points[last].parameter
    # an independent program comes back to where it started, amplified by the multiplier
    point = between[len(between) // 2]
    assert backlash_flow(point.y, point.parameter) == pytest.approx(point.y, abs=1e-8)


def test_the_folds_of_the_backlash_oscillator_are_those_of_an_independent_program(backlash):
    """P(y) = y and det(DP - 1) = 0, with DP by differences of DOP853, solved by scipy."""

    def derivative(y, frequency, size=1e-4):
        return np.array(
            [
                (
                    8
                    * (
                        backlash_flow(y + size * e, frequency)
                        - backlash_flow(y - size * e, frequency)
                    )
                    - backlash_flow(y + 2 * size * e, frequency)
                    + backlash_flow(y - 2 * size * e, frequency)
                )
                / (12 * size)
                for e in np.eye(2)
            ]
        ).T

    def equations(u):
        y, frequency = u[:2], u[2]
        singular = np.linalg.det(derivative(y, frequency) - np.eye(2))
        return [*(backlash_flow(y, frequency) - y), singular]

    for fold in special(backlash[1], "fold"):
        solution = fsolve(equations, [*fold.y, fold.parameter], xtol=1e-10, epsfcn=1e-9)
        assert fold.parameter == pytest.approx(solution[2], abs=1e-8)


@pytest.mark.parametrize("which", [0, 1])
def test_a_sweep_jumps_where_the_fold_is(backlash, which):
    """1e-4 before the fold a run stays at the orbit, 1e-4 beyond it is gone."""
    system, points = backlash
    i = [k for k, point in enumerate(points) if point.kind == "fold"][which]
    side = next(k for k in (i - 1, i + 1) if is_stable(points[k]))
    towards = np.sign(points[side].parameter - points[i].parameter)
    for sign, stays in ((1, True), (-1, False)):
        frequency = points[i].parameter + sign * towards * 1e-4
        far = np.linalg.norm(swept(system, points[side].y, frequency, 3000) - points[i].y)
        assert far < 0.2 if stays else far > 0.5  # the root of 1e-4, and another orbit


# ---- period doubling ----


@pytest.fixture(scope="module")
def doubled(backlash):
    """Return the doubling of the backlash oscillator, and what branches off there."""
    system, points = backlash
    i, doubling = next((i, p) for i, p in enumerate(points) if p.kind == "doubling")
    system.find(points[0].y, points[0].parameter)
    system.options(between=(0.5, 2.0), rising=False)
    again = system.follow()
    assert again[i].parameter == doubling.parameter
    system.options(between=(1.93, 1.95), rising=False, steps=(0.001, 1e-7, 0.002), most=40)
    system.switch(i, 0.001)
    return system, doubling, system.follow(0, with_tangent=True)


def test_a_branch_of_twice_the_period_leaves_where_a_multiplier_is_minus_1(doubled):
    system, doubling, points = doubled
    assert min(abs(doubling.multipliers + 1)) < 1e-8
    assert all(point.periods == 2 and point.residual <= 1e-10 for point in points)
    period = 2 * np.pi / points[-1].parameter
    half, _ = system.flow(points[-1].y, period, points[-1].parameter)
    assert np.linalg.norm(half - points[-1].y) > 0.02
    end, _ = system.flow(half, period, points[-1].parameter)
    assert end == pytest.approx(points[-1].y, abs=1e-9)


def test_near_its_doubling_the_branch_of_twice_the_period_is_a_parabola(doubled):
    """The parameter goes with the square of the distance from the doubling."""
    _, doubling, points = doubled
    near = [p for p in points if p.kind == "ordinary"][:6]
    distance = np.array([np.linalg.norm(p.y - doubling.y) for p in near])
    change = np.array([p.parameter - doubling.parameter for p in near])
    assert np.all(change < 0)
    assert change / distance**2 == pytest.approx(
        np.full(len(near), change[-1] / distance[-1] ** 2), rel=0.05
    )
    assert near[0].multipliers[0] == pytest.approx(1, abs=1e-3)
    assert all(is_stable(point) for point in near)  # the other one has lost its stability


def test_a_long_run_ends_on_the_orbit_of_twice_the_period(doubled):
    system, _, points = doubled
    # not where something just touches: what lies beside that has no derivative
    ordinary = [point for point in points if point.kind == "ordinary"]
    point = min(ordinary, key=lambda p: max(abs(p.multipliers)))
    assert max(abs(point.multipliers)) < 0.985
    start = point.y + np.array([1e-3, 0])
    y = swept(system, start, point.parameter, 1500, periods=2)  # 0.985**1500 = 1e-10
    assert y == pytest.approx(point.y, abs=1e-7)


def test_an_orbit_without_a_multiplier_minus_1_has_no_other_branch(backlash):
    system, points = backlash
    system.find(points[0].y, points[0].parameter)
    with pytest.raises(OrbitError, match=r"the orbit at 2 has no multiplier -1"):
        system.switch(0, 0.01)
