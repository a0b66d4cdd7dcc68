"""Johnson's contact in series with a body that yields, against mpmath (50 digits)."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.compliant import LANES, compliant_force, compliant_lanes, compliant_penetration
from kernel.kernel import OK, OUT_OF_DOMAIN, Kernel

E_STAR = 1.1318681318681319e11  # steel on steel, E 206 GPa [Pa]
LENGTH = 0.0513
BODY = np.array([0.0, 5.0, 15.0, 22.0, 30.0, 40.0])  # pi E* c; two teeth have 15 to 30

# h/m, the smallest that has no use to the largest that no tooth bears, and pi E* c
H, PEC = (grid.ravel() for grid in np.meshgrid(np.logspace(-280, -3.2, 400), BODY))
C = PEC / (np.pi * E_STAR)


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(50):
        yield


def exact_force(h: float, c: float, length: float = LENGTH) -> mp.mpf:
    """Newton's method on h = N/(pi E*) [ln(4 pi E* Lambda/N) - 1] + c N, in ln N."""
    stiff = mp.pi * mp.mpf(E_STAR)
    h, c, length = map(mp.mpf, (h, c, length))
    size = stiff * h / 30
    for _ in range(100):
        w = mp.log(4 * stiff * length / size) - 1 + stiff * c
        step = (h * stiff / size - w) / (w - 1)
        size *= mp.exp(max(min(step, mp.mpf(2)), mp.mpf(-2)))
        if abs(step) < mp.mpf(10) ** -40:
            return size
    raise AssertionError((h, c))


def worst(values: np.ndarray, exact: list[mp.mpf]) -> float:
    return max(float(abs(mp.mpf(float(v)) / e - 1)) for v, e in zip(values, exact, strict=True))


def test_force_is_that_of_newtons_method(kernel: Kernel):
    contact = compliant_force(kernel, H, LENGTH, C, E_STAR)
    assert not contact.code.any()
    assert worst(contact.force, [exact_force(*at) for at in zip(H, C, strict=True)]) < 1e-13


def test_force_without_compliance_is_johnsons_where_lambda_is_his_length(kernel: Kernel):
    h = np.logspace(-280, -3.2, 300)
    johnson = kernel.johnson_force(h, LENGTH, E_STAR)
    contact = compliant_force(kernel, h, LENGTH, 0.0, E_STAR)
    np.testing.assert_allclose(contact.force, johnson.force, rtol=4e-16)
    np.testing.assert_allclose(contact.d_h, johnson.d_h, rtol=1e-15)
    np.testing.assert_allclose(contact.d_length, johnson.d_rho, rtol=2e-15)


def test_derivatives_are_those_of_the_force(kernel: Kernel):
    some = slice(None, None, 37)
    contact = compliant_force(kernel, H[some], LENGTH, C[some], E_STAR)
    d_h, d_c, d_length = [], [], []
    for h, c in zip(H[some], C[some], strict=True):
        small = mp.mpf(10) ** -20
        n = exact_force(h, c)
        d_h.append((exact_force(h * (1 + small), c) - n) / (mp.mpf(float(h)) * small))
        step = small / E_STAR
        d_c.append((exact_force(h, mp.mpf(float(c)) + step) - n) / step)
        d_length.append((exact_force(h, c, LENGTH * (1 + small)) - n) / (LENGTH * small))
    assert worst(contact.d_h, d_h) < 1e-13
    assert worst(contact.d_c, d_c) < 1e-13
    assert worst(contact.d_length, d_length) < 1e-13


def test_energy_is_the_work_of_the_force(kernel: Kernel):
    """Both parts of W* from the force: N^2/(2 pi E*) (ln(4 pi E* Lambda/N) - 3/2) + c N^2/2."""
    at = H > 1e-100  # else N^2 is not a number of ours
    contact = compliant_force(kernel, H[at], LENGTH, C[at], E_STAR)
    stiff = mp.pi * mp.mpf(E_STAR)
    exact = []
    for h, c in zip(H[at], C[at], strict=True):
        n = exact_force(h, c)
        exact.append(
            n**2 / (2 * stiff) * (mp.log(4 * stiff * LENGTH / n) - 1.5)
            + mp.mpf(float(c)) * n**2 / 2
        )
    assert worst(contact.energy, exact) < 1e-13


def test_derivatives_of_the_energy_are_minus_those_of_the_potential(kernel: Kernel):
    """dV = N dh - N^2/2 dc - N^2/(2 pi E* Lambda) dLambda, by central differences."""
    h, c = 1.2e-5, 20 / (np.pi * E_STAR)
    n = compliant_force(kernel, h, LENGTH, c, E_STAR).force[0]

    def slope(i: int) -> float:
        at = np.array([h, LENGTH, c])
        step = 1e-4 * at[i]
        ends = []
        for sign in (-1, 1):
            moved = at.copy()
            moved[i] += sign * step
            ends.append(compliant_force(kernel, *moved, E_STAR).energy[0])
        return (ends[1] - ends[0]) / (2 * step)

    # differences of 1e-4 leave 1e-8 of the third derivatives
    assert slope(0) == pytest.approx(n, rel=1e-7)
    assert slope(2) == pytest.approx(-(n**2) / 2, rel=1e-7)
    assert slope(1) == pytest.approx(-(n**2) / (2 * np.pi * E_STAR * LENGTH), rel=1e-6)


def test_penetration_is_the_inverse(kernel: Kernel):
    force = compliant_force(kernel, H, LENGTH, C, E_STAR)
    h, d_force, codes = compliant_penetration(kernel, force.force, LENGTH, C, E_STAR)
    assert not codes.any()
    np.testing.assert_allclose(h, H, rtol=2e-15)
    np.testing.assert_allclose(d_force * force.d_h, 1, rtol=1e-13)


def test_eight_at_once_are_the_bits_of_one(kernel: Kernel):
    draw = np.random.default_rng(5)
    for _ in range(20):
        h = draw.choice([-1, 1], LANES) * 10 ** draw.uniform(-12, -4, LANES)
        length = draw.uniform(0.01, 0.2, LANES)
        c = draw.uniform(5, 35, LANES) / (np.pi * E_STAR)
        force, is_defined = compliant_lanes(kernel, h, length, c, E_STAR)
        assert is_defined
        alone = compliant_force(kernel, h, length, c, E_STAR).force
        np.testing.assert_allclose(force, alone, rtol=1e-15)  # contraction may differ by a bit


def test_force_is_odd_and_vanishes_with_h(kernel: Kernel):
    c = 20 / (np.pi * E_STAR)
    h = np.array([1e-6, 1e-300, 0.0])
    there = compliant_force(kernel, h, LENGTH, c, E_STAR)
    back = compliant_force(kernel, -h, LENGTH, c, E_STAR)
    assert list(there.code) == list(back.code) == [OK] * 3
    np.testing.assert_array_equal(there.force, -back.force)
    np.testing.assert_array_equal(there.d_h, back.d_h)
    np.testing.assert_array_equal(there.d_c, -back.d_c)
    assert there.force[2] == there.d_h[2] == 0


@pytest.mark.parametrize("body", [0.0, 40.0, 120.0])
def test_smallest_penetrations_give_forces_that_grow_with_them(kernel: Kernel, body: float):
    """Below the stated range the force is linear: no overflow, no lost digits, no step."""
    h = np.concatenate([[5e-324], np.logspace(-323, -200, 2000)])
    contact = compliant_force(kernel, h, LENGTH, body / (np.pi * E_STAR), E_STAR)
    assert not contact.code.any()
    assert np.isfinite(contact).all()
    ordinary = h > 1e-300
    assert (np.diff(contact.force[ordinary]) > 0).all()
    assert (np.diff(contact.force) >= 0).all()
    per_h = contact.force[ordinary] / h[ordinary]
    assert (per_h[1:] / per_h[:-1] < 1.001).all()  # it grows slower than h**1.001


@pytest.mark.parametrize("body", [-3.0, 0.0, 2.0])
def test_force_ends_at_its_limit(kernel: Kernel, body: float):
    """At h = 4 Lambda/e^2 exp(pi E* c) the slope is infinite; past it there is no solution."""
    c = body / (np.pi * E_STAR)
    limit = 4 * LENGTH * np.exp(body - 2)
    h = limit * np.array([1 - 1e-9, 1 + 1e-9])
    contact = compliant_force(kernel, h, LENGTH, c, E_STAR)
    assert list(contact.code) == [OK, OUT_OF_DOMAIN]
    assert contact.force[0] == pytest.approx(np.pi * E_STAR * limit, rel=1e-4)
    assert contact.force[1] == contact.d_h[1] == contact.d_c[1] == contact.d_length[1] == 0
    assert not compliant_lanes(kernel, [h[0]] * 7 + [h[1]], LENGTH, c, E_STAR)[1]
    top = 4 * np.pi * E_STAR * LENGTH * np.exp(body - 2)
    _, _, codes = compliant_penetration(
        kernel, top * np.array([1 - 1e-9, 1 + 1e-9]), LENGTH, c, E_STAR
    )
    assert list(codes) == [OK, OUT_OF_DOMAIN]


def test_compliance_of_teeth_has_no_limit_that_matters(kernel: Kernel):
    c = 15 / (np.pi * E_STAR)
    assert not compliant_force(kernel, [0.01, 1.0, 1000.0], LENGTH, c, E_STAR).code.any()


@pytest.mark.parametrize(
    ("h", "length"), [(np.nan, 0.05), (np.inf, 0.05), (1e-6, 0.0), (1e-6, -0.1), (1e-6, np.nan)]
)
def test_nonsense_is_out_of_domain(kernel: Kernel, h: float, length: float):
    assert list(compliant_force(kernel, h, length, 1e-10, E_STAR).code) == [OUT_OF_DOMAIN]
