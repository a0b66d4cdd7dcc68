"""Vibrations that grow: the method would damp them in long steps, and steps are cut where it would.

A mode with eigenvalue lambda is multiplied by R(h lambda) in a step of h. For Radau IIA with s
stages R is the Pade approximant of exp with degrees s - 1 and s, of which the coefficients are
known in closed form (HW IV.5).
"""

from __future__ import annotations

from math import comb, factorial

import numpy as np
import pytest

from integrator.radau import (
    GROWTH_BY_COUPLING,
    GROWTH_BY_DAMPING,
    GROWTH_NEVER,
    Library,
    Problem,
    Solver,
)

STAGES = 7
REACH = 5.5  # of |h lambda|, as docs/theory/radau.md has it
OMEGA = 1000.0  # of the oscillator [rad/s]
SEED = 1e-13  # amplitude from which it grows, far below the tolerance of 1e-9


def stability(z: complex) -> complex:
    """R(z)."""
    k, m = STAGES - 1, STAGES

    def sum_of(degree: int, sign: int) -> complex:
        return sum(
            factorial(k + m - j) / factorial(k + m) * comb(degree, j) * (sign * z) ** j
            for j in range(degree + 1)
        )

    return sum_of(k, 1) / sum_of(m, -1)


def direction(damping: float) -> complex:
    """Eigenvalue of size 1 of a mode with this damping ratio."""
    return complex(-damping, np.sqrt(1 - damping**2))


def oscillator(damping: float, growth: int) -> Problem:
    """x'' = -2 d w x' - w^2 x beside y' = cos t - y, which alone decides the steps."""
    return Problem(
        lambda t, y: [y[1], -2 * damping * OMEGA * y[1] - OMEGA**2 * y[0], np.cos(t) - y[2]],
        lambda t, y: [1, -(OMEGA**2), -2 * damping * OMEGA, -1],
        [1, OMEGA, 1],
        entries=[(0, 1), (1, 0), (1, 1), (2, 2)],
        growth=growth,
    )


def amplitude(y) -> float:
    return float(np.hypot(y[0], y[1] / OMEGA))


def grown(library: Library, damping: float, growth: int, end: float, **options) -> Solver:
    """Integrate from next to nothing."""
    solver = Solver(library, oscillator(damping, growth), **options)
    solver.end(0, [SEED, -damping * OMEGA * SEED, 0], end)
    return solver


@pytest.mark.parametrize("damping", [-0.01, -0.1, -0.5])
def test_a_step_multiplies_a_mode_by_the_pade_approximant(library: Library, damping: float):
    for reach in (1.0, REACH, 12.0):
        h = reach / OMEGA
        solver = Solver(library, oscillator(damping, GROWTH_NEVER), 0.1, max_step=h, first_step=h)
        solver.start(0, [1e-6, 0, 0])
        solver.advance(10 * h)
        z = reach * direction(damping)
        # x = Re(c e^(lambda t)) with x(0) = 1e-6, x'(0) = 0
        c = 1e-6 * (1 + 1j * z.real / z.imag)
        expected = (c * stability(z)).real
        assert solver.state[2][0] == pytest.approx(expected, rel=1e-9, abs=1e-16)


@pytest.mark.parametrize("damping", [1e-4, 1e-3, 0.01, 0.1, 0.3, 0.6])
def test_growth_is_followed_within_the_reach(damping: float):
    reaches = np.linspace(0.5, REACH, 51)
    z = reaches * direction(-damping)
    error = np.array([np.log(abs(stability(x))) for x in z]) - z.real
    # docs/theory/radau.md: 2e-5 of |z|, and 0.5 % of the growth where damping is strong
    assert np.all(abs(error) <= 2e-5 * reaches + 5e-3 * z.real)


def test_beyond_the_reach_a_long_step_damps_what_grows():
    for damping, decays_at in ((1e-3, 8.2), (0.01, 10.7), (0.16, 19.6)):
        assert abs(stability(decays_at * direction(-damping))) < 1


@pytest.mark.parametrize("first_step", [0.0, 1e-6, 1e-3, 8.0 / OMEGA, 10.0 / OMEGA, 1.0])
@pytest.mark.parametrize("growth", [GROWTH_BY_COUPLING, GROWTH_BY_DAMPING])
def test_a_vibration_that_nothing_excites_grows_as_it_should(library, growth, first_step):
    damping, end = -0.01, 2.5
    solver = grown(library, damping, growth, end, first_step=first_step)
    expected = SEED * np.exp(-damping * OMEGA * end)
    # 1 % of the amplitude is its swing within a period, 2 d; the rest that of the steps before the
    # first look, at most eight of coupled forces
    assert amplitude(solver.state[2]) == pytest.approx(expected, rel=0.05)
    # what is known to grow limits the steps: none is tried in vain but where that is found out
    assert solver.counts.growth_cuts <= 2


def test_without_the_look_at_growth_it_would_be_damped(library: Library):
    solver = grown(library, -0.01, GROWTH_NEVER, 2.5)
    assert amplitude(solver.state[2]) < SEED
    assert solver.counts.steps < 50


@pytest.mark.parametrize("growth", [GROWTH_BY_COUPLING, GROWTH_BY_DAMPING])
@pytest.mark.parametrize("damping", [0.0, 1e-3, 0.01, 1.5])
def test_what_decays_costs_no_step(library: Library, damping: float, growth: int):
    plain, looked_at = (grown(library, damping, g, 2.5) for g in (GROWTH_NEVER, growth))
    assert np.array_equal(plain.state[2], looked_at.state[2])  # to the bit
    assert plain.counts == looked_at.counts._replace(evaluations=plain.counts.evaluations)
    assert looked_at.growth == (0, 0)


@pytest.mark.parametrize("growth", [GROWTH_BY_COUPLING, GROWTH_BY_DAMPING])
def test_slow_growth_costs_no_step(library: Library, growth: int):
    # y'' = y/100 grows within 10 s; a step is never 5 times as long
    problem = Problem(
        lambda t, y: [y[1], y[0] / 100],
        lambda t, y: [1, 0.01],
        [1, 1],
        entries=[(0, 1), (1, 0)],
        growth=growth,
    )
    solver = Solver(library, problem)
    end = solver.end(0, [1, 0], 20)
    assert end[0] == pytest.approx(np.cosh(2), rel=1e-8)
    assert solver.counts.growth_cuts == 0


def test_the_fastest_growth_is_told_with_its_time(library: Library):
    solver = grown(library, -0.01, GROWTH_BY_DAMPING, 2.0)
    t, eigenvalue = solver.growth
    assert 0 <= t <= 2.0
    assert eigenvalue == pytest.approx(OMEGA * direction(-0.01), rel=1e-12)
    assert solver.counts.growth_cuts >= 1


def test_of_growth_that_changes_the_fastest_is_told(library: Library):
    # x'' = -2 d w x' - w^2 x with d = -0.01 (1 + sin^2 (pi t)): it grows fastest at t = 1/2
    def ratio(t: float) -> float:
        return -0.01 * (1 + np.sin(np.pi * t) ** 2)

    problem = Problem(
        lambda t, y: [y[1], -2 * ratio(t) * OMEGA * y[1] - OMEGA**2 * y[0], np.cos(t) - y[2]],
        lambda t, y: [1, -(OMEGA**2), -2 * ratio(t) * OMEGA, -1],
        [1, OMEGA, 1],
        entries=[(0, 1), (1, 0), (1, 1), (2, 2)],
        growth=GROWTH_BY_DAMPING,
    )
    solver = Solver(library, problem)
    solver.end(0, [SEED, 0, 0], 1.0)
    t, eigenvalue = solver.growth
    assert eigenvalue == pytest.approx(OMEGA * direction(ratio(t)), rel=1e-12)
    # it is looked at in every fourth step of at most 5.5/w: a look is that near to the top
    assert abs(t - 0.5) <= 4 * REACH / OMEGA


@pytest.mark.parametrize("first", ["creeps", "swings"])
def test_a_vibration_is_told_before_a_motion_that_runs_away_faster(library: Library, first: str):
    """One before t = 1, the other behind it; z' = 400 z has a decay of 400 at other times."""

    def swings(t: float) -> float:
        return 0.01 * np.tanh((t - 1) / 0.01) * (-1 if first == "creeps" else 1)

    def creeps(t: float) -> float:
        return 400 * np.tanh((t - 1) / 0.01) * (-1 if first == "creeps" else 1)

    problem = Problem(
        lambda t, y: [
            *(y[1], -2 * swings(t) * OMEGA * y[1] - OMEGA**2 * y[0]),
            *(np.cos(t) - y[2], creeps(t) * y[3]),
        ],
        lambda t, y: [1, -(OMEGA**2), -2 * swings(t) * OMEGA, -1, creeps(t)],
        [1, OMEGA, 1, 1],
        entries=[(0, 1), (1, 0), (1, 1), (2, 2), (3, 3)],
        growth=GROWTH_BY_DAMPING,
    )
    solver = Solver(library, problem)
    solver.end(0, [0, 0, 0, 0], 2.0)
    t, eigenvalue = solver.growth
    assert eigenvalue == pytest.approx(OMEGA * direction(swings(t)), rel=1e-12)
    assert eigenvalue.real < 400


def test_damping_that_turns_negative_on_the_way_is_met(library: Library):
    # x'' = -2 d w x' - w^2 x with d = 0.01 cos t, negative from pi/2 to 3 pi/2
    problem = Problem(
        lambda t, y: [y[1], -0.02 * np.cos(t) * OMEGA * y[1] - OMEGA**2 * y[0], np.cos(t) - y[2]],
        lambda t, y: [1, -(OMEGA**2), -0.02 * np.cos(t) * OMEGA, -1],
        [1, OMEGA, 1],
        entries=[(0, 1), (1, 0), (1, 1), (2, 2)],
        growth=GROWTH_BY_DAMPING,
    )
    solver = Solver(library, problem)
    start, end = np.pi / 2, 3 * np.pi / 2 - 0.1
    solver.end(start, [SEED, 0, 0], end)
    growth = -0.01 * OMEGA * (np.sin(end) - np.sin(start))
    # slow change of d: the amplitude is SEED e^growth within d; the onset is met within a step
    assert amplitude(solver.state[2]) == pytest.approx(SEED * np.exp(growth), rel=0.1)


@pytest.mark.parametrize("share", [0.55, 0.7, 0.85])
def test_growth_that_begins_behind_the_middle_of_the_last_step_is_told(
    library: Library, share: float
) -> None:
    """Damped until `share` of the one step of the run; no later step would look at it."""
    h = 0.4

    def ratio(t: float) -> float:
        return 0.05 * np.tanh((share * h - t) / 0.01)

    problem = Problem(
        lambda t, y: [y[1], -2 * ratio(t) * OMEGA * y[1] - OMEGA**2 * y[0], np.cos(t) - y[2]],
        lambda t, y: [1, -(OMEGA**2), -2 * ratio(t) * OMEGA, -1],
        [1, OMEGA, 1],
        entries=[(0, 1), (1, 0), (1, 1), (2, 2)],
        growth=GROWTH_BY_DAMPING,
    )
    solver = Solver(library, problem, first_step=h, max_step=h)
    solver.end(0, [SEED, 0, 0], h)
    assert solver.counts.growth_cuts >= 1
    t, eigenvalue = solver.growth
    assert share * h < t <= h
    assert eigenvalue == pytest.approx(OMEGA * direction(ratio(t)), rel=1e-12)


def test_a_second_start_gives_the_bits_of_the_first(library: Library):
    solver = Solver(library, oscillator(-0.01, GROWTH_BY_DAMPING))
    ends = [solver.end(0, [SEED, 0, 0], 2.0) for _ in range(2)]
    assert np.array_equal(*ends)


NONE = np.finfo(float).max  # longest step where nothing grows


def vibration(damping: float) -> list[list[float]]:
    """The Jacobian of a mode of OMEGA with this damping ratio."""
    return [[0, 1], [-(OMEGA**2), -2 * damping * OMEGA]]


def test_damping_that_turns_by_more_than_the_slowest_mode_decays_is_noticed(library: Library):
    """What is near a Jacobian of which nothing grows is not looked at: near is by its decay."""
    looks = [(vibration(damping), 5.4 / OMEGA, False) for damping in (1e-3, -1e-3)]
    decays, grows = library.looks_at_growth([1, OMEGA], looks)
    assert decays.longest == NONE
    assert grows.longest == pytest.approx(5 / OMEGA, rel=1e-12)
    assert grows.eigenvalue == pytest.approx(OMEGA * direction(-1e-3), rel=1e-12)


def test_growth_that_steps_follow_is_told_as_it_changes(library: Library):
    """A Jacobian of which something grows is not kept as harmless, however short the steps."""
    looks = [(vibration(damping), 1 / OMEGA, False) for damping in (-0.01, -0.02)]
    found = library.looks_at_growth([1, OMEGA], looks)
    for damping, look in zip((-0.01, -0.02), found, strict=True):
        assert look.longest == pytest.approx(5 / OMEGA, rel=1e-12)
        assert look.eigenvalue == pytest.approx(OMEGA * direction(damping), rel=1e-12)


EARLIER = {
    # -1 twice, then -1 + 2 and -1 - 2: it creeps away, within reach of a step of 0.05
    "matrices": ([1, 1], [[-1, 100], [0, -1]], [[-1, 100], [0.04, -1]], 0.05),
    # two springs whose states have other sizes: that is what makes the bound a close one
    "sizes": ([1, OMEGA], [[0, 1e18], [-1e-12, 0]], vibration(1e-3), 5.4 / OMEGA),
}


@pytest.mark.parametrize("case", EARLIER.values(), ids=EARLIER.keys())
def test_an_integration_knows_nothing_of_an_earlier_one(library: Library, case):
    scale, earlier, jacobian, step = case
    goes_on, anew, first = (
        library.looks_at_growth(scale, looks)[-1]
        for looks in (
            [(earlier, step, False), (jacobian, step, False)],
            [(earlier, step, False), (jacobian, step, True)],
            [(jacobian, step, False)],
        )
    )
    assert anew == first
    assert goes_on != first  # which this integration would know


MASSES = 100  # a chain whose eigenvalues are sought in pieces, since it has more than 150 states


def chain(damping, stiffness: float, growth: int) -> tuple[Problem, np.ndarray]:
    """Masses of about OMEGA, each with a damping ratio, springs between neighbours; and y'."""
    n = 2 * MASSES
    rng = np.random.default_rng(19)
    omega = OMEGA * rng.uniform(0.8, 1.2, MASSES)
    between = stiffness * OMEGA**2 * (np.eye(MASSES, k=1) + np.eye(MASSES, k=-1))
    matrix = np.zeros((n + 1, n + 1))
    matrix[:MASSES, MASSES:n] = np.eye(MASSES)
    matrix[MASSES:n, :MASSES] = between - np.diag(omega**2 + between.sum(axis=1))
    matrix[MASSES:n, MASSES:n] = np.diag(-2 * np.asarray(damping) * omega)
    matrix[n, n] = -1
    drive = np.eye(n + 1)[n]
    entries = [(int(i), int(j)) for i, j in np.argwhere(matrix != 0)]
    values = [matrix[entry] for entry in entries]
    scale = np.repeat([1.0, OMEGA, 1.0], [MASSES, MASSES, 1])
    problem = Problem(
        lambda t, y: matrix @ y + np.cos(t) * drive,
        lambda t, y: values,
        scale,
        entries=entries,
        growth=growth,
    )
    return problem, matrix[:n, :n]


@pytest.mark.parametrize("growth", [GROWTH_BY_COUPLING, GROWTH_BY_DAMPING])
@pytest.mark.parametrize("stiffness", [0.01, 0.5], ids=["modes of few masses", "modes of many"])
@pytest.mark.parametrize("who", ["one mass", "all masses"])
def test_a_vibration_grows_in_a_long_chain_as_it_should(library, who, stiffness, growth):
    damping = np.full(MASSES, 0.002 if who == "one mass" else -0.01)
    damping[57] = -0.4 if who == "one mass" and stiffness > 0.1 else -0.015
    problem, matrix = chain(damping, stiffness, growth)
    eigenvalues, vectors = np.linalg.eig(matrix)
    assert eigenvalues.real.max() > 1  # [1/s], of a mode that swings
    start, end = np.zeros(2 * MASSES), 15 / eigenvalues.real.max()
    start[::3] = SEED
    # from SEED by a factor of about a million, still below the tolerance
    parts = np.exp(eigenvalues * end) * np.linalg.solve(vectors, start)
    expected = (vectors @ parts).real / np.repeat([1, OMEGA], MASSES)
    solver = Solver(library, problem)
    found = solver.end(0, [*start, 0], end)[:-1] / np.repeat([1, OMEGA], MASSES)
    # that of the steps before the first look, as above
    assert np.linalg.norm(found) == pytest.approx(np.linalg.norm(expected), rel=0.1)
    assert solver.counts.growth_cuts >= 1


@pytest.mark.parametrize("growth", [GROWTH_BY_COUPLING, GROWTH_BY_DAMPING])
def test_what_decays_in_a_long_chain_costs_no_step(library: Library, growth: int):
    solvers = []
    for kind in (GROWTH_NEVER, growth):
        problem, _ = chain(np.full(MASSES, 0.01), 0.5, kind)
        solvers.append(Solver(library, problem))
        solvers[-1].end(0, [SEED, *np.zeros(2 * MASSES)], 2.0)
    plain, looked_at = solvers
    assert np.array_equal(plain.state[2], looked_at.state[2])  # to the bit
    assert looked_at.growth == (0, 0)


@pytest.mark.parametrize("n", [1, 2, 3, 4, 7, 12, 30])
def test_eigenvalues_agree_with_lapack(library: Library, n: int):
    rng = np.random.default_rng(n)
    for turn in range(20):
        matrix = rng.normal(size=(n, n))
        if turn % 2:  # states of different units, as displacements beside speeds
            units = 10.0 ** rng.uniform(-4, 4, n)
            matrix *= units[:, None] / units
        found, expected = library.eigenvalues(matrix), np.linalg.eigvals(matrix)
        distance = abs(found[:, None] - expected).min(axis=1)
        # eps times the condition of the eigenvalues of a random matrix, below 1e4
        assert distance.max() <= 1e-10 * abs(expected).max()


def test_eigenvalues_of_special_matrices_are_found(library: Library):
    assert np.array_equal(library.eigenvalues(np.zeros((3, 3))), np.zeros(3))
    rotation = library.eigenvalues(
        [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    )  # shifts of Francis stand still
    assert abs(rotation**3 - 1).max() < 1e-14
    double = library.eigenvalues([[0, 1, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1], [0, 0, -4, 0]])
    assert sorted(double.imag) == pytest.approx([-2, 0, 0, 2])
    assert library.eigenvalues([[np.nan, 1], [0, 1]]) is None
