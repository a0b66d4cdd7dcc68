"""Where a tolerance asks for less than rounding, steps are as long as the motion allows."""

from __future__ import annotations

import numpy as np
import pytest

from integrator.radau import STOP, Library, Problem, Solver

FAR, SPEED = 1000.0, 1e-3  # where a stiff spring moves, whose length has no digits below 1e-13


def dragged(stiffness: float, damping: float, scale: float) -> Problem:
    """Build a mass that a point drags by a spring and a damper; its speed counts in `scale`."""

    def f(t: float, y: np.ndarray) -> list[float]:
        return [y[1], stiffness * (y[2] - y[0]) + damping * (SPEED - y[1]), SPEED]

    entries = [(0, 1), (1, 0), (1, 1), (1, 2)]
    return Problem(
        *(f, lambda t, y: [1, -stiffness, -damping, stiffness], [1, scale, 1]), entries=entries
    )


@pytest.mark.parametrize(
    ("stiffness", "damping", "off"),
    [(1e10, 2e6, 1e-8), (1e12, 2e6, 1e-8), (1e13, 0.0, 0.0)],
    ids=["creeps", "stiff", "rings"],
)
def test_digits_that_are_not_there_cost_no_steps(
    library: Library, stiffness: float, damping: float, off: float
) -> None:
    """Rounding of the place is a force: 1e-13 m times the stiffness, 1e14 tolerances in a step."""
    solver = Solver(library, dragged(stiffness, damping, 1e-9), first_step=1e-9)
    solver.start(0, [FAR + off, SPEED, FAR])
    end = 1e-2 if damping else 1e-4
    steps = next(i for i in range(1, 2000) if solver.advance(end) == STOP)
    assert steps < 150
    _, now, y, _ = solver.state
    assert now == end
    digit = np.spacing(FAR)
    assert abs(y[0] - y[2]) <= 4 * digit
    assert abs(y[1] - SPEED) <= 4 * digit * np.sqrt(stiffness)


def test_a_motion_above_its_rounding_is_as_exact_as_ever(library: Library) -> None:
    """The same mass let go where its spring is 1e-3 m long: overdamped, in closed form."""
    stiffness, damping, length = 1e6, 3e3, 1e-3
    solver = Solver(library, dragged(stiffness, damping, 1.0), 1e-10)
    solver.start(0, [FAR + length, SPEED, FAR])
    end = 2e-3
    while solver.advance(end) != STOP:
        pass
    y = solver.state[2]
    fast, slow = np.roots([1, damping, stiffness])
    moved = length * (fast * np.exp(slow * end) - slow * np.exp(fast * end)) / (fast - slow)
    # rounding of the place is what the last digits are
    assert abs(y[0] - y[2] - moved) <= 4 * np.spacing(FAR) + 1e-9 * length


def test_what_rounding_stiff_springs_have_hides_no_error_of_their_speed(library: Library) -> None:
    """A mass follows a point that moves as sin t, in steps of 1e6 of its own vibrations."""
    stiffness = 1e13

    def f(t: float, y: np.ndarray) -> list[float]:
        return [y[1], stiffness * (y[2] - y[0]), np.cos(t)]

    entries = [(0, 1), (1, 0), (1, 2)]  # places count coarse, so that the speed sets the steps
    problem = Problem(f, lambda t, y: [1, -stiffness, stiffness], [1e6, 1, 1e6], entries=entries)
    solver = Solver(library, problem, 1e-9, first_step=1e-3)
    solver.start(0, [FAR, 1.0, FAR])
    worst, end = 0.0, 6.0
    outcome = None
    while outcome != STOP:
        outcome = solver.advance(end)
        before, now, *_ = solver.state
        for t in np.linspace(before, now, 20):
            worst = max(worst, abs(solver.interpolate(t)[1] - np.cos(t)))
    assert worst < 1e-8  # ten tolerances
