"""Systems of a few unknowns, solved by elimination: against LAPACK by way of numpy."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def solve(library: Path, a: Floats, b: Floats) -> Floats | None:
    """X of A X = B; nothing if it is said that there is none."""
    c = ctypes.CDLL(str(library))
    c.st_solve.restype = ctypes.c_bool
    pointer = ctypes.POINTER(ctypes.c_double)
    matrix, x = (np.array(given, dtype=float, order="F") for given in (a, b))
    good = c.st_solve(
        *(ctypes.c_int(n) for n in b.shape),
        matrix.ctypes.data_as(pointer),
        x.ctypes.data_as(pointer),
    )
    return x if good else None


@pytest.mark.parametrize("n", [1, 2, 3, 14, 42, 60, 61, 80])
@pytest.mark.parametrize("m", [1, 4])
def test_solutions_are_those_of_lapack(kernel_test_library: Path, n: int, m: int) -> None:
    """Small numbers and a zero on the diagonal; on both sides of where LAPACK takes over."""
    rng = np.random.default_rng(n + 100 * m)
    a = rng.standard_normal((n, n)) + 4 * np.eye(n)[rng.permutation(n)]
    a[np.diag_indices(n)] *= 1e-9 if n > 1 else 1
    a[0, 0] = a[0, 0] if n == 1 else 0
    b = rng.standard_normal((n, m))
    expected = np.linalg.solve(a, b)
    found = solve(kernel_test_library, a, b)
    assert found is not None
    np.testing.assert_allclose(
        found, expected, atol=1e-13 * np.linalg.cond(a) * np.abs(expected).max()
    )


@pytest.mark.parametrize(
    ("n", "what"),
    [(1, 0.0), (2, 0.0), (14, 0.0), (70, 0.0), (1, np.nan), (14, np.nan), (14, np.inf)],
)
def test_matrix_without_a_solution_is_told(kernel_test_library: Path, n: int, what: float) -> None:
    """A column of zeros, or what is no number."""
    a = np.random.default_rng(n).standard_normal((n, n))
    a[:, -1] = what
    assert solve(kernel_test_library, a, np.ones((n, 1))) is None
