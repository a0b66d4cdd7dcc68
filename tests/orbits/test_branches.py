"""Branches of orbits through folds, and the points where their stability changes, against closed forms and other programs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq, fsolve

from orbits.orbits import OrbitError, Point, System, special
from orbits.test_flow_derivative import product
from orbits.test_orbits import swept


def is_stable(point: Point) -> bool:
    return bool(max(abs(point.multipliers)) < 1)


# ---- closed forms ----


@pytest.fixture(scope="module")
def boundaries(c):
    """Follow the state at rest of Meissner's equation over the frequency."""

    def follow(ratio: float, damping: float, between: tuple[float, float]) -> list[Point]:
        system = System(c, "meissner", [between[0], ratio, damping, 0])
        system.options(between=between, steps=(0.005, 1e-7, 0.01))
        system.find([0, 0])
        return system.follow()

    return follow


def test_the_boundaries_of_instability_of_meissners_equation(boundaries):
    points = boundaries(1.638, 0.03, (1.1, 3.0))
    doublings = [point.parameter for point in special(points, "doubling")]
    crossings = [point.parameter for point in special(points, "crossing")]
    assert doublings == pytest.approx([2.358078198, 2.753118529], abs=1e-9)  # digits that are given
    assert crossings == pytest.approx([1.219092440, 1.312451930], abs=1e-9)
    for (low, high), largest in (((2.3, 2.8), 1.163087), ((1.2, 1.32), 1.098273)):
        seen = [abs(p.multipliers[0]) for p in points if low < p.parameter < high]
        assert max(seen) == pytest.approx(largest, abs=1e-3)  # the points are 0.01 apart
        assert max(seen) <= largest + 1e-6


@pytest.mark.parametrize(("ratio", "damping"), [(1.2, 0.01), (1.5, 0.05), (1.638, 0.03), (1.85, 0.02)])
def test_other_contact_ratios_and_dampings_have_the_boundaries_of_two_exponentials(
    boundaries, ratio, damping
):
    points = boundaries(ratio, damping, (0.9, 3.2))
    for kind, sign in (("doubling", -1), ("crossing", 1)):

        def determinant(frequency, sign=sign):
            return np.linalg.det(product(frequency, ratio, damping) - sign * np.eye(2))

        grid = np.linspace(0.9, 3.2, 231)
        values = [determinant(frequency) for frequency in grid]
        known = [
            brentq(determinant, grid[i], grid[i + 1], xtol=1e-14)
            for i in np.flatnonzero(np.diff(np.sign(values)))
        ]
        found = [point.parameter for point in special(points, kind)]
        assert found == pytest.approx(known, abs=1e-9)


def test_the_largest_multiplier_is_that_of_two_exponentials_everywhere(boundaries):
    for point in boundaries(1.638, 0.03, (1.1, 3.0)):
        expected = max(abs(np.linalg.eigvals(product(point.parameter, 1.638, 0.03))))
        # two that are about to meet differ by the root of the error
        assert max(abs(point.multipliers)) == pytest.approx(expected, abs=2e-6)


def test_a_fold_that_is_known_is_found_and_passed(c):
    """z' = l - z^2: z = +-sqrt(l), multipliers exp(-+2 sqrt(l) T), a fold at l = 0."""
    frequency = 1.3
    system = System(c, "moving_fold", [frequency, 0.5, 0.7], 1)
    system.options(between=(-1, 0.6), rising=False)
    system.find([1.4])
    points = system.follow()
    (fold,) = special(points, "fold")
    assert fold.parameter == pytest.approx(0, abs=1e-10)
    assert fold.y[0] == pytest.approx(0.7, abs=1e-4)  # flat there: a root of the residual
    z = np.array([point.y[0] - 0.7 for point in points if point.kind == "ordinary"])
    values = np.array([point.parameter for point in points if point.kind == "ordinary"])
    multipliers = np.array([point.multipliers[0] for point in points if point.kind == "ordinary"])
    assert z[0] > 0 > z[-1]
    assert np.all(np.diff(z) < 0)
    assert values[-1] == 0.6
    assert values == pytest.approx(z**2, abs=1e-9)
    assert multipliers == pytest.approx(np.exp(-2 * z * 2 * np.pi / frequency), rel=1e-8)


def test_where_a_pair_of_multipliers_leaves_the_unit_circle_is_found(c):
    """z' = (l + iw - |z|^2) z: exp((l +- iw) T), so at l = 0 (Neimark-Sacker)."""
    system = System(c, "moving_focus", [1.3, -0.1, 0.77, 0.7], 1)
    system.options(between=(-0.2, 0.2))
    system.find([0.7, 0])
    points = system.follow()
    (point,) = special(points, "neimark_sacker")
    assert point.parameter == pytest.approx(0, abs=1e-10)
    assert abs(point.multipliers) == pytest.approx([1, 1], abs=1e-9)
    assert [p.kind for p in points if p.kind != "ordinary"] == ["neimark_sacker"]


def test_two_real_multipliers_with_the_product_1_are_no_neimark_sacker_point(c):
    """Meissner's equation without damping has det = 1 everywhere, real pairs between its boundaries."""
    system = System(c, "meissner", [2.4, 1.638, 0.03, 0], 2)
    system.options(between=(-0.05, 0.05), rising=False, steps=(0.003, 1e-7, 0.01))
    system.find([0, 0])
    points = system.follow()
    assert min(np.prod(p.multipliers).real for p in points) < 1
    assert max(np.prod(p.multipliers).real for p in points) > 1
    assert special(points, "neimark_sacker") == []


@pytest.mark.parametrize("damping", [0.05, 0.2])
def test_where_a_vibration_just_touches_a_stop_is_found(c, damping):
    """Below, it is linear: it touches where a/|1 - W^2 + 2izW| is the distance of the stop."""
    frequency, distance = 0.7, 1.0
    system = System(c, "stop", [frequency, damping, 0.3, distance, 2], 2)
    system.options(between=(0.3, 0.7))
    system.find([0.3, 0.1])
    points = system.follow()
    (touch,) = special(points, "touch")
    expected = distance * abs(1 - frequency**2 + 2j * damping * frequency)
    # the value at the turn is that of the dense output, 1e-12
    assert touch.parameter == pytest.approx(expected, abs=1e-9)
    assert touch.root == 1
    period = 2 * np.pi / frequency
    matrix = expm(period * np.array([[0, 1], [-1, -2 * damping]]))
    expected = np.sort_complex(np.linalg.eigvals(matrix))
    assert np.sort_complex(touch.multipliers) == pytest.approx(expected, abs=1e-4)


# ---- against other programs ----


def test_duffings_folds_are_those_of_harmonic_balance(c):
    """x'' + d x' + x + x^3 = c cos Wt as a Fourier sum with odd harmonics to the 19th, by collocation.

    A fold is where the derivative of the sums' residual is singular; both are solved at once.
    """
    damping, force, odd = 0.1, 0.4, np.arange(1, 20, 2)
    phases = 2 * np.pi * np.arange(80) / 80
    waves = np.concatenate([np.cos(np.outer(odd, phases)), np.sin(np.outer(odd, phases))])
    back = waves / 40
    m = len(odd)

    def residual(a, frequency):
        cosine, sine = a[:m], a[m:]
        cubes = back @ (a @ waves) ** 3
        linear = np.concatenate(
            [
                (1 - (odd * frequency) ** 2) * cosine + damping * odd * frequency * sine,
                (1 - (odd * frequency) ** 2) * sine - damping * odd * frequency * cosine,
            ]
        )
        linear[0] -= force
        return linear + cubes

    def jacobian(a, frequency):
        matrix = 3 * back * (a @ waves) ** 2 @ waves.T
        stiffness, loss = 1 - (odd * frequency) ** 2, damping * odd * frequency
        return matrix + np.block(
            [[np.diag(stiffness), np.diag(loss)], [-np.diag(loss), np.diag(stiffness)]]
        )

    def extended(u):
        a, vector, frequency = u[: 2 * m], u[2 * m : -1], u[-1]
        matrix = jacobian(a, frequency)
        return np.concatenate([residual(a, frequency), matrix @ vector, [vector @ vector - 1]])

    system = System(c, "duffing", [1, damping, 1, 1, force])
    system.options(between=(0.9, 2.5))
    system.find(swept(system, [0.5, 0], 0.9, 100), 0.9)
    folds = special(system.follow(), "fold")
    assert len(folds) == 2
    for fold in folds:
        states = [
            system.flow(fold.y, t, fold.parameter)[0][0]
            for t in fold.period * np.arange(1, 81) / 80
        ]
        a = back @ np.roll(states, 1)
        vector = np.linalg.svd(jacobian(a, fold.parameter))[2][-1]
        solution = fsolve(extended, [*a, *vector, fold.parameter], xtol=1e-13)
        # harmonics above the 19th are below 1e-10 of the first
        assert fold.parameter == pytest.approx(solution[-1], abs=1e-8)
        assert min(abs(fold.multipliers - 1)) < 1e-5  # 1 but for the root of the residual


BACKLASH = [0.7, 0.05, 0.1, 0.3]


def backlash_flow(y, frequency):
    """Period of the backlash oscillator by DOP853, stopped where its spring begins and ends."""
    _, damping, mean, amplitude = BACKLASH

    def f(t, y, mode):
        force = mean + amplitude * np.cos(frequency * t)
        return [y[1], force - 2 * damping * y[1] - abs(mode) * (y[0] - mode)]

    def reach(border):
        event = lambda t, y, mode: y[0] - border
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
                    8 * (backlash_flow(y + size * e, frequency) - backlash_flow(y - size * e, frequency))
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
    """The parameter goes with the square of the distance, and to twice the period the orbit has mu^2."""
    _, doubling, points = doubled
    near = [p for p in points if p.kind == "ordinary"][:6]
    distance = np.array([np.linalg.norm(p.y - doubling.y) for p in near])
    change = np.array([p.parameter - doubling.parameter for p in near])
    assert np.all(change < 0)
    assert change / distance**2 == pytest.approx(np.full(len(near), change[-1] / distance[-1] ** 2), rel=0.05)
    assert near[0].multipliers[0] == pytest.approx(1, abs=1e-3)
    assert all(is_stable(point) for point in near)  # the other one has lost its stability


def test_a_long_run_ends_on_the_orbit_of_twice_the_period(doubled):
    system, doubling, points = doubled
    point = min(points, key=lambda p: max(abs(p.multipliers)))
    assert max(abs(point.multipliers)) < 0.985
    y = swept(system, point.y + [1e-3, 0], point.parameter, 1500, periods=2)  # 0.985**1500 = 1e-10
    assert y == pytest.approx(point.y, abs=1e-7)


def test_an_orbit_without_a_multiplier_minus_1_has_no_other_branch(backlash):
    system, points = backlash
    system.find(points[0].y, points[0].parameter)
    with pytest.raises(OrbitError, match=r"the orbit at 2 has no multiplier -1"):
        system.switch(0, 0.01)


# ---- flanks that part ----


def test_with_parting_flanks_the_mesh_resonance_jumps_where_it_is_known_to(c):
    """Rectangular stiffness, contact ratio 1.638, damping ratio 0.03: the sweep up jumps between
    0.750 and 0.755 of the frequency of the mean stiffness, and doubles its period above 1.840."""
    unit = np.sqrt(1.638)
    system = System(c, "parting", [0.6 * unit, 1.638, 0.03, 1])
    system.options(between=(0.5 * unit, 0.95 * unit), steps=(0.003, 1e-7, 0.02))
    system.find([0.8, 0])
    points = system.follow()
    fold = special(points, "fold")[0]
    assert 0.750 < fold.parameter / unit < 0.755
    assert all(point.residual <= 1e-10 for point in points)
    assert points[-1].parameter == 0.5 * unit  # the unstable branch, back below
    assert not is_stable(points[-1])
    # before the flanks part for the first time nothing is nonlinear
    touch = special(points, "touch")[0]
    linear = product(touch.parameter, 1.638, 0.03)
    expected = np.sort_complex(np.linalg.eigvals(linear))
    assert np.sort_complex(touch.multipliers) == pytest.approx(expected, abs=1e-4)


def test_a_branch_that_begins_outside_its_range_is_refused(c):
    system = System(c, "moving_fold", [1.3, 0.5, 0.7], 1)
    system.options(between=(0.6, 0.7))
    system.find([1.4])
    with pytest.raises(OrbitError, match=r"the branch begins at 0.5, not between 0.6 and 0.7"):
        system.follow()


def test_a_branch_that_ends_keeps_what_it_found(c):
    """z' = l - z^2 with a range of the frequency that ends where there is none: W > 0."""
    system = System(c, "moving_fold", [0.3, 0.5, 0.7], 0)
    system.options(between=(-1, 1), rising=False, steps=(0.01, 1e-4, 0.1))
    system.find([1.4])
    with pytest.raises(OrbitError, match="no frequency"):
        system.follow()
    assert system.kept > 3
    assert system.point(system.kept - 1).parameter < 0.1
