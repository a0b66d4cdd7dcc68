"""Steps are no longer than what eight nodes can see of the model, and know no other bound."""

from __future__ import annotations

import numpy as np
import pytest

from integrator.radau import EVENT, Library, Problem, Solver

TOUCH = 0.999  # of a cycle's amplitude: it lasts 0.7 % of the cycle twice
TURNS = 40


def turning(rate, slope, **more) -> Problem:
    """An angle alone, which is a polynomial: no error bounds the step."""
    return Problem(lambda t, y: [rate(t)], lambda t, y: [slope], [1], **more)


def touches(library: Library, reach: float, *, speeds_up: bool) -> list[float]:
    """Angles at which cos rises above what it only just reaches, once a turn."""
    solver = Solver(
        library,
        turning(
            (lambda t: 2 * np.pi * TURNS * 2 * t) if speeds_up else lambda t: 2 * np.pi * TURNS,
            0,
            roots=lambda t, y: [np.cos(y[0] - 1) - TOUCH],
            n_roots=1,
            directions=lambda: [1],
            reach=[reach],
        ),
        max_step=1.0,
    )
    angles = []
    solver.start(0, [0])
    while solver.state[1] < 1:
        if solver.advance(1.0) == EVENT:
            _, now, y, _ = solver.state
            angles.append(y[0])
            solver.restart(now, y)
    return angles


@pytest.mark.parametrize("speeds_up", [False, True], ids=["evenly", "from rest"])
def test_what_comes_and_goes_once_a_turn_is_met_in_every_turn(library: Library, speeds_up):
    expected = 1 - np.arccos(TOUCH) + 2 * np.pi * np.arange(TURNS)
    found = touches(library, 2 * np.pi, speeds_up=speeds_up)
    assert found == pytest.approx(expected, abs=1e-9)
    assert len(touches(library, np.inf, speeds_up=speeds_up)) < TURNS  # else this says nothing


def test_no_state_with_a_reach_moves_much_farther_in_a_step(library: Library):
    solver = Solver(library, turning(lambda t: 20 * t, 0, reach=[1.0]))
    angles = np.array([0, *(y[0] for _, y in solver.steps(0, [0], 10.0))])
    assert angles[-1] == pytest.approx(1000)
    assert np.diff(angles).max() <= 1.3
    assert len(angles) <= 1100  # and not much less: no step is lost to it


def test_a_state_that_moves_evenly_goes_its_reach_in_a_step_and_none_is_tried_in_vain(
    library: Library,
):
    solver = Solver(library, turning(lambda t: 20.0, 0, reach=[1.0]))
    angles = np.array([0, *(y[0] for _, y in solver.steps(0, [0], 10.0))])
    # the last one ends the run
    assert np.diff(angles)[:-2] == pytest.approx(1.0, rel=1e-9)
    assert solver.counts.rejections == 0


def test_no_jacobian_is_asked_for_beyond_what_a_step_sees(library: Library):
    asked = []

    def jacobian(t, y):
        asked.append(y[0])
        return [0]

    levels = np.arange(0.25, 10, 0.5)
    problem = Problem(
        lambda t, y: [20.0],
        jacobian,
        [1],
        reach=[1.0],
        roots=lambda t, y: y[0] - levels,
        n_roots=len(levels),
    )
    solver = Solver(library, problem)
    for _, (angle,) in solver.steps(0, [0], 0.5):  # with an event twice a reach
        assert max(asked) <= angle + 1
        assert solver.counts.rejections == 0
    assert solver.counts.events == len(levels)


def test_no_step_passes_over_a_cycle_of_time(library: Library):
    # the state hardly feels it: its errors would let a step run over all of it
    problem = Problem(
        *(lambda t, y: [1e-9 * np.sin(1000 * t)], lambda t, y: [0]), [1], cycle=2 * np.pi / 1000
    )
    times = np.array([0, *(t for t, _ in Solver(library, problem).steps(0, [0], 1.0))])
    assert np.diff(times).max() <= 2 * np.pi / 1000 * (1 + 1e-12)
    problem.cycle = np.inf
    assert len(list(Solver(library, problem).steps(0, [0], 1.0))) < 10


def test_a_longer_integration_begins_with_the_steps_of_a_shorter_one(library: Library):
    def steps(end: float) -> list[bytes]:
        problem = Problem(
            lambda t, y: [y[1], -y[0] - 0.1 * y[0] ** 3],
            lambda t, y: [0, 1, -1 - 0.3 * y[0] ** 2, 0],
            [1, 1],
        )
        solver = Solver(library, problem)
        return [np.array([t, *y]).tobytes() for t, y in solver.steps(0, [1, 0], end)]

    whole = steps(50)
    for end in (1e-3, 7.0, 23.456, 49.9):
        part = steps(end)
        assert part[:-1] == whole[: len(part) - 1]
        assert np.frombuffer(part[-1])[0] == end
