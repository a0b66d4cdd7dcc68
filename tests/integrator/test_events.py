"""Located events against closed forms: every one is found, in the order of time."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from integrator.events import Recorded, run
from integrator.radau import EVENT, Library, Problem, Solver

Floats = NDArray[np.float64]
G = 9.81


def oscillator(roots, n_roots, directions=None) -> Problem:
    return Problem(
        lambda t, y: [y[1], -y[0]],
        lambda t, y: [1, -1],
        [1, 1],
        roots=roots,
        n_roots=n_roots,
        directions=directions,
        entries=[(0, 1), (1, 0)],
    )


def clock(roots, n_roots, directions=None) -> Problem:
    """y' = 1: events are functions of time, and no error control limits the steps."""
    return Problem(
        lambda t, y: 1, lambda t, y: 0, [1], roots=roots, n_roots=n_roots, directions=directions
    )


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9])
def test_a_ball_bounces_40_times_at_the_times_of_the_closed_form(library: Library, tolerance):
    restitution, bounces = 0.8, 40
    problem = Problem(
        lambda t, y: [y[1], -G],
        lambda t, y: 1,
        [1, 1],
        roots=lambda t, y: y[0],
        n_roots=1,
        directions=lambda: [-1],
        entries=[(0, 1)],
    )
    first = np.sqrt(2 / G)
    k = np.arange(bounces)
    exact = first * (1 + 2 * restitution * (1 - restitution**k) / (1 - restitution))
    events, _, _ = run(
        library, problem, [1, 0], exact[-1] + 1e-6, lambda y, _: [0, -restitution * y[1]], tolerance
    )
    assert len(events.list) == bounces
    # a parabola has no error of integration: what remains is rounding of 40 starts
    assert np.abs(events.times - exact).max() <= 1e-12
    speeds = np.array([y[1] for _, y, _ in events.list])
    assert speeds == pytest.approx(-np.sqrt(2 * G) * restitution**k, rel=1e-9)


def test_crossings_of_an_oscillation_alternate_and_lie_at_half_turns(library: Library):
    events, _, _ = run(library, oscillator(lambda t, y: y[0], 1), [0, 1], 40)
    half_turns = np.pi * np.arange(1, 13)
    assert events.times == pytest.approx(half_turns, abs=1e-9)  # the tolerance
    assert events.fired == [[-1], [1]] * 6


@pytest.mark.parametrize(("direction", "starts"), [(-1, np.pi), (1, 2 * np.pi)])
def test_only_crossings_in_the_direction_asked_for_count(library: Library, direction, starts):
    problem = oscillator(lambda t, y: y[0], 1, lambda: [direction])
    events, _, _ = run(library, problem, [0, 1], 40)
    assert events.times == pytest.approx(np.arange(starts, 40, 2 * np.pi), abs=1e-9)
    assert all(fired == [direction] for fired in events.fired)


def test_two_functions_in_one_step_fire_in_the_order_of_time(library: Library):
    # the steps of this problem would be as long as the interval
    times = (3.0, 2.0, 5.5, 2.25)
    problem = clock(lambda t, y: [t - at for at in times], len(times))
    events, solver, _ = run(library, problem, [0], 10)
    assert events.times == pytest.approx(sorted(times), abs=1e-14)
    assert [int(np.flatnonzero(fired)[0]) for fired in events.fired] == [1, 3, 0, 2]
    assert solver.counts.events == 4


def test_two_crossings_of_one_function_in_one_step_are_both_found(library: Library):
    problem = clock(lambda t, y: (t - 4) * (t - 4.5), 1)
    events, _, _ = run(library, problem, [0], 10)
    assert events.times == pytest.approx([4, 4.5], abs=1e-14)
    assert events.fired == [[-1], [1]]


def events_up_to_the_one_at_2(library: Library, other) -> Recorded:
    """Events of t - 2 and of another function, which means nothing after that."""
    mode = {"over": False}

    def change(y: Floats, fired: NDArray[np.int32]) -> Floats:
        mode["over"] = fired[0] != 0
        return y

    problem = clock(lambda t, y: [1, -1] if mode["over"] else [t - 2, other(t)], 2)
    return run(library, problem, [0], 10, change)[0]


@pytest.mark.parametrize("half", [1e-2, 1e-3, 1e-4])
def test_a_function_above_zero_at_the_event_of_another_has_crossed_before(library, half: float):
    # a bump narrower than any distance of the nodes: only the event in its midst shows it
    bump = half / np.sqrt(np.log(2))
    events = events_up_to_the_one_at_2(library, lambda t: np.exp(-(((t - 2) / bump) ** 2)) - 0.5)
    assert events.fired == [[0, 1], [1, 0]]
    # the time has digits of 4e-16
    assert events.times == pytest.approx([2 - half, 2], abs=1e-14)


@pytest.mark.parametrize("seed", range(20))
def test_of_three_crossings_between_two_nodes_the_one_before_another_event_comes_first(
    library: Library, seed: int
) -> None:
    before, *after = np.random.default_rng(seed).uniform(1e-3, 5e-2, 3)
    times = [2 - before, *(2 + at for at in after)]
    events = events_up_to_the_one_at_2(library, lambda t: 1e6 * np.prod([t - at for at in times]))
    assert events.fired == [[0, 1], [1, 0]]
    assert events.times == pytest.approx([times[0], 2], abs=1e-13)


@pytest.mark.parametrize("depth", [1e-2, 1e-4, 1e-6, 1e-8])
def test_a_touch_and_return_between_two_stages_is_found(library: Library, depth: float):
    # y = sin t rises past 1 - depth for a time of 2 sqrt(2 depth): no stage may lie in it
    events, _, _ = run(library, oscillator(lambda t, y: y[0] - (1 - depth), 1), [0, 1], 50)
    half = np.arccos(1 - depth)
    tops = np.pi / 2 + 2 * np.pi * np.arange(8)
    exact = np.ravel([tops - half, tops + half], order="F")
    assert events.fired == [[1], [-1]] * 8
    # the slope of the function there is `half`: an error e of y moves the crossing by e/half
    assert np.abs(events.times - exact).max() <= 1e-12 / half + 1e-12


@pytest.mark.parametrize("direction", [1, -1])
def test_a_touch_and_return_counts_in_the_direction_asked_for(library: Library, direction: int):
    problem = clock(lambda t, y: (t - 3.3) ** 2 - 1e-6, 1, lambda: [direction])
    events, _, _ = run(library, problem, [0], 10)
    assert events.times == pytest.approx([3.3 + 1e-3 * direction], abs=1e-11)


def test_a_function_that_comes_near_zero_and_turns_does_not_fire(library: Library):
    events, _, _ = run(library, oscillator(lambda t, y: y[0] - (1 + 1e-6), 1), [0, 1], 50)
    assert not events.list


def test_functions_that_cross_at_the_same_time_fire_together(library: Library):
    problem = clock(lambda t, y: [t - 2, 2 - y[0], 5 * (y[0] - 2), t - 3], 4)
    events, solver, _ = run(library, problem, [0], 10)
    assert events.fired == [[1, -1, 1, 0], [0, 0, 0, 1]]
    assert solver.counts.events == 2


def test_functions_that_cross_almost_at_the_same_time_are_none_lost(library: Library):
    times = 2 + np.array([0, 1e-15, 1e-14, 1e-13, 1e-12, 1e-10, 1e-8, 1e-6])
    events, _, _ = run(library, clock(lambda t, y: y[0] - times, len(times)), [0], 10)
    assert np.sum(events.fired, axis=0).tolist() == [1] * len(times)
    for t, _, fired in events.list:
        # t and y pass 2 in units of 4e-16, and the search ends within a few of them
        assert np.abs(t - times[np.flatnonzero(fired)]).max() <= 1e-11
    assert sorted(events.times) == events.times.tolist()


def test_two_balls_that_land_at_once_are_both_reflected(library: Library):
    # dropped from 1 m, and thrown up from 0.25 m so that it lands at the same time
    fall = np.sqrt(2 / G)
    throw = (G * fall**2 / 2 - 0.25) / fall

    def bounce(y: Floats, fired: NDArray[np.int32]) -> Floats:
        for ball in np.flatnonzero(fired):
            y[2 * ball : 2 * ball + 2] = 0, -y[2 * ball + 1]
        return y

    problem = Problem(
        lambda t, y: [y[1], -G, y[3], -G],
        lambda t, y: [1, 1],
        [1] * 4,
        roots=lambda t, y: [y[0], y[2]],
        n_roots=2,
        directions=lambda: [-1, -1],
        entries=[(0, 1), (2, 3)],
    )
    events, _, end = run(library, problem, [1, 0, 0.25, throw], 1.5 * fall, bounce)
    assert np.sum(events.fired, axis=0).tolist() == [-1, -1]
    t = 0.5 * fall
    expected = [G * fall * t - G * t**2 / 2, (G * fall - throw) * t - G * t**2 / 2]
    assert end[[0, 2]] == pytest.approx(expected, abs=1e-12)


def test_a_function_that_is_zero_at_the_start_fires_when_it_comes_back(library: Library):
    events, _, _ = run(library, oscillator(lambda t, y: y[0], 1), [0, 1], 4)
    assert events.times == pytest.approx([np.pi], abs=1e-9)


def test_a_function_that_fired_fires_again_however_soon_it_comes_back(library: Library):
    # a hop of 1e-9 s within steps of up to 1e-3 s: up and down before the first stage
    hops = 1e-9
    problem = Problem(
        lambda t, y: [y[1], -G],
        lambda t, y: 1,
        [1, 1],
        roots=lambda t, y: y[0],
        n_roots=1,
        directions=lambda: [-1],
        entries=[(0, 1)],
    )
    events = Recorded(lambda y, _: [0, G * hops / 2])
    solver = Solver(library, problem, 1e-9)
    solver.start(0, [G * 1e-6 / 2, 0])
    while len(events.list) < 5:
        if solver.advance(1) == EVENT:
            _, t, y, fired = solver.state
            solver.restart(t, events(t, y, fired))
    assert np.diff(events.times) == pytest.approx(hops, rel=1e-6)  # t is 1e-3 in units of 2e-19


def test_a_function_that_rounding_moves_across_zero_at_the_start_fires_there(library: Library):
    mode = {"second": False}

    def roots(_, y: Floats) -> list[float]:
        # the second one is below zero where it begins, and above it 4e-15 s later
        second = y[0] - 5e-15 + (1e-14 if y[0] > 4e-15 else 0)
        return [y[0], second if mode["second"] else -1]

    def begin(y: Floats, _: NDArray[np.int32]) -> list[float]:
        mode["second"] = True
        return [0]

    events = Recorded(begin)
    Solver(library, clock(roots, 2), 1e-9).end(0, [-1], 2, event=events)
    assert events.fired == [[1, 0], [0, 1]]
    assert events.times == pytest.approx([1, 1], abs=1e-12)


@pytest.mark.parametrize("above", [3e-11, 1e-9])
def test_a_function_that_fired_and_never_came_back_to_its_side_fires_where_it_began(
    library: Library, above: float
):
    """A gap opens at t = 1 so slowly that it closes before rounding lets it open: flanks graze."""
    events = Recorded()

    def roots(_: float, y: Floats) -> list[float]:
        since = y[0] - 1
        # once it has fallen, it is above zero already, falls by less than that, and rises for good
        return [[-since], [above - 1e-9 * since + since**2], [1]][min(len(events.list), 2)]

    problem = clock(roots, 1, lambda: [-1 if not events.list else 1])
    Solver(library, problem, 1e-9).end(0, [0], 2, event=events)
    assert events.fired == [[-1], [1]]
    assert events.times == pytest.approx([1, 1], abs=1e-9)


@pytest.mark.parametrize("until", [0.3, 0.03])
def test_a_function_that_grazed_zero_fires_on_its_way_back_though_it_falls_again(
    library: Library, until: float
):
    """It is below zero by less than rounding, and above it for a part of the next step."""
    events = Recorded()

    def roots(_: float, y: Floats) -> list[float]:
        since = y[0] - 1
        return [[-since], [since * (1 - since / until) - 1e-11], [1]][min(len(events.list), 2)]

    problem = clock(roots, 1, lambda: [-1 if not events.list else 1])
    Solver(library, problem, 1e-9).end(0, [0], 2, event=events)
    assert events.fired == [[-1], [1]]
    assert events.times == pytest.approx([1, 1], abs=1e-9)


def test_an_event_lies_at_zero_though_time_is_too_coarse_for_that(library: Library):
    """At 1000 s one digit of the time is 1e-5 of a function that runs through its size in 10 ns."""
    levels = (0.3, 0.3 + 3e-6, 0.3 + 2e-5, 0.6)
    found: list[float] = []

    def pass_one(_: float, y: Floats, fired: NDArray[np.int32]) -> Floats:
        found.append(y[0] - levels[len(found)])
        return y

    problem = Problem(
        lambda t, y: 1e8,
        lambda t, y: 0,
        [1],
        roots=lambda t, y: y[0] - levels[len(found)] if len(found) < len(levels) else -1,
        n_roots=1,
        directions=lambda: [1],
    )
    Solver(library, problem, 1e-9).end(1000, [0], 1000 + 1e-8, event=pass_one)
    assert len(found) == len(levels)
    assert np.abs(found).max() <= 1e-8  # what the discrete state takes for zero


def test_a_function_that_is_identically_zero_never_fires(library: Library):
    events, _, _ = run(library, oscillator(lambda t, y: [0 * t, y[1]], 2), [0, 1], 10)
    assert np.abs(np.sum(np.abs(events.fired), axis=0)).tolist() == [0, 3]


def test_a_switch_of_the_right_hand_side_is_located_and_costs_no_accuracy(library: Library):
    # |x|' chain: x'' = -k x with k = 1 for x > 0 and 4 for x < 0; half periods pi and pi/2
    mode = {"k": 1.0}

    def switch(y: Floats, fired: NDArray[np.int32]) -> Floats:
        mode["k"] = 4.0 if fired[0] < 0 else 1.0
        return y

    problem = Problem(
        lambda t, y: [y[1], -mode["k"] * y[0]],
        lambda t, y: [1, -mode["k"]],
        [1, 1],
        roots=lambda t, y: y[0],
        n_roots=1,
        entries=[(0, 1), (1, 0)],
    )
    events, _, end = run(library, problem, [0, 1], 15 * np.pi, switch)
    assert events.times[:-1] == pytest.approx(
        np.pi * np.ravel([1 + 1.5 * np.arange(10), 1.5 * np.arange(1, 11)], order="F")[:-1],
        abs=1e-9,
    )
    assert end == pytest.approx([0, 1], abs=1e-9)


def test_a_step_ends_at_the_event_in_sight(library: Library):
    asked: list[float] = []

    def f(t: float, y: Floats) -> list[float]:
        asked.append(t)
        return [y[1], -y[0]]

    problem = replace(oscillator(lambda t, y: y[0], 1), f=f)
    solver, now, beyond = Solver(library, problem), 0.0, []
    solver.start(0, [1, 0])
    while now < 30:
        outcome = solver.advance(30)
        _, now, y, _ = solver.state
        if outcome == EVENT:
            beyond.append(max(asked) - now)
            solver.restart(now, y)
            asked.clear()
    # not the first one: it lies in a step that has grown too fast to be continued so far
    assert len(beyond) == 10
    assert max(beyond[1:]) <= 1e-4


def test_an_event_ends_the_step_and_the_dense_output_ends_there(library: Library):
    solver = Solver(library, oscillator(lambda t, y: y[0] - 0.5, 1), 1e-9)
    solver.start(0, [0, 1])
    while solver.advance(10) != EVENT:
        pass
    before, t, y, _ = solver.state
    assert t == pytest.approx(np.pi / 6, abs=1e-12)
    assert before < t
    assert solver.interpolate(t) == pytest.approx(y, abs=1e-15)
    inside = (before + t) / 2
    assert solver.interpolate(inside)[0] == pytest.approx(np.sin(inside), abs=1e-8)


def harmonic_crossings(level, order, phase, direction, w, t_end) -> list[tuple[float, int, int]]:
    """Return (time, function, direction) where cos(order w t + phase) passes its level."""
    found = []
    for i in np.flatnonzero(np.abs(level) < 1):
        angle = np.arccos(level[i])
        for turn, side in itertools.product(range(-2, 40), (1, -1)):
            t = (side * angle - phase[i] + 2 * np.pi * turn) / (order[i] * w)
            if 0 < t < t_end and direction[i] in (0, -side):
                found.append((t, int(i), -side))
    return sorted(found)


@pytest.mark.parametrize("seed", range(40))
def test_harmonics_of_a_rotation_cross_random_levels_as_often_as_the_closed_form(library, seed):
    # levels up to 1.05: some are only touched, some never; orders up to 3 within one step
    rng = np.random.default_rng(seed)
    tolerance, w = 10.0 ** -rng.integers(4, 12), 10 ** rng.uniform(-1, 2)
    n = int(rng.integers(1, 5))
    level, phase = rng.uniform(-1.05, 1.05, n), rng.uniform(0, 2 * np.pi, n)
    order, direction = rng.integers(1, 4, n), rng.integers(-1, 2, n)
    problem = Problem(
        lambda t, y: [-w * y[1], w * y[0]],
        lambda t, y: [-w, w],
        [1, 1],
        roots=lambda t, y: ((y[0] + 1j * y[1]) ** order * np.exp(1j * phase)).real - level,
        n_roots=n,
        directions=lambda: direction,
        entries=[(0, 1), (1, 0)],
    )
    events, _, _ = run(library, problem, [1, 0], 20 / w, tolerance=tolerance)
    found = [(t, i, f) for t, _, fired in events.list for i, f in enumerate(fired) if f]
    expected = harmonic_crossings(level, order, phase, direction, w, 20 / w)
    assert [event[1:] for event in found] == [event[1:] for event in expected]
    for (t, *_), (exact, *_) in zip(found, expected, strict=True):
        assert abs(t - exact) * w <= 10 * tolerance
