"""Branches of orbits, and where their stability changes: closed forms and other programs."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq, fsolve

from continuation.orbits import OrbitError, Point, System, special
from continuation.test_flow_derivative import product
from continuation.test_orbits import swept

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


def test_special_points_of_one_step_stand_in_their_order(c):
    system = System(c, "meissner", [2.5, 1.638, 0.03, 0])
    system.options(between=(1.25, 2.5), rising=False, steps=(1.25, 1e-7, 1.25))
    system.find([0, 0])
    points = system.follow()
    assert [p.kind for p in points] == ["ordinary", "doubling", "crossing", "ordinary"]
    assert [p.parameter for p in points] == sorted((p.parameter for p in points), reverse=True)


@pytest.mark.parametrize(
    ("ratio", "damping"), [(1.2, 0.01), (1.5, 0.05), (1.638, 0.03), (1.85, 0.02)]
)
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
    """Meissner's equation without damping has det = 1, and real pairs between its boundaries."""
    system = System(c, "meissner", [2.4, 1.638, 0.03, 0], 2)
    system.options(between=(-0.05, 0.05), rising=False, steps=(0.003, 1e-7, 0.01))
    system.find([0, 0])
    points = system.follow()
    assert min(np.prod(p.multipliers).real for p in points) < 1
    assert max(np.prod(p.multipliers).real for p in points) > 1
    assert special(points, "neimark_sacker") == []


@pytest.mark.parametrize(("start", "end", "period"), [(1, 2, 7.62987448), (-0.5, -1, 6.66328686)])
def test_a_free_orbit_is_followed_and_its_own_multiplier_is_no_crossing(c, start, end, period):
    """Van der Pol's equation; backwards in time, m < 0, the orbit is unstable and the same."""
    system = System(c, "van_der_pol", [start])
    system.options(between=(min(start, end), max(start, end)), rising=end > start)
    system.find([2, 0], period=6.5)
    points = system.follow()
    assert {point.kind for point in points} == {"ordinary"}
    assert points[-1].parameter == end
    assert points[-1].period == pytest.approx(period, abs=1e-8)  # to all digits that are known
    assert all(min(abs(point.multipliers - 1)) < 1e-6 for point in points)
    assert all((abs(point.multipliers).max() > 1.5) == (end < 0) for point in points)


def test_an_orbit_from_which_all_flees_is_as_exact_as_the_one_to_which_all_comes(c):
    """Backwards in time its end differs by 1e-12 times a multiplier of 1e5, its period by less."""
    system = System(c, "van_der_pol", [-0.5])
    system.options(between=(-1.5, -0.5), rising=False)
    system.find([2, 0], period=6.5)
    last = system.follow()[-1]
    assert last.parameter == -1.5
    assert abs(last.multipliers[0]) > 1e5
    assert last.residual > 1e-10
    forwards = System(c, "van_der_pol", [1.5]).find([2, 0], period=7)
    assert last.period == pytest.approx(forwards.period, abs=1e-9)


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
    """x'' + d x' + x + x^3 = c cos Wt as a sum of odd harmonics to the 19th, by collocation.

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
    assert max(abs(points[-1].multipliers)) > 1
    # at the first touch flanks that part just leave each other, at the second they just part:
    # from there to the next nothing is nonlinear
    _, touch, part_again = special(points, "touch")
    assert touch.parameter < part_again.parameter < fold.parameter
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
