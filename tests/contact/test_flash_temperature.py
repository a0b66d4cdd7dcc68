"""Flash temperature by Blok: a hand value, its factor by quadrature, and where it is undefined."""

from __future__ import annotations

import ctypes

import mpmath as mp
import numpy as np
import pytest

from kernel.interface import fields
from kernel.kernel import Kernel

STEEL = {"conductivity": 45.0, "density": 7830.0, "heat": 460.0}
# 300 N/mm, 1 GPa, coefficient of friction 0.05, 5 and 4 m/s
POINT = {
    "line_load": 3e5,
    "pressure": 1e9,
    "heat": 0.05 * 3e5 * (5.0 - 4.0),
    "v_a": 5.0,
    "v_b": 4.0,
}


class Thermal(ctypes.Structure):
    """`given_thermal`."""

    _fields_ = fields("given_thermal")


def found(kernel: Kernel, **changes: float) -> np.ndarray:
    """B_MA, B_MB, half width, flash temperature."""
    given = {f"{key}_{side}": value for key, value in STEEL.items() for side in "ab"}
    values = np.empty(4)
    kernel.library.test_flash_temperature(Thermal(**{**given, **POINT, **changes}), values)
    return values


def largest_of_source() -> tuple[mp.mpf, mp.mpf]:
    """Position over a, and value over q/(B sqrt(v) sqrt(2 a)), of the maximum. Equation FT5.

    With q(x') = 2 q/(pi a) sqrt(1 - (x'/a)^2) the integral is 2 q/(pi sqrt(a)) times
    int sqrt(1 - s^2)/sqrt(x - s) ds; s = x - u^2 removes the singularity.
    """

    def integral(x: mp.mpf) -> mp.mpf:
        end = mp.sqrt(x + 1)
        return 2 * mp.quad(lambda u: mp.sqrt(max(1 - (x - u * u) ** 2, mp.mpf(0))), [0, end])

    with mp.workdps(20):
        at = mp.findroot(lambda x: mp.diff(integral, x), mp.mpf("0.65"))
        return at, integral(at) * 2 / mp.pi / mp.sqrt(mp.pi) * mp.sqrt(2)


def test_the_factor_is_that_of_a_fast_semi_elliptic_source(kernel: Kernel):
    at, factor = largest_of_source()
    assert float(at) == pytest.approx(0.652, abs=5e-4)
    assert float(factor) == pytest.approx(1.1115, abs=5e-5)
    # one body carries all heat if the other has no conductivity; 1.11 is the factor rounded
    coefficient, _, half_width, flash = found(kernel, conductivity_b=0.0)
    exact = factor * POINT["heat"] / (coefficient * mp.sqrt(5.0) * mp.sqrt(2 * half_width))
    assert flash == pytest.approx(float(exact), rel=2e-3)


def test_the_value_by_hand(kernel: Kernel):
    """B_M = sqrt(45 7830 460), a = 2 3e5/(pi 1e9), 1.11 15000/(B_M (sqrt 5 + 2) sqrt(2 a))."""
    coefficient, other, half_width, flash = found(kernel)
    assert coefficient == other == pytest.approx(12731.1036, rel=1e-8)
    assert half_width == pytest.approx(1.9098593e-4, rel=1e-7)
    assert flash == pytest.approx(15.796817, rel=1e-7)


def test_each_body_has_its_own_coefficient_and_velocity(kernel: Kernel):
    plastic = {"conductivity": 0.25, "density": 1400.0, "heat": 1500.0}
    of_b = {f"{key}_b": value for key, value in plastic.items()}
    of_a = {f"{key}_a": value for key, value in plastic.items()}
    one = found(kernel, **of_b)
    turned = found(kernel, **of_a, v_a=4.0, v_b=5.0)
    assert one[3] == turned[3]
    assert list(one[:2]) == list(turned[1::-1])
    b_a, b_b = np.sqrt([45 * 7830 * 460, 0.25 * 1400 * 1500])
    carried = b_a * np.sqrt(5) + b_b * np.sqrt(4)
    assert one[3] == pytest.approx(1.11 * 15e3 / carried / np.sqrt(2 * one[2]), rel=1e-14)


def test_the_sense_of_both_velocities_does_not_matter(kernel: Kernel):
    assert found(kernel, v_a=-5.0, v_b=-4.0)[3] == found(kernel)[3]
    assert found(kernel, v_a=-5.0)[3] == found(kernel)[3]


def test_without_heat_it_is_zero_and_of_a_source_at_rest_undefined(kernel: Kernel):
    assert found(kernel, heat=0.0)[3] == 0
    assert np.isfinite(found(kernel, v_a=0.0)[3])
    assert np.isnan(found(kernel, v_a=0.0, v_b=0.0)[3])
    assert np.isnan(found(kernel, v_a=0.0, v_b=0.0, heat=0.0)[3])
