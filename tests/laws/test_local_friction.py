"""Friction laws with a local coefficient, against mpmath."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from kernel.kernel import FRICTION, Floats, Kernel

LANES = 8
DELTA = 1e-9
OIL = {"viscosity": 0.02, "roughness": 5e-7}
# 1 m/s sliding, 5 m/s sum of rolling speeds, 300 N/mm, 10 mm and, for this modulus, 1 GPa
POINT = (1.0, 5.0, 3e5, 100.0)
MODULUS = 1e18 * math.pi * 0.01 / 3e5
# Computed once with 30 digits from the formulas, as printed in docs/reference/laws.md.
PRINTED = {"benedict_kelley": 0.053979094442865, "xu_kahraman": 0.033610725072759}
B = (
    *("-8.916465", "1.03303", "1.036077", "-0.354068", "2.812084"),
    *("-0.100601", "0.752755", "-0.390958", "0.620305"),
)


def factor(
    kernel: Kernel, name: str, x: Any, delta: float = DELTA, **oil: float
) -> tuple[Floats, Floats, Floats]:
    """Return phi in eight states one by one, its derivatives, and phi in all at once."""
    states = np.asfortranarray(np.broadcast_to(x, (LANES, 4)), dtype=float)
    phi, together = np.empty((2, LANES))
    d_phi = np.empty((LANES, 4))
    law = kernel.law(FRICTION, name, regularisation_velocity=delta)
    given = {**OIL, **oil}
    kernel.library.test_law_local_factor(
        law, given["viscosity"], given["roughness"], MODULUS, states.T.copy(), phi, d_phi, together
    )
    return phi, d_phi, together


def exact(name: str, x: Any, delta: float = DELTA, **oil: float) -> mp.mpf:
    """The formula with the stated units inside its limits."""
    given = {key: mp.mpf(repr(value)) for key, value in {**OIL, **oil}.items()}
    v, total, load, curvature = (mp.mpf(float(value)) for value in x)
    u, rolling = (mp.sqrt(value**2 + mp.mpf(delta) ** 2) for value in (v, total))
    eta = given["viscosity"] * 1000
    if name == "benedict_kelley":
        mu = mp.mpf("0.0127") * mp.log10(29660 * load / 1000 / (eta * u * rolling**2))
        return mu * v / u
    b = [mp.mpf(0), *(mp.mpf(text) for text in B)]
    p = mp.sqrt(load * mp.mpf(MODULUS) * curvature / mp.pi) / 10**9
    ratio, speed, rough = 2 * u / rolling, rolling / 2, given["roughness"] * 10**6
    at = ratio * p * mp.log10(eta)
    f = b[1] + b[4] * at + b[5] * mp.exp(-at) + b[9] * mp.exp(rough)
    mu = mp.exp(f) * p ** b[2] * ratio ** b[3] * speed ** b[6] * eta ** b[7] / curvature ** b[8]
    return mu * v / u


def drawn() -> Floats:
    """Eight states inside the limits of both laws."""
    random = np.random.default_rng(3)
    return np.stack(
        [
            random.choice([-1, 1], LANES) * 10 ** random.uniform(-2, 0, LANES),
            random.choice([-1, 1], LANES) * 10 ** random.uniform(0.4, 1.0, LANES),
            10 ** random.uniform(4.5, 6, LANES),
            10 ** random.uniform(1.5, 2.5, LANES),
        ],
        axis=1,
    )


@pytest.mark.parametrize("name", PRINTED)
def test_the_coefficient_at_the_stated_point(kernel: Kernel, name: str):
    phi, _, _ = factor(kernel, name, POINT)
    assert phi[0] == pytest.approx(PRINTED[name], rel=1e-13)
    assert phi[0] == pytest.approx(float(exact(name, POINT)), rel=1e-14)


@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.parametrize("delta", [1e-6, 0.3])
@pytest.mark.parametrize("oil", [{}, {"viscosity": 0.004, "roughness": 2e-7}], ids=str)
def test_it_follows_its_formula(kernel: Kernel, name: str, delta: float, oil: dict[str, float]):
    x = drawn()
    phi, _, _ = factor(kernel, name, x, delta, **oil)
    expected = [float(exact(name, row, delta, **oil)) for row in x]
    np.testing.assert_allclose(phi, expected, rtol=3e-14)  # exponents up to 10
    assert (np.abs(phi) < 0.2).all()


@pytest.mark.parametrize("name", PRINTED)
@pytest.mark.parametrize("delta", [1e-6, 0.3])
def test_its_derivatives_are_those_of_the_formula(kernel: Kernel, name: str, delta: float):
    x = drawn()
    _, d_phi, _ = factor(kernel, name, x, delta)
    for row, found in zip(x, d_phi, strict=True):
        for i in range(4):

            def along(value: mp.mpf, i: int = i, row: Floats = row) -> mp.mpf:
                return exact(name, [*row[:i], value, *row[i + 1 :]], delta)

            step = abs(row[i]) * 1e-5
            slope = (along(row[i] + step) - along(row[i] - step)) / (2 * step)
            assert found[i] == pytest.approx(float(slope), rel=1e-7, abs=1e-18)


@pytest.mark.parametrize("name", PRINTED)
def test_it_is_odd_in_sliding_and_even_in_rolling_to_the_bit(kernel: Kernel, name: str):
    x = drawn()
    phi, _, _ = factor(kernel, name, x, 0.1)
    assert (factor(kernel, name, x * (-1, 1, 1, 1), 0.1)[0] == -phi).all()
    assert (factor(kernel, name, x * (1, -1, 1, 1), 0.1)[0] == phi).all()


@pytest.mark.parametrize("name", PRINTED)
def test_eight_states_at_once_have_the_bits_of_each_alone(kernel: Kernel, name: str):
    random = np.random.default_rng(5)
    for _ in range(40):
        x = 10 ** random.uniform(-6, 6, (LANES, 4))
        x[random.integers(LANES), 2] = random.choice([0.0, -1.0])
        x[random.integers(LANES), :2] = 0.0
        phi, d_phi, together = factor(kernel, name, x, 1e-3)
        assert np.isfinite(phi).all()
        assert np.isfinite(d_phi).all()
        assert (phi == together).all()


def test_benedict_kelley_is_bounded(kernel: Kernel):
    """Slow motion would diverge, and a thick film would be negative."""
    slow, d_slow, _ = factor(kernel, "benedict_kelley", (1e-6, 1e-6, 3e5, 100.0))
    assert slow[0] == pytest.approx(0.2, rel=1e-6)
    assert not d_slow[0, 1:].any()
    thick, d_thick, _ = factor(kernel, "benedict_kelley", (20.0, 60.0, 10.0, 100.0))
    assert thick[0] == 0
    assert not d_thick[0].any()


@pytest.mark.parametrize(
    ("outside", "border", "oil", "of_border"),
    [
        (POINT, POINT, {"viscosity": 5e-4}, {"viscosity": 1e-3}),
        (POINT, POINT, {"roughness": 3e-6}, {"roughness": 1e-6}),
        ((1.0, 5.0, 1.0, 100.0), (1.0, 5.0, 3e5 * 0.05**2, 100.0), {}, {}),
        ((1.0, 5.0, 3e8, 100.0), (1.0, 5.0, 3e5 * 16, 100.0), {}, {}),
    ],
    ids=["viscosity", "roughness", "light", "heavy"],
)
def test_xu_kahraman_holds_its_arguments_at_their_limits(
    kernel: Kernel, outside: Any, border: Any, oil: dict[str, float], of_border: dict[str, float]
):
    found, _, _ = factor(kernel, "xu_kahraman", outside, **oil)
    assert found[0] == pytest.approx(
        factor(kernel, "xu_kahraman", border, **of_border)[0][0], rel=1e-13
    )


def test_xu_kahraman_vanishes_at_the_pitch_point(kernel: Kernel):
    near, nearer = (factor(kernel, "xu_kahraman", (v, 5.0, 3e5, 100.0))[0][0] for v in (1e-3, 1e-4))
    assert 0 < nearer < near / 8
