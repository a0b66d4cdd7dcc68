"""The tables of the method against mpmath and against the theory of Radau IIA methods."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest
from radau_coefficients import LANES, STAGES, radau

from integrator.radau import Library

EPS = np.finfo(float).eps
PAIRS = range(1, 4)


@pytest.fixture(scope="module")
def tables(library: Library) -> dict[str, np.ndarray]:
    return library.tables()


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(50):
        yield


@pytest.fixture(scope="module")
def tabulated_a(tables) -> mp.matrix:
    """A = T Lambda^-1 T^-1 as the solver has it: from the tabulated doubles, exact otherwise."""
    with mp.workdps(50):
        lanes = [0, 1, 2, 3, 5, 6, 7]
        t = mp.matrix(tables["to_stage"][:STAGES, lanes].tolist())
        inverse = mp.matrix(tables["from_stage"][lanes, :STAGES].tolist())
        eigenvalues = mp.zeros(STAGES)
        for k in range(4):
            eigenvalues[k, k] = mp.mpf(float(tables["shift_re"][k]))
        for k in PAIRS:
            eigenvalues[3 + k, 3 + k] = eigenvalues[k, k]
            eigenvalues[k, 3 + k] = -mp.mpf(float(tables["shift_im"][k]))
            eigenvalues[3 + k, k] = mp.mpf(float(tables["shift_im"][k]))
        return t * eigenvalues**-1 * inverse


def test_tables_are_the_doubles_nearest_to_60_digits(tables):
    exact = radau()
    for name in ("node", "shift_re", "shift_im", "barycentric"):
        assert tables[name].tolist() == [float(x) for x in getattr(exact, name)], name
    for name in ("to_stage", "from_stage", "slope", "chebyshev", "integral"):
        matrix = getattr(exact, name)
        expected = [[float(matrix[i, k]) for k in range(LANES)] for i in range(LANES)]
        assert tables[name].tolist() == expected, name


def test_order_conditions_of_the_table_hold_to_1e_14(tables, tabulated_a):
    # B(13): the quadrature; C(7): the stages; D(6): together order 13 (Hairer & Wanner, IV.5)
    c = [mp.mpf(float(x)) for x in tables["node"][:STAGES]]
    a, b = tabulated_a, tabulated_a[STAGES - 1, :]
    stages = range(STAGES)
    for q in range(1, 14):
        assert abs(mp.fsum(b[k] * c[k] ** (q - 1) for k in stages) - mp.mpf(1) / q) < 1e-14
    for q in range(1, 8):
        for i in stages:
            left = mp.fsum(a[i, k] * c[k] ** (q - 1) for k in stages)
            assert abs(left - c[i] ** q / q) < 1e-14
    for q in range(1, 7):
        for k in stages:
            left = mp.fsum(b[i] * c[i] ** (q - 1) * a[i, k] for i in stages)
            assert abs(left - b[k] * (1 - c[k] ** q) / q) < 1e-14


def test_stability_function_is_zero_at_infinity(tabulated_a):
    # R(inf) = 1 - b A^-1 1 = 0, since b is the last row of A
    stages = mp.lu_solve(tabulated_a, mp.matrix([1] * STAGES))
    assert abs(1 - (tabulated_a[STAGES - 1, :] * stages)[0]) < 1e-14
    assert abs(stability(tabulated_a, mp.mpf(-1e16))) < 1e-14


def stability(a: mp.matrix, z: mp.mpc) -> mp.mpc:
    solution = mp.lu_solve(mp.eye(STAGES) - z * a, mp.matrix([1] * STAGES))
    return 1 + z * (a[STAGES - 1, :] * solution)[0]


def test_stability_function_is_at_most_1_on_the_imaginary_axis(tabulated_a):
    for y in np.logspace(-2, 6, 60):
        assert abs(stability(tabulated_a, mp.mpc(0, y))) <= 1 + 1e-14


def test_stability_function_is_the_exponential_to_order_13(tabulated_a):
    # the error constant of the Pade approximation (6, 7): 6! 7!/(13! 14!)
    constant = mp.factorial(6) * mp.factorial(7) / (mp.factorial(13) * mp.factorial(14))
    exact = radau().a
    z = mp.mpf(1) / 16
    assert abs((stability(exact, z) - mp.exp(z)) / (constant * z**14)) == pytest.approx(1, abs=0.1)
    assert abs(stability(tabulated_a, mp.mpf(1)) - stability(exact, mp.mpf(1))) < 1e-14


def test_weights_of_the_estimate_are_those_of_the_embedded_formula_of_order_7(tables):
    # The solver subtracts the slope of the collocation polynomial at the start; Hairer & Wanner
    # (IV.8) add e A^-1 z / (gamma_0 h) with the embedded weights: the same numbers.
    exact = radau()
    for k in range(STAGES):
        assert abs(exact.error[k] + exact.slope[LANES - 1, k]) < 1e-45
    assert tables["slope"][LANES - 1].tolist()[:STAGES] == [float(-x) for x in exact.error[:-1]]


def test_lagrange_polynomials_reproduce_every_polynomial_of_degree_7(library, tables):
    for tau in (-0.3, 0.0, 0.01, 0.5, 0.93, 1.0, 1.7):
        basis = library.basis(tau)
        for power in range(8):
            # rounding of the sum: its largest term, which grows outside the step
            rounding = 16 * EPS * np.abs(basis).max()
            assert abs(basis @ tables["node"] ** power - tau**power) <= rounding


def test_a_lagrange_polynomial_is_exactly_0_at_the_other_nodes(library, tables):
    for k, node in enumerate(tables["node"]):
        basis = library.basis(node)
        assert basis[k] == pytest.approx(1, abs=8 * EPS)
        assert not np.delete(basis, k).any()
