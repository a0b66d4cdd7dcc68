"""Johnson's force against mpmath (50 digits), the paper's iteration and its proof."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import NO_SOLUTION, OK, OUT_OF_DOMAIN, Kernel

EPS = np.finfo(float).eps
E_STAR = 1.0989010989010988e11  # steel on steel [Pa]
RHO = 0.065441  # sum of the radii of curvature of the paper's setup [m]

# x = e h/(4 rho) from the smallest to just below the limit 1/e, dense near both ends
X = np.concatenate(
    [
        np.logspace(-300, -1, 599),
        np.linspace(0.1, 0.36, 100),
        (1 - np.logspace(-6, -1, 101)) / np.e,
    ]
)


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(50):
        yield


def penetration(x: np.ndarray, rho: float = RHO) -> np.ndarray:
    return 4 * rho * x / np.e


def exact_w(h: float, rho: float) -> mp.mpf:
    """Return w = -W_{-1}(-x) at the very doubles h, rho."""
    return -mp.lambertw(-mp.e * mp.mpf(h) / (4 * mp.mpf(rho)), -1).real


def relative(value: float, exact: mp.mpf) -> float:
    return float(abs(mp.mpf(float(value)) / exact - 1))


def test_force_is_within_4_eps_times_its_condition_number(kernel: Kernel):
    h = penetration(X)
    result = kernel.johnson_force(h, RHO, E_STAR)
    assert not result.code.any()
    for hi, force in zip(h, result.force, strict=True):
        w = exact_w(hi, RHO)
        condition = float(w / (w - 1))  # d ln N/d ln h
        exact = mp.pi * mp.mpf(E_STAR) * mp.mpf(hi) / w
        assert relative(force, exact) <= 4 * EPS * condition, f"h = {hi}"


def test_stiffness_and_radius_derivative_are_exact_to_their_condition_number(kernel: Kernel):
    h = penetration(X)
    result = kernel.johnson_force(h, RHO, E_STAR)
    for hi, d_h, d_rho in zip(h, result.d_h, result.d_rho, strict=True):
        w = exact_w(hi, RHO)
        # d ln(w - 1)/d ln h = -w/(w - 1)**2 amplifies rounding of h/rho, of ln and of the product
        tolerance = 4 * EPS * float(1 + w / (w - 1) ** 2)
        assert relative(d_h, mp.pi * mp.mpf(E_STAR) / (w - 1)) <= tolerance
        exact = -mp.pi * mp.mpf(E_STAR) * mp.mpf(hi) / (mp.mpf(RHO) * w * (w - 1))
        assert relative(d_rho, exact) <= 2 * tolerance


def test_derivatives_are_those_of_the_defining_equation(kernel: Kernel):
    """Independent of W: implicit differentiation of (13) by mpmath's numerical derivative."""
    for x in (1e-8, 1e-3, 0.1, 0.3):
        h = float(penetration(np.array([x]))[0])
        result = kernel.johnson_force(h, RHO, E_STAR)

        def force(hh: mp.mpf, rho: mp.mpf, start: float = float(result.force[0])) -> mp.mpf:
            modulus = mp.mpf(E_STAR)

            def residual(n: mp.mpf) -> mp.mpf:
                return n / (mp.pi * modulus) * (mp.log(4 * mp.pi * modulus * rho / n) - 1) / hh - 1

            return mp.findroot(residual, start)

        assert relative(result.d_h[0], mp.diff(force, (h, RHO), (1, 0))) < 1e-13
        assert relative(result.d_rho[0], mp.diff(force, (h, RHO), (0, 1))) < 1e-13


def test_force_satisfies_johnsons_equation(kernel: Kernel):
    h = penetration(np.logspace(-12, np.log10(0.36), 60))
    result = kernel.johnson_force(h, RHO, E_STAR)
    for hi, force in zip(h, result.force, strict=True):
        n, modulus = mp.mpf(float(force)), mp.mpf(E_STAR)
        back = n / (mp.pi * modulus) * (mp.log(4 * mp.pi * modulus * mp.mpf(RHO) / n) - 1)
        # backward error: h moves by less than the force's own rounding, d ln h/d ln N < 1
        assert relative(hi, back) <= 4 * EPS


def test_penetration_from_force_is_within_4_eps_times_its_condition_number(kernel: Kernel):
    y = np.concatenate([np.logspace(-300, -1, 300), (1 - np.logspace(-6, -1, 60)) / np.e])
    force = y * 4 * np.pi * E_STAR * RHO / np.e
    h, codes = kernel.johnson_penetration(force, RHO, E_STAR)
    assert not codes.any()
    for n, hi in zip(force, h, strict=True):
        modulus = mp.mpf(E_STAR)
        log_ratio = mp.log(4 * mp.pi * modulus * mp.mpf(RHO) / mp.mpf(n))
        exact = mp.mpf(n) / (mp.pi * modulus) * (log_ratio - 1)
        # rounding of the ratio and of its logarithm L enter L - 1, which is at least 1
        assert relative(hi, exact) <= 4 * EPS * float(log_ratio / (log_ratio - 1))


def test_penetration_and_force_are_inverse_to_each_other(kernel: Kernel):
    h = penetration(np.logspace(-30, np.log10(0.36), 200))
    h = np.concatenate([-h, [0.0], h])
    result = kernel.johnson_force(h, RHO, E_STAR)
    back, codes = kernel.johnson_penetration(result.force, RHO, E_STAR)
    assert not codes.any()
    np.testing.assert_allclose(back, h, rtol=8 * EPS, atol=0)


def test_force_is_odd_and_zero_without_nan_at_zero(kernel: Kernel):
    h = penetration(np.logspace(-200, np.log10(0.36), 50))
    plus, minus = kernel.johnson_force(h, RHO, E_STAR), kernel.johnson_force(-h, RHO, E_STAR)
    assert (minus.force == -plus.force).all()
    assert (minus.d_h == plus.d_h).all()
    assert (minus.d_rho == -plus.d_rho).all()
    zero = kernel.johnson_force([0.0, -0.0], RHO, E_STAR)
    assert not np.any(zero.force)
    assert not np.any(zero.d_h)
    assert not np.any(zero.d_rho)
    assert not zero.code.any()


def test_force_of_the_smallest_penetrations_is_finite_and_ordered(kernel: Kernel):
    h = np.array([5e-324, 1e-310, 1e-305, 1e-300, 1e-290])
    result = kernel.johnson_force(h, RHO, E_STAR)
    assert np.isfinite(result.force).all()
    assert (np.diff(result.force) > 0).all()
    assert (result.d_h > 0).all()
    assert not result.code.any()


@pytest.mark.parametrize("sign", [1, -1])
def test_limits_are_diagnosed_just_outside_and_not_just_inside(kernel: Kernel, sign: int):
    h_limit, force_limit = kernel.johnson_limits(RHO, E_STAR)
    assert h_limit == pytest.approx(4 * RHO / np.e**2, rel=4 * EPS)
    assert force_limit == pytest.approx(4 * np.pi * E_STAR * RHO / np.e**2, rel=4 * EPS)
    factors = np.array([1 - 1e-14, 1 + 1e-14, 2.0, np.inf, np.nan])
    expected = [OK] + 4 * [OUT_OF_DOMAIN]
    result = kernel.johnson_force(sign * factors * h_limit, RHO, E_STAR)
    assert list(result.code) == expected
    assert not np.any(result.force[1:])
    h, codes = kernel.johnson_penetration(sign * factors * force_limit, RHO, E_STAR)
    assert list(codes) == expected
    assert not np.any(h[1:])


def test_the_last_numbers_below_the_limit_are_refused_or_finite(kernel: Kernel):
    """The stiffness is infinite at the limit: rounding must not let that, or NaN, through."""
    h_limit, _ = kernel.johnson_limits(RHO, E_STAR)
    h = h_limit * (1 + EPS * np.arange(-40, 40))
    result = kernel.johnson_force(h, RHO, E_STAR)
    accepted = result.code == OK
    assert accepted[0]
    assert not accepted[-1]
    assert (np.diff(accepted.astype(int)) <= 0).all()
    assert np.isfinite([result.force, result.d_h, result.d_rho]).all()
    assert (result.force[accepted] > 0).all()


@pytest.mark.parametrize("rho", [0.0, -1.0, np.nan])
def test_radii_without_contact_are_out_of_domain(kernel: Kernel, rho: float):
    for h in (0.0, 1e-9):
        assert kernel.johnson_force(h, rho, E_STAR).code[0] == OUT_OF_DOMAIN


# ---- the paper's iteration (18) and the proof of its convergence

STARTS = np.linspace(0, 1 / np.e, 22)[1:-1]  # 20 starts in (0, 1/e)
PROOF_X = np.concatenate([np.logspace(-300, -1, 60), [0.2, 0.3, 0.35, (1 - 1e-4) / np.e]])


@pytest.mark.parametrize("x", PROOF_X)
def test_iterates_stay_between_0_and_nu(kernel: Kernel, x: float):
    nu = -1 / np.log(x)
    eta = STARTS
    for _ in range(200):
        eta = kernel.johnson_iteration(eta, nu)
        assert (eta > 0).all()
        # at its fixed point eta ln eta reaches rounding only if x < 1e-16: nu itself is not reached
        assert (eta < nu).all()


@pytest.mark.parametrize("x", PROOF_X)
def test_iteration_converges_from_every_start_to_the_fast_force(kernel: Kernel, x: float):
    h = float(penetration(np.array([x]))[0])
    force, _, codes = kernel.johnson_iteration_force(h, RHO, E_STAR, STARTS, 1e-15, 20000)
    assert list(codes) == [OK] * len(STARTS)
    w = float(exact_w(h, RHO))
    fast = kernel.johnson_force(h, RHO, E_STAR).force[0]
    # an iteration that contracts by 1/w stops within tolerance w/(w - 1) of its limit; ln x is
    # rounded to eps of its size
    np.testing.assert_allclose(force, fast, rtol=16 * EPS * (w / (w - 1)) ** 2, atol=0)


def test_iteration_of_real_gears_takes_15_to_22_turns(kernel: Kernel):
    """As the theory says of real gears, to 1e-14, from the middle of (0, 1/e)."""
    h = np.logspace(-9, -5, 20)
    _, turns, codes = kernel.johnson_iteration_force(h, RHO, E_STAR, 0.5 / np.e, 1e-14)
    assert not codes.any()
    assert turns.min() >= 10
    assert turns.max() <= 22


def test_iteration_that_does_not_converge_in_time_says_so(kernel: Kernel):
    h = penetration(np.array([0.3]))
    force, turns, codes = kernel.johnson_iteration_force(h, RHO, E_STAR, 0.1, 1e-15, 3)
    assert list(codes) == [NO_SOLUTION]
    assert list(turns) == [3]
    assert not np.any(force)


@pytest.mark.parametrize("start", [0.0, -0.1, 1 / np.e, 1.0, np.nan])
def test_iteration_refuses_a_start_outside_0_to_1_over_e(kernel: Kernel, start: float):
    _, _, codes = kernel.johnson_iteration_force(1e-9, RHO, E_STAR, start)
    assert list(codes) == [OUT_OF_DOMAIN]


def test_iteration_refuses_penetrations_outside_its_domain(kernel: Kernel):
    h_limit, _ = kernel.johnson_limits(RHO, E_STAR)
    h = [0.0, -1e-9, h_limit * (1 + 1e-14), np.nan]
    _, _, codes = kernel.johnson_iteration_force(h, RHO, E_STAR, 0.1)
    assert list(codes) == [OUT_OF_DOMAIN] * 4
