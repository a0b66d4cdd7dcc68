"""Friction laws without branches: tanh and Stribeck against mpmath."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import FRICTION, Kernel

EPS = float(np.finfo(float).eps)
V = np.array([-5.0, -1e-2, -3e-4, -1e-5, 0.0, 1e-9, 1e-4, 2e-3, 0.05, 1.0])
TANH = {"coefficient": 0.3, "regularisation_velocity": 2e-4}
STRIBECK = {
    "static_coefficient": 0.25,
    "kinetic_coefficient": 0.1,
    "stribeck_velocity": 0.02,
    "regularisation_velocity": 3e-4,
}
LAWS = {"tanh": TANH, "stribeck": STRIBECK}


def exact_tanh(v: mp.mpf) -> mp.mpf:
    return mp.mpf(0.3) * mp.tanh(v / mp.mpf(2e-4))


def exact_stribeck(v: mp.mpf) -> mp.mpf:
    static, kinetic = mp.mpf(0.25), mp.mpf(0.1)
    curve = kinetic + (static - kinetic) * mp.exp(-((v / mp.mpf(0.02)) ** 2))
    return curve * mp.tanh(v / mp.mpf(3e-4))


EXACT = {"tanh": exact_tanh, "stribeck": exact_stribeck}


@pytest.fixture(params=LAWS)
def name(request):
    return request.param


@pytest.fixture
def law(kernel: Kernel, name: str):
    return kernel.law(FRICTION, name, **LAWS[name])


def test_the_factor_is_that_of_its_formula(kernel: Kernel, law, name: str):
    factor, _ = kernel.law_friction_factor(law, 0, V)
    with mp.workdps(40):
        exact = [float(EXACT[name](mp.mpf(float(v)))) for v in V]
    # rounding of the quotients, which tanh and exp(-x**2) amplify by less than 1
    np.testing.assert_allclose(factor, exact, rtol=6 * EPS)


def test_the_derivative_is_that_of_the_formula(kernel: Kernel, law, name: str):
    _, d_v = kernel.law_friction_factor(law, 0, V)
    with mp.workdps(40):
        exact = [float(mp.diff(EXACT[name], mp.mpf(float(v)))) for v in V]
    # in the tail 1 - tanh is smaller than the rounding of tanh: that much of the slope at rest
    np.testing.assert_allclose(d_v, exact, rtol=1e-13, atol=4 * EPS * max(exact))


def test_the_factor_is_odd_and_opposes_sliding(kernel: Kernel, law):
    plus, minus = (kernel.law_friction_factor(law, 0, sign * V) for sign in (1, -1))
    np.testing.assert_array_equal(minus[0], -plus[0])
    np.testing.assert_array_equal(minus[1], plus[1])
    assert (plus[0] * V >= 0).all()
    assert plus[0][V == 0] == 0


def test_there_are_no_branches_to_locate(kernel: Kernel, law):
    assert kernel.law_friction_knee(law) == 0
    assert not kernel.law_friction_mode(law, V).any()
    for mode in (-1, 1):
        np.testing.assert_array_equal(
            kernel.law_friction_factor(law, mode, V), kernel.law_friction_factor(law, 0, V)
        )


def test_stribeck_falls_from_static_to_kinetic_friction(kernel: Kernel):
    wide = {**STRIBECK, "regularisation_velocity": 1e-8}
    factor, d_v = kernel.law_friction_factor(kernel.law(FRICTION, "stribeck", **wide), 0, V)
    sliding = V > 2e-8  # the smoothing is done there
    assert factor[sliding].max() == pytest.approx(0.25, rel=1e-3)
    assert factor[-1] == pytest.approx(0.1, rel=1e-15)
    assert (d_v[sliding] <= 0).all()


def test_stribeck_with_equal_coefficients_is_tanh(kernel: Kernel):
    equal = {**STRIBECK, "static_coefficient": 0.3, "kinetic_coefficient": 0.3}
    stribeck = kernel.law_friction_factor(kernel.law(FRICTION, "stribeck", **equal), 0, V)
    smooth = kernel.law(FRICTION, "tanh", coefficient=0.3, regularisation_velocity=3e-4)
    np.testing.assert_allclose(stribeck, kernel.law_friction_factor(smooth, 0, V), rtol=4 * EPS)
