"""Contacts that close and open: what the integrator is made for, without gears."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import lambertw

from integrator.events import Recorded, run
from integrator.radau import EVENT, Library, Problem, Solver

Floats = NDArray[np.float64]


class Rattle:
    """A driven mass between two stops with springs and dampers; a contact never pulls.

    Mode 0 is free flight, 1 and -1 contact with the upper and the lower stop. Opening is where the
    force of the contact falls to zero, with the damper's part still at work.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng(seed)
        self.k = 10 ** rng.uniform(2, 6)
        self.c = 2 * rng.uniform(0.01, 0.3) * np.sqrt(self.k)
        self.gap, self.drive = rng.uniform(0.1, 1), rng.uniform(0.5, 3)
        self.frequency = rng.uniform(0.7, 3)
        self.spring = rng.uniform(0, 0.5)
        self.mode = 0

    def contact(self, y: Floats) -> float:
        return self.k * (self.mode * y[0] - self.gap) + self.c * self.mode * y[1]

    def f(self, t: float, y: Floats) -> list[float]:
        free = self.drive * np.cos(self.frequency * t) - self.spring * y[0] - 0.02 * y[1]
        return [y[1], free - self.mode * self.contact(y) * abs(self.mode)]

    def jacobian(self, t: float, y: Floats) -> list[float]:
        contact = abs(self.mode)
        return [1, -self.spring - self.k * contact, -0.02 - self.c * contact]

    def roots(self, t: float, y: Floats) -> list[float]:
        return [y[0] - self.gap, -y[0] - self.gap] if self.mode == 0 else [self.contact(y), 1]

    def directions(self) -> list[int]:
        return [1, 1] if self.mode == 0 else [-1, -1]

    def switch(self, fired: int) -> None:
        self.mode = 0 if self.mode else (1, -1)[fired]

    def reference(self, start: list[float], t_end: float) -> tuple[list[float], Floats]:
        """Return the times of the events and the end, by scipy's DOP853 and its own events."""
        t, y, times = 0.0, np.array(start), []
        while t < t_end:
            events = [lambda t, y, i=i: self.roots(t, y)[i] for i in range(2)]
            for event, direction in zip(events, self.directions(), strict=True):
                event.terminal, event.direction = True, direction
            run = solve_ivp(
                self.f,
                (t, t_end),
                y,
                method="DOP853",
                events=events,
                rtol=1e-12,
                atol=1e-14,
                max_step=1 / np.sqrt(self.k if self.mode else 100),
            )
            t, y = run.t[-1], run.y[:, -1]
            if run.status == 1:
                times.append(t)
                self.switch(0 if len(run.t_events[0]) else 1)
        return times, y


@pytest.mark.parametrize("seed", [1, 2, 3, 5, 8, 13, 21, 34])
def test_a_rattling_mass_closes_and_opens_as_an_independent_program_says(library, seed: int):
    rattle, start, t_end = Rattle(seed), [0.0, 0.5], 8.0
    times, end = rattle.reference(start, t_end)
    rattle.mode = 0

    def change(y: Floats, fired: NDArray[np.int32]) -> Floats:
        rattle.switch(int(np.flatnonzero(fired)[0]))
        return y

    problem = Problem(
        rattle.f,
        rattle.jacobian,
        [1, 1 + 0.1 * np.sqrt(rattle.k)],
        roots=rattle.roots,
        n_roots=2,
        directions=rattle.directions,
        entries=[(0, 1), (1, 0), (1, 1)],
    )
    events, _, solution = run(library, problem, start, t_end, change)
    assert len(times) >= 4
    assert len(events.list) == len(times)
    # impacts amplify the errors made before them; tolerance 1e-9
    assert events.times == pytest.approx(times, abs=1e-7)
    assert solution == pytest.approx(end, abs=1e-6 * np.sqrt(rattle.k) / 10 + 1e-6)


def logarithmic_spring() -> tuple[Problem, Callable[[Floats, NDArray[np.int32]], Floats]]:
    """Fall with 0.05 on a force h/ln(1/h) with damping ratio 0.02, as flanks of involutes do.

    Returned are the problem and what to do when the contact closes, for the first time, or opens.
    """
    mode, small, damping = {"contact": 0}, 1e-8, 0.04

    def force(h: float) -> tuple[float, float]:
        """Odd in h, so that it is smooth enough beyond the event."""
        if h == 0:
            return 0, 0
        w = lambertw(-small * abs(h), -1).real
        return -22 * h / w, -22 / (1 + w)

    def f(t: float, y: Floats) -> list[float]:
        return [y[1], 0.05 - mode["contact"] * (force(y[0])[0] + damping * y[1])]

    def jacobian(t: float, y: Floats) -> list[float]:
        return [1, -mode["contact"] * force(y[0])[1], -mode["contact"] * damping]

    def switch(y: Floats, fired: NDArray[np.int32]) -> Floats:
        mode["contact"] = 1 - mode["contact"]
        return y

    problem = Problem(
        f,
        jacobian,
        [1, 1],
        roots=lambda t, y: force(y[0])[0] + damping * y[1] if mode["contact"] else y[0],
        n_roots=1,
        directions=lambda: [-1] if mode["contact"] else [1],
        entries=[(0, 1), (1, 0), (1, 1)],
    )
    return problem, switch


def bounces_on_a_logarithmic_spring(library: Library, tolerance: float):
    problem, switch = logarithmic_spring()
    return run(library, problem, [-1, 0], 100, switch, tolerance)


def test_a_force_law_with_a_logarithmic_start_is_entered_in_a_few_attempts(library: Library):
    # its slope begins at 0 and its curvature at infinity: the error falls with the second power
    # of the step there, and steps chosen for the eighth failed eight times at every closing
    events, solver, end = bounces_on_a_logarithmic_spring(library, 1e-8)
    exact, _, exact_end = bounces_on_a_logarithmic_spring(library, 1e-12)
    assert len(events.list) == len(exact.list) >= 10
    assert solver.counts.rejections <= 4 * len(events.list)
    # ten times the tolerance; a change d of the speed changes the next flight by 2 d/0.05
    assert events.times == pytest.approx(exact.times, abs=40 * 10 * 1e-8)
    assert end == pytest.approx(exact_end, abs=40 * 10 * 1e-8)


@pytest.mark.parametrize("max_step", [0.01, 0.1, 1.0])
def test_what_opens_while_it_is_compressed_does_not_close_at_once(library, max_step):
    # the damper parts flanks that still overlap: the gap, asked from there on, is negative through
    # all of a short step, though it does not begin at zero
    problem, switch = logarithmic_spring()
    events = Recorded(switch)
    solver = Solver(library, problem, 1e-8, max_step=max_step)
    solver.end(0, [-1, 0], 30, event=events)
    assert [int(fired[0]) for _, _, fired in events.list] == [1, -1, 1, -1]
    assert events.list[1][1][0] > 0.01


def test_a_contact_that_closed_before_is_entered_at_the_first_attempt(library: Library):
    problem, switch = logarithmic_spring()
    solver, now, rejections = Solver(library, problem, 1e-8), 0.0, []
    solver.start(0, [-1, 0])
    while now < 100:
        outcome = solver.advance(100)
        _, now, y, fired = solver.state
        if outcome == EVENT:
            solver.restart(now, switch(y, fired))
            before = solver.counts.rejections
            solver.advance(100)
            rejections.append(solver.counts.rejections - before)
    closings = rejections[::2]
    assert len(closings) >= 5
    # neither f nor its Jacobian tells how the force begins: the first closing is found by trying
    assert closings[0] > 0
    assert closings[1:] == [0] * (len(closings) - 1)
