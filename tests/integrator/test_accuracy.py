"""Order and error control on problems with known solutions.

The promise: the error at every step and between steps is at most 10 times the tolerance, in units
of each state's scale, unless the problem itself amplifies errors.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from radau_coefficients import STAGES, radau
from stiff_problems import PROBLEMS as STIFF

from integrator.problems import SOLVED, Solved
from integrator.radau import Library, Problem, Solver

PROMISE = 10
# A change d of the speed v at the first pericentre changes the semi-axis by 2 v d and the phase
# at t by 3/2 of that times t: with v = 4.4 and t = 20 an orbit of eccentricity 0.9 amplifies an
# error some hundredfold; the others at most tenfold, with v = 2.4.
AMPLIFICATION = {"D5": 100}


def largest_errors(library: Library, solved: Solved, tolerance: float) -> tuple[float, float]:
    """Return the largest errors at the steps and between them, in units of the scales."""
    solver = Solver(library, solved.problem, tolerance)
    scale = np.array(solved.problem.scale)
    at_steps = between = 0.0
    for t, y in solver.steps(0, solved.solution(0), solved.end):
        before = solver.state[0]
        at_steps = max(at_steps, (np.abs(y - solved.solution(t)) / scale).max())
        for inside in np.linspace(before, t, 9)[1:-1]:
            difference = solver.interpolate(inside) - solved.solution(inside)
            between = max(between, (np.abs(difference) / scale).max())
    return at_steps, between


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("name", SOLVED)
def test_error_is_within_10_times_the_tolerance(library: Library, name: str, tolerance: float):
    errors = largest_errors(library, SOLVED[name], tolerance)
    assert max(errors) <= PROMISE * AMPLIFICATION.get(name, 1) * tolerance


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("name", STIFF)
def test_stiff_problems_end_within_10_times_the_tolerance(library, name, tolerance):
    problem = STIFF[name]
    solver = Solver(library, Problem(problem.f, problem.jacobian, problem.scale), tolerance)
    end = solver.end(0, problem.start, problem.end)
    # the recorded solutions are good to 2e-11 of a component, far below 1e-8 of a scale
    assert (np.abs(end - problem.solution) / problem.scale).max() <= PROMISE * tolerance


def test_a_stiff_problem_is_solved_in_steps_of_its_slow_solution(library: Library):
    # Robertson's fast time is 1e-4 s; an explicit method would need 1e5 steps
    problem = STIFF["Robertson"]
    solver = Solver(library, Problem(problem.f, problem.jacobian, problem.scale), 1e-6)
    solver.end(0, problem.start, problem.end)
    assert solver.counts.steps < 100


def one_step(library: Library, problem: Problem, y: list[float], h: float) -> Solver:
    """Make one step of h, however large its error."""
    solver = Solver(library, problem, 0.1, max_step=h, first_step=h)
    solver.start(0, y)
    solver.advance(10 * h)
    assert solver.state[1] == h
    return solver


@pytest.mark.parametrize("power", range(13))
def test_a_polynomial_of_degree_12_is_integrated_exactly(library: Library, power: int):
    # order 13: the quadrature of t^12 is right, at t = 1.5 to the rounding of its sum
    problem = Problem(lambda t, y: (power + 1) * t**power, lambda t, y: 0, [1e6])
    y = one_step(library, problem, [0], 1.5).state[2]
    assert y[0] == pytest.approx(1.5 ** (power + 1), rel=1e-14)


def test_a_polynomial_of_degree_13_is_not(library: Library):
    problem = Problem(lambda t, y: 14 * t**13, lambda t, y: 0, [1e6])
    y = one_step(library, problem, [0], 1.5).state[2]
    # the error of the quadrature: the integral of the monic polynomial with the nodes as zeros,
    # squared but for the last one, which 7 points cannot see; 1e-7 of the value
    assert 1e-9 < abs(y[0] / 1.5**14 - 1) < 1e-6


@pytest.mark.parametrize("h", [0.5, 2.0, 4.0, 10.0])
def test_a_step_of_a_linear_problem_multiplies_by_the_stability_function(library: Library, h):
    problem = Problem(lambda t, y: [y[1], -y[0]], lambda t, y: [0, 1, -1, 0], [1e6, 1e6])
    y = one_step(library, problem, [1, 0], h).state[2]
    with mp.workdps(40):
        a = radau().a
        z = mp.mpc(0, h)
        stages = mp.lu_solve(mp.eye(STAGES) - z * a, mp.matrix([1] * STAGES))
        expected = complex(stages[STAGES - 1])  # e^(i t) = cos t + i sin t; y = (cos, -sin)
    assert abs(complex(y[0], -y[1]) - expected) <= 1e-13


def test_the_dense_output_has_order_8(library: Library):
    # halving the step divides the error of the polynomial inside it by 2^8
    problem = Problem(lambda t, y: [y[1], -y[0]], lambda t, y: [0, 1, -1, 0], [1e6, 1e6])
    errors = []
    for h in (1.0, 0.5):
        solver = one_step(library, problem, [1, 0], h)
        inside = np.linspace(0, h, 101)
        values = np.array([solver.interpolate(t)[0] for t in inside])
        errors.append(np.abs(values - np.cos(inside)).max())
    assert 2**7.5 < errors[0] / errors[1] < 2**9


def test_an_oscillation_at_the_limit_of_precision_keeps_going(library: Library):
    # tolerance 1e-13: the Newton iteration has to stop at rounding instead of failing
    problem = Problem(lambda t, y: [y[1], -y[0]], lambda t, y: [0, 1, -1, 0], [1e-6, 1e-6])
    solver = Solver(library, problem, 1e-13)
    end = solver.end(0, [1e3, 0], 20)
    # each of some hundred steps rounds 1e3 to 1e-13, several times
    assert np.abs(end - 1e3 * np.array([np.cos(20), -np.sin(20)])).max() < 1e-9


def test_a_tighter_tolerance_costs_more_steps_and_gives_a_smaller_error(library: Library):
    steps, errors = [], []
    for tolerance in (1e-4, 1e-7, 1e-10):
        solver = Solver(library, SOLVED["D3"].problem, tolerance)
        end = solver.end(0, SOLVED["D3"].solution(0), 20)
        errors.append(np.abs(end - SOLVED["D3"].solution(20)).max())
        steps.append(solver.counts.steps)
    assert steps == sorted(steps)
    assert errors[0] > 30 * errors[1] > 900 * errors[2]


def test_a_stiff_solution_that_starts_at_rest_is_not_stepped_over(library: Library):
    # f(0) = 0 and a filter that forgives everything: without its own estimate of the dense output
    # the solver took the whole interval in one step, right at its end and wrong by 1 inside
    solver = Solver(library, SOLVED["stiff"].problem, 1e-6)
    assert len(list(solver.steps(0, [1], 20))) >= 5
