"""Elimination of unknowns: against numpy, and to the bit against the plain order of operations."""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def condense(library: Path, n: int, a: Floats) -> Floats | None:
    """The matrix with what is left of it in its place; nothing if it is not positive definite."""
    c = ctypes.CDLL(str(library))
    c.st_condense.restype = ctypes.c_bool
    matrix = np.array(a, dtype=float, order="F")
    pointer = matrix.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
    good = c.st_condense(ctypes.c_int(n), ctypes.c_int(len(a) - n), pointer)
    return matrix if good else None


def definite(size: int) -> Floats:
    """Positive definite matrix, none of its numbers round."""
    rng = np.random.default_rng(size)
    b = rng.standard_normal((size, size))
    return b @ b.T + np.eye(size)


def plain(n: int, a: Floats) -> Floats:
    """One column after the other, each at once from all that stand right of it."""
    a = a.copy()
    for k in range(n):
        a[k, k] = math.sqrt(a[k, k])
        a[k + 1 :, k] = (1 / a[k, k]) * a[k + 1 :, k]
        for j in range(k + 1, len(a)):
            a[j:, j] = a[j:, j] - a[j, k] * a[j:, k]
    return a


SIZES = [0, 1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 33, 64, 65, 100]


@pytest.mark.parametrize("n", SIZES)
@pytest.mark.parametrize("m", [1, 5, 8, 13, 16, 40])
def test_elimination_has_the_digits_of_the_plain_order(
    kernel_test_library: Path, n: int, m: int
) -> None:
    a = definite(n + m)
    found = condense(kernel_test_library, n, a)
    assert found is not None
    np.testing.assert_array_equal(np.tril(found[n:, n:]), np.tril(plain(n, a)[n:, n:]))


@pytest.mark.parametrize(("n", "m"), [(3, 2), (40, 60), (172, 243)])
def test_what_is_left_is_that_of_lapack(kernel_test_library: Path, n: int, m: int) -> None:
    a = definite(n + m)
    found = condense(kernel_test_library, n, a)
    assert found is not None
    factor = np.linalg.cholesky(a[:n, :n])
    across = np.linalg.solve(factor, a[:n, n:]).T
    rest = a[n:, n:] - across @ across.T
    size = np.linalg.cond(a) * np.abs(a).max()
    np.testing.assert_allclose(np.tril(found[n:, n:]), np.tril(rest), atol=1e-14 * size)


@pytest.mark.parametrize("n", [1, 2, 9, 40])
@pytest.mark.parametrize("what", [0.0, -1.0, math.nan])
@pytest.mark.parametrize("at", [0, -1])
def test_a_matrix_that_is_not_definite_is_told(
    kernel_test_library: Path, n: int, what: float, at: int
) -> None:
    a = definite(n)
    a[at, at] = what
    assert condense(kernel_test_library, n, a) is None
