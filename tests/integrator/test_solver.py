"""What a user of the solver relies on beside accuracy: refusals, re-entrancy, fallbacks, counts."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from integrator.problems import SOLVED, whirl
from integrator.radau import (
    EVENT,
    INVALID_INPUT,
    OUT_OF_DOMAIN,
    STEP,
    STOP,
    BrokenModel,
    IntegrationError,
    Library,
    Problem,
    RefusedState,
    Solver,
)


def oscillator(**more) -> Problem:
    f, jacobian = (lambda t, y: [y[1], -y[0]]), (lambda t, y: [1, -1])
    return Problem(f, jacobian, [1, 1], entries=[(0, 1), (1, 0)], **more)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"tolerance": 0.0}, "tolerance 0 is not in 1e-13 .. 0.1"),
        ({"tolerance": 0.2}, "tolerance 0.2 is not in 1e-13 .. 0.1"),
        ({"tolerance": np.nan}, "tolerance"),
        ({"max_step": 0.0}, "largest step 0 is not positive"),
        ({"max_step": -1.0}, "largest step -1 is not positive"),
        ({"first_step": -1e-3}, "first step -0.001 is negative"),
        ({"first_step": np.inf}, "first step"),
    ],
)
def test_options_out_of_range_are_refused_with_their_value(library: Library, options, words):
    with pytest.raises(IntegrationError, match=words) as error:
        Solver(library, oscillator(), **options)
    assert error.value.code == INVALID_INPUT


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"scale": [1, 0]}, "scale 0 of a state is not positive"),
        ({"scale": [1, -2]}, "scale -2 of a state is not positive"),
        ({"scale": []}, "no states"),
        ({"entries": [(0, 1), (2, 0)]}, "outside the matrix"),
        ({"entries": [(0, 1), (0, -1)]}, "outside the matrix"),
        ({"entries": [(0, 1), (0, 1)]}, "listed twice"),
    ],
)
def test_a_model_that_cannot_be_integrated_is_refused(library: Library, change, words):
    problem = oscillator()
    for name, value in change.items():
        setattr(problem, name, value)
    with pytest.raises(IntegrationError, match=words):
        Solver(library, problem)


def test_a_refused_state_makes_the_step_smaller(library: Library):
    # sqrt is refused below zero; y = (1 - t/2)^2 comes near it, and steps reach beyond
    def f(t: float, y: np.ndarray) -> np.ndarray:
        if y[0] < 0:
            raise RefusedState
        return -np.sqrt(y)

    solver = Solver(library, Problem(f, lambda t, y: -0.5 / np.sqrt(y), [1]), 1e-6)
    end = solver.end(0, [1], 1.9)
    assert end[0] == pytest.approx(0.0025, abs=1e-6)


def test_a_limit_of_the_model_ends_the_integration_with_the_models_words(library: Library):
    def f(t: float, y: np.ndarray) -> list[float]:
        if t > 0.7:
            raise RefusedState
        return [1]

    solver = Solver(library, Problem(f, lambda t, y: 0, [1]), 1e-6)
    with pytest.raises(IntegrationError, match="the test's model refuses") as error:
        solver.end(0, [0], 1)
    assert error.value.code == OUT_OF_DOMAIN
    assert solver.state[1] == pytest.approx(0.7, abs=1e-12)


def test_a_broken_model_ends_the_integration_at_once(library: Library):
    def f(t: float, y: np.ndarray) -> list[float]:
        if t > 0.7:
            raise BrokenModel
        return [1]

    problem = Problem(f, lambda t, y: 0, [1])
    solver = Solver(library, problem, 1e-6, first_step=1)
    with pytest.raises(IntegrationError, match="the test's model refuses"):
        solver.end(0, [0], 1)
    assert problem.calls["f"] == 8  # one lane-wise evaluation


def test_a_solution_that_ends_in_a_pole_stops_before_it(library: Library):
    # y' = y^2, y = 1/(1 - t): in steps that shrink with the distance to 1
    solver = Solver(library, Problem(lambda t, y: y**2, lambda t, y: 2 * y, [1]), 1e-6)
    with pytest.raises(IntegrationError, match="the step fell to"):
        solver.end(0, [1], 2)
    assert solver.state[1] == pytest.approx(1, abs=1e-6)


def test_not_a_number_is_not_taken_for_a_solution(library: Library):
    solver = Solver(library, Problem(lambda t, y: np.nan * y, lambda t, y: 0, [1]), 1e-6)
    with pytest.raises(IntegrationError, match="the step fell to"):
        solver.end(0, [1], 2)


@pytest.mark.parametrize("first_step", [5.0, 20.0])
def test_an_error_that_is_not_a_number_is_not_taken_for_a_small_one(library, first_step):
    """Beside its start, where a step that failed is estimated once more, the model has no rate.

    The error that is told between the nodes is large at 5 and small at 20, where the kink lies
    before the first node and the start alone knows of it.
    """
    kink, end = 0.3, 50.0
    problem = Problem(
        lambda t, y: [np.nan if t == 0 and y[0] != 1 else abs(t - kink)], lambda t, y: 0, [1]
    )
    solver = Solver(library, problem, 1e-9, first_step=first_step)
    found = solver.end(0, [1], end)
    assert solver.counts.rejections >= solver.counts.evaluations >= 1  # those that failed at first
    exact = 1 + (kink**2 + (end - kink) ** 2) / 2
    assert found == pytest.approx([exact], rel=1e-8)


def test_the_last_step_ends_exactly_at_the_stop(library: Library):
    solver = Solver(library, oscillator())
    solver.start(0, [1, 0])
    outcomes = []
    while not outcomes or outcomes[-1] == STEP:
        outcomes.append(solver.advance(0.7))
    assert outcomes[-1] == STOP
    assert solver.state[1] == 0.7
    while solver.advance(1.1) == STEP:
        pass
    assert solver.state[1] == 1.1


def test_a_stop_on_the_way_costs_at_most_a_step_or_two(library: Library):
    steps = []
    for stops in ([20.0], [7.123, 20.0]):
        solver = Solver(library, oscillator())
        solver.start(0, [1, 0])
        for stop in stops:
            while solver.advance(stop) != STOP:
                pass
        steps.append(solver.counts.steps)
    assert steps[1] <= steps[0] + 2


@pytest.mark.parametrize("rest", [1e-2, 1e-5])
def test_the_step_after_a_stop_is_what_it_would_have_been(library: Library, rest: float):
    """However little was left before the stop: from that much steps would grow eightfold each."""
    solver = Solver(library, oscillator())
    times = [t for t, _ in solver.steps(0, [1, 0], 20)]
    stop = times[10] + rest * (times[11] - times[10])
    again = Solver(library, oscillator())
    again.start(0, [1, 0])
    for end in (stop, 20.0):
        while again.advance(end) != STOP:
            pass
    assert again.counts.steps <= solver.counts.steps + 1


def test_few_steps_are_rejected(library: Library):
    """The step after one is 0.9 of what its estimate allows: of Van der Pol's 600 one in sixteen
    fails, at the jumps; without that margin one in five.
    """
    van_der_pol = Problem(
        lambda t, y: [y[1], 5 * (1 - y[0] ** 2) * y[1] - y[0]],
        lambda t, y: [[0, 1], [-10 * y[0] * y[1] - 1, 5 * (1 - y[0] ** 2)]],
        [1, 1],
    )
    solver = Solver(library, van_der_pol, 1e-11)
    solver.end(0, [2, 0], 60)
    assert solver.counts.rejections < solver.counts.steps / 10


def test_two_failures_tell_how_the_error_falls_at_a_jump(library: Library):
    """In proportion to the step, not to its eighth power: from 1 to 1e-9 a step cut to a fifth each
    time fails 45 times, one cut as two failures say about half as often.
    """
    jump = Problem(lambda t, y: [(t > 1) - y[0]], lambda t, y: [[-1]], [1])
    solver = Solver(library, jump)
    end = solver.end(0, [0], 20)
    assert end[0] == pytest.approx(1 - np.exp(-19), rel=1e-8)
    assert solver.counts.rejections <= 30


def test_steps_are_never_longer_than_the_largest_one(library: Library):
    solver = Solver(library, oscillator(), max_step=0.05)
    times = [0.0, *(t for t, _ in solver.steps(0, [1, 0], 3))]
    assert np.diff(times).max() <= 0.05 * (1 + 1e-12)  # the times are rounded


def test_weak_diagonal_pivots_are_answered_by_row_exchanges(library: Library):
    # an undamped rotation at 1e9 1/s about a slow path: gamma/h on the diagonal beside 1e9
    solved = whirl(1e9)
    solver = Solver(library, solved.problem, 1e-6)
    end = solver.end(0, solved.solution(0), solved.end)
    assert solver.counts.dense_factorisations > 0
    assert end == pytest.approx(solved.solution(solved.end), abs=1e-6)


def test_ordinary_problems_need_no_row_exchanges(library: Library):
    for name, solved in SOLVED.items():
        solver = Solver(library, solved.problem, 1e-6)
        solver.end(0, solved.solution(0), solved.end)
        assert solver.counts.dense_factorisations == 0, name


def trace(solver: Solver, steps) -> list[bytes]:
    return [y.tobytes() + np.float64(t).tobytes() for t, y in steps]


def test_two_interleaved_integrations_give_the_bits_of_single_ones(library: Library):
    def solvers():
        a = Solver(library, SOLVED["D3"].problem, 1e-8)
        b = Solver(library, oscillator(roots=lambda t, y: y[0], n_roots=1), 1e-6)
        return (a, a.steps(0, SOLVED["D3"].solution(0), 20)), (b, b.steps(0, [0, 1], 50))

    alone = [trace(*solver) for solver in solvers()]
    (_, steps_a), (_, steps_b) = solvers()
    together: list[list[bytes]] = [[], []]
    rest = [(steps_a, together[0]), (steps_b, together[1])]
    while rest:
        for item in list(rest):
            step = next(item[0], None)
            if step is None:
                rest.remove(item)
            else:
                item[1].append(step[1].tobytes() + np.float64(step[0]).tobytes())
    assert together == alone


def test_a_solver_that_starts_again_gives_the_same_bits(library: Library):
    solver = Solver(library, SOLVED["D2"].problem, 1e-8)
    first = trace(solver, solver.steps(0, SOLVED["D2"].solution(0), 20))
    assert trace(solver, solver.steps(0, SOLVED["D2"].solution(0), 20)) == first


def test_counts_are_those_of_the_models_calls(library: Library):
    problem = oscillator(roots=lambda t, y: y[0], n_roots=1)
    solver = Solver(library, problem)
    solver.end(0, [0, 1], 20)
    counts, calls = solver.counts, problem.calls
    assert calls["jacobian"] == counts.jacobians
    assert calls["f"] == 8 * counts.lane_evaluations + counts.evaluations
    # once a step lane-wise, also for a step that is then cut at an event
    assert calls["roots"] == 8 * counts.steps + counts.root_evaluations
    assert counts.events == 6


def test_an_unchanged_jacobian_is_evaluated_and_factored_rarely(library: Library):
    solver = Solver(library, oscillator())
    solver.end(0, [1, 0], 200)
    assert solver.counts.jacobians < solver.counts.steps / 5


def test_a_linear_model_takes_one_iteration_a_step(library: Library):
    solver = Solver(library, oscillator())
    solver.end(0, [1, 0], 200)
    # the linear model predicts the stages exactly; a few more prove the rate of convergence
    assert solver.counts.lane_evaluations <= 1.05 * solver.counts.steps


class Chain:
    """The chain of oscillators, integrated on a grid by the library itself."""

    def __init__(
        self,
        library: Library,
        masses: int,
        tolerance: float,
        roots: bool = False,
        kick_interval: float = 0.0,
    ) -> None:
        self.c, self.n = library.c, 2 * masses
        self.handle = self.c.rt_new_chain(masses, 100.0, 5.0, 0.1, roots, kick_interval, tolerance)
        self.start = np.zeros(self.n)
        self.start[0], self.start[masses] = 0.3, 1.0

    def __del__(self) -> None:
        self.c.rt_delete(self.handle)

    def grid(self, t_end: float, interval: float, rows: int) -> np.ndarray:
        doubles = ctypes.POINTER(ctypes.c_double)
        t, y, out = np.zeros(1), self.start.copy(), np.full((rows, self.n), np.nan)
        pointers = [a.ctypes.data_as(doubles) for a in (t, y, out)]
        code = self.c.rt_integrate_chain(
            self.handle, pointers[0], pointers[1], t_end, interval, rows, pointers[2]
        )
        assert code == 0
        assert t[0] == t_end
        assert (out[-1] == y).all()
        return out

    def counts(self) -> list[int]:
        numbers = np.zeros(9, np.int32)
        self.c.rt_counts(self.handle, numbers.ctypes.data_as(ctypes.POINTER(ctypes.c_int)))
        return numbers.tolist()


def chain_problem(masses: int) -> Problem:
    """Write the chain once more, in numpy, with a dense Jacobian by differences."""

    def f(t: float, y: np.ndarray) -> np.ndarray:
        u, v = np.zeros(masses + 2), np.zeros(masses + 2)
        u[1:-1], v[1:-1] = y[:masses], y[masses:]
        stretch = np.diff(u)
        force = 100.0 * (stretch + 5.0 * stretch**3) + 0.1 * np.diff(v)
        return np.concatenate([y[masses:], np.diff(force)])

    def jacobian(t: float, y: np.ndarray) -> np.ndarray:
        steps = 1e-30j * np.eye(2 * masses)
        return np.array([complex_f(y + step).imag / 1e-30 for step in steps]).T

    def complex_f(y: np.ndarray) -> np.ndarray:
        u, v = np.zeros(masses + 2, complex), np.zeros(masses + 2, complex)
        u[1:-1], v[1:-1] = y[:masses], y[masses:]
        stretch = np.diff(u)
        force = 100.0 * (stretch + 5.0 * stretch**3) + 0.1 * np.diff(v)
        return np.concatenate([y[masses:], np.diff(force)])

    return Problem(f, jacobian, [1] * masses + [10] * masses)


def test_output_on_a_grid_is_the_dense_output_of_the_steps(library: Library):
    masses, t_end = 4, 3.0
    chain = Chain(library, masses, 1e-8)
    rows = chain.grid(t_end, 0.25, 13)
    solver = Solver(library, chain_problem(masses), 1e-8)
    expected = [chain.start]
    for t, _ in solver.steps(0, chain.start, t_end):
        before = solver.state[0]
        grid = [k * 0.25 for k in range(1, 12) if before < k * 0.25 <= t]
        expected += [solver.interpolate(at) for at in grid]
    expected.append(solver.state[2])
    # two ways to write f, sparse and dense: other steps, each solution with its error
    scale = [1] * masses + [10] * masses
    assert np.abs((rows - expected) / scale).max() <= 2 * 10 * 1e-8


def test_an_interval_that_does_not_divide_the_time_ends_with_the_end(library: Library):
    rows = Chain(library, 2, 1e-8).grid(1.0, 0.3, 5)
    fine = Chain(library, 2, 1e-8).grid(1.0, 0.1, 11)
    # 3*0.1 is not 0.3: the times differ by rounding, at rates of up to 100
    assert np.abs(rows - fine[[0, 3, 6, 9, 10]]).max() <= 1e-13


def test_events_on_the_way_do_not_change_the_output_beyond_the_tolerance(library: Library):
    plain, with_events = Chain(library, 3, 1e-8), Chain(library, 3, 1e-8, roots=True)
    difference = plain.grid(3.0, 0.1, 31) - with_events.grid(3.0, 0.1, 31)
    assert with_events.counts()[8] > 20
    scale = [1, 1, 1, 10, 10, 10]
    assert np.abs(difference / scale).max() <= 2 * 10 * 1e-8


@pytest.mark.parametrize("roots", [False, True])
def test_events_at_given_times_are_met_exactly(library: Library, roots: bool):
    masses, interval = 3, 0.4
    rows = Chain(library, masses, 1e-8, roots, interval).grid(3.0, 0.1, 31)
    solver = Solver(library, chain_problem(masses), 1e-8)
    y, t = Chain(library, masses, 1e-8).start, 0.0
    for kick in range(1, 8):
        y = solver.end(t, y, kick * interval)
        t = kick * interval
        # the output at the time of a kick is that before it
        assert np.abs(rows[4 * kick] - y).max() <= 1e-6
        y[masses] += 1


@pytest.mark.parametrize("masses", [3, 10, 25])
def test_lanes_give_what_single_evaluations_give(library: Library, masses: int):
    chain = Chain(library, masses, 1e-6)
    rows = chain.grid(1.0, 1.0, 2)
    solver = Solver(library, chain_problem(masses), 1e-6)
    end = solver.end(0, chain.start, 1.0)
    assert np.abs(rows[-1] - end).max() <= 1e-6


def test_an_event_leaves_the_outcome_to_the_caller(library: Library):
    solver = Solver(library, oscillator(roots=lambda t, y: y[0], n_roots=1))
    solver.start(0, [0, 1])
    while solver.advance(10) != EVENT:
        pass
    _, t, y, fired = solver.state
    assert fired.tolist() == [-1]
    solver.restart(t, [y[0] + 1, y[1]])  # the state jumps
    solver.advance(t + 1e-3)
    assert solver.state[2][0] == pytest.approx(1, abs=2e-3)


def test_states_on_which_nothing_depends_are_as_exact_as_the_others(library: Library):
    # integrals of an oscillation: y_3 = sin t, y_4 = t/2 + sin(2 t)/4
    problem = Problem(
        lambda t, y: [y[1], -y[0], y[0], y[0] ** 2],
        lambda t, y: [1, -1, 1, 2 * y[0]],
        [1, 1, 1, 1],
        entries=[(0, 1), (1, 0), (2, 0), (3, 0)],
    )
    solver = Solver(library, problem, tolerance=1e-9)
    solver.start(0, [1, 0, 0, 0])
    while solver.advance(10) != STOP:
        before, now, y, _ = solver.state
        for t, state in ((now, y), ((before + now) / 2, solver.interpolate((before + now) / 2))):
            exact = [np.cos(t), -np.sin(t), np.sin(t), t / 2 + np.sin(2 * t) / 4]
            # 10 times the tolerance, as promised in docs/theory/radau.md
            assert np.max(np.abs(state - exact)) < 1e-8


def test_an_integral_is_as_exact_as_its_tolerance_where_its_own_error_chooses_the_steps(
    library: Library,
):
    # y' = 0 beside z' = |t - k|: no other state has an error, and the polynomial that the nodes see
    # hardly knows of the kink
    worst = []
    for kink in np.linspace(0.2, 2.0, 91):
        problem = Problem(
            lambda t, y, k=kink: [0, abs(t - k)], lambda t, y: [0], [1, 1], entries=[(0, 0)]
        )
        solver = Solver(library, problem, 1e-6)
        errors = [
            y[1] - ((t - kink) * abs(t - kink) + kink**2) / 2
            for t, y in solver.steps(0, [1, 0], 2.3)
        ]
        worst.append(np.abs(errors).max())
    # now and then a kink lies where the estimate sees it badly, as docs/theory/radau.md says
    assert np.mean(np.array(worst) <= 10 * 1e-6) > 0.95
    assert max(worst) <= 50 * 1e-6


@pytest.mark.parametrize("scale", [1.0, 1e-3, 1e-5])
def test_the_first_step_is_as_long_as_those_that_follow(library: Library, scale: float):
    # it used to be one in which the state moves by a hundredth of its scale, or by 8 times that
    problem = Problem(lambda t, y: [y[1], -y[0]], lambda t, y: [0, 1, -1, 0], [scale, scale])
    solver = Solver(library, problem, 1e-6)
    times = [0.0, *(t for t, _ in solver.steps(0, [0.6, 0.8], 20))]
    lengths = np.diff(times)
    assert 0.5 * np.median(lengths) < lengths[0] < 2 * np.median(lengths)
    assert solver.counts.rejections <= 1


def test_where_the_jacobian_tells_nothing_a_step_after_an_event_is_as_long_as_that_before(
    library: Library,
):
    # a free body under a load that goes by time; each event is one that was not met before
    omega, levels = 40.0, np.linspace(0.1, 0.9, 9)
    problem = Problem(
        lambda t, y: [y[1], np.cos(omega * t)],
        lambda t, y: [0, 1, 0, 0],
        [1, 1],
        roots=lambda t, y: y[0] - levels,
        n_roots=len(levels),
    )
    solver, now, rejections = Solver(library, problem), 0.0, []
    solver.start(0, [0, 0.5])
    while now < 2:
        outcome = solver.advance(2)
        _, now, y, _ = solver.state
        if outcome == EVENT:
            solver.restart(now, y)
            before = solver.counts.rejections
            solver.advance(2)
            _, now, y, _ = solver.state
            rejections.append(solver.counts.rejections - before)
    assert len(rejections) == len(levels)
    assert sum(rejections) == 0  # there were 16
    exact = [0.5 * 2 + (1 - np.cos(2 * omega)) / omega**2, 0.5 + np.sin(2 * omega) / omega]
    assert y == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-9])
def test_an_integral_takes_what_the_last_iteration_changed(library: Library, tolerance: float):
    # y' = -y^3, z' = y^3: their sum is an invariant of every step that was solved, and z has to
    # move with the last change of y, which may be as large as the iteration's tolerance
    problem = Problem(
        lambda t, y: [-(y[0] ** 3), y[0] ** 3],
        lambda t, y: [-3 * y[0] ** 2, 3 * y[0] ** 2],
        [1, 1],
        entries=[(0, 0), (1, 0)],
    )
    solver = Solver(library, problem, tolerance)
    sums = [y.sum() - 1 for _, y in solver.steps(0, [1, 0], 20.0)]
    assert np.abs(sums).max() <= 1e-13  # rounding of some dozen steps
