"""Sparse and dense factors of the four systems against numpy."""

from __future__ import annotations

import numpy as np
import pytest

from integrator.radau import Library

RNG = np.random.default_rng(20110328)
EPS = np.finfo(float).eps


def random_system(n: int, density: float):
    """Return pattern, values, shifts and right-hand sides; the diagonal dominates."""
    filled = (RNG.random((n, n)) < density) | np.eye(n, dtype=bool)
    entries = np.argwhere(filled)
    values = RNG.standard_normal(len(entries))
    shifts = n + 10 * (RNG.random(4) + 1j * RNG.standard_normal(4))
    shifts[0] = shifts[0].real
    right = RNG.standard_normal((4, n)) + 1j * RNG.standard_normal((4, n))
    right[0] = right[0].real
    return entries, values, shifts, right


def matrices(n, entries, values, shifts):
    jacobian = np.zeros((n, n))
    jacobian[entries[:, 0], entries[:, 1]] = values
    return [shift * np.eye(n) - jacobian for shift in shifts]


@pytest.mark.parametrize("kind", ["sparse", "dense"])
@pytest.mark.parametrize("n", [1, 2, 6, 20, 50])
@pytest.mark.parametrize("density", [0.1, 1.0])
def test_factors_solve_all_four_systems(library: Library, kind, n, density):
    entries, values, shifts, right = random_system(n, density)
    good, x, first = library.solve_systems(kind, entries, values, shifts, right)
    assert good
    for k, matrix in enumerate(matrices(n, entries, values, shifts)):
        expected = np.linalg.solve(matrix, right[k])
        # the matrices are well conditioned: backward stable to a small multiple of n eps
        assert np.abs(x[k] - expected).max() <= 16 * n * EPS * np.abs(expected).max()
    assert np.abs(first - x[0].real).max() <= 4 * n * EPS * np.abs(first).max()


def test_an_arrow_is_factored_without_fill(library: Library):
    # eliminated in the given order, an arrow with its head first fills completely
    n = 30
    entries = [(i, i) for i in range(n)]
    entries += [(0, i) for i in range(1, n)] + [(i, 0) for i in range(1, n)]
    values = RNG.standard_normal(len(entries))
    fill, _, _ = library.solve_systems("sparse", entries, values, [40] * 4, np.ones((4, n)))
    assert fill == len(entries)


def test_factors_of_a_chain_grow_with_its_length(library: Library):
    """A chain whose masses are all coupled with the first two, as wheels with the reference one."""
    fill = {}
    for masses in (100, 200):
        near = {(i, j) for i in range(masses) for j in range(masses) if abs(i - j) <= 1}
        pattern = near | {(i, j) for i in range(masses) for j in (0, 1)}
        entries = [(2 * i, 2 * i + 1) for i in range(masses)]
        entries += [(2 * i + 1, 2 * j + side) for i, j in sorted(pattern) for side in (0, 1)]
        values = RNG.standard_normal(len(entries))
        right = np.ones((4, 2 * masses))
        fill[masses], x, _ = library.solve_systems("sparse", entries, values, [50] * 4, right)
        expected = np.linalg.solve(
            matrices(2 * masses, np.array(entries), values, [50])[0], right[0]
        )
        assert np.abs(x[0] - expected).max() <= 64 * masses * EPS * np.abs(expected).max()
    # diagonal, both neighbours, two columns, and what a chain eliminated from both ends fills
    assert fill[200] <= 8 * 200
    assert fill[200] <= 2.05 * fill[100]


def test_a_missing_diagonal_is_added(library: Library):
    _, x, _ = library.solve_systems("sparse", [(0, 1), (1, 0)], [1, 1], [2] * 4, np.ones((4, 2)))
    assert x[0] == pytest.approx([1, 1], abs=4 * EPS)  # (2 I - J) x = 1


def mechanical_system(masses: int, neighbours: int):
    """Return pattern and values of q' = c v, v' = -K q - D v; each mass feels some neighbours."""
    near = [(i, j) for i in range(masses) for j in range(masses) if abs(i - j) <= neighbours]
    # angle and speed of a mass lie beside each other, and the diagonal of the angles is empty
    entries = [(2 * i, 2 * i + 1) for i in range(masses)]
    entries += [(2 * i + 1, 2 * j + side) for i, j in near for side in (0, 1)]
    return np.array(entries), RNG.standard_normal(len(entries))


# 3 and 8 masses are solved for by inverses, 9 and 25 by sparse factors
@pytest.mark.parametrize("masses", [1, 3, 8, 9, 25])
def test_kinematic_rows_are_condensed(library: Library, masses):
    n = 2 * masses
    entries, values = mechanical_system(masses, neighbours=2)
    shifts = 10 + 3j * np.arange(4)
    right = RNG.standard_normal((4, n)) + 1j * RNG.standard_normal((4, n))
    right[0] = right[0].real
    fill, x, first = library.solve_systems("sparse", entries, values, shifts, right)
    assert 0 < fill <= masses**2  # the speeds alone are left
    for k, matrix in enumerate(matrices(n, entries, values, shifts)):
        expected = np.linalg.solve(matrix, right[k])
        # the diagonal of the condensed matrices dominates: stable to a small multiple of n eps
        assert np.abs(x[k] - expected).max() <= 16 * n * EPS * np.abs(expected).max()
    assert np.abs(first - x[0].real).max() <= 4 * n * EPS * np.abs(first).max()


def test_a_kinematic_row_whose_shift_vanishes_beside_its_entry_is_refused(library: Library):
    # q' = 1e7 v, v' = -q: the pivot of q, 1, is below 1e-6 of what stands beside it
    entries, values, right = [(0, 1), (1, 0)], [1e7, -1], np.ones((4, 2))
    for shift in (1, 9.99):
        assert library.solve_systems("sparse", entries, values, [shift] * 4, right)[0] == 0
    for shift in (10.01, 100):
        good, x, _ = library.solve_systems("sparse", entries, values, [shift] * 4, right)
        assert good == 1
        # Cramer: the determinant is shift**2 + 1e7
        expected = np.array([shift + 1e7, shift - 1]) / (shift**2 + 1e7)
        assert np.abs(x / expected - 1).max() <= 64 * 1e6 * EPS  # the reciprocal of the pivot


@pytest.mark.parametrize("shift", [0, 1e-9])
def test_a_small_pivot_is_refused_by_the_sparse_and_solved_by_the_dense_factors(library, shift):
    entries, values, right = [(0, 1), (1, 0)], [-1, 1], np.ones((4, 2))
    assert library.solve_systems("sparse", entries, values, [shift] * 4, right)[0] == 0
    good, x, _ = library.solve_systems("dense", entries, values, [shift] * 4, right)
    assert good
    expected = np.linalg.solve([[shift, 1], [-1, shift]], [1, 1])
    assert np.abs(x - expected).max() <= 8 * EPS


def test_a_singular_matrix_is_refused_by_both(library: Library):
    entries, values = [(0, 0), (0, 1), (1, 0), (1, 1)], [1, 1, 1, 1]
    right = np.ones((4, 2))
    for kind in ("sparse", "dense"):
        assert library.solve_systems(kind, entries, values, [2] * 4, right)[0] == 0
        # the eigenvalues of J are 0 and 2, the right-hand side is the eigenvector of 2
        good, x, _ = library.solve_systems(kind, entries, values, [3] * 4, right)
        assert good
        assert np.abs(x - 1).max() <= 8 * EPS


def test_row_exchanges_in_every_column_are_undone(library: Library):
    # a permutation with a weak diagonal: each pivot lies in another row
    n = 6
    order = np.array([3, 0, 5, 1, 2, 4])
    entries = [*((i, int(order[i])) for i in range(n)), *((i, (i + 1) % n) for i in range(n))]
    entries = list(dict.fromkeys(entries))
    values = np.array([5.0 + i for i in range(len(entries))])
    right = RNG.standard_normal((4, n)).astype(complex)
    shifts = np.array([1e-3, 1e-3 + 1j, 2j, 3 - 1j])
    good, x, _ = library.solve_systems("dense", entries, values, shifts, right)
    assert good
    for k, matrix in enumerate(matrices(n, np.array(entries), values, shifts)):
        residual = np.abs(matrix @ x[k] - right[k]).max()
        assert residual <= 64 * EPS * np.abs(matrix).sum(axis=1).max() * np.abs(x[k]).max()
