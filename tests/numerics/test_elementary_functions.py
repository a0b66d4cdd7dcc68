"""The elementary functions of the lanes, against mpmath."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest

import machine
from kernel.kernel import Floats, Kernel, _at


def values(kernel: Kernel, name: str, x: Floats, *parameters: float, results: int = 1) -> Floats:
    """One or more results of each number, (result, number)."""
    y = np.empty((results, len(x)))
    rest = (*map(ctypes.c_double, parameters), *map(_at, y))
    getattr(kernel.library, name)(ctypes.c_int(len(x)), _at(x), *rest)
    return y


def errors(y: Floats, x: Floats, exact: Callable[[Any], Any]) -> Floats:
    """How far y is from the exact function of x."""
    with mpmath.workdps(40):
        return np.array(
            [
                float(mpmath.mpf(float(b)) - exact(mpmath.mpf(float(a))))
                for a, b in zip(x, y, strict=True)
            ]
        )


def units(y: Floats, x: Floats, exact: Callable[[Any], Any]) -> float:
    """Return the largest error in units in the last place."""
    return float(np.max(np.abs(errors(y, x, exact)) / np.spacing(np.abs(y))))


def test_logarithm_is_right_to_one_unit_in_the_last_place(kernel: Kernel):
    """Over all normal numbers, and near 1, where ln x is small."""
    random = np.random.default_rng(7)
    x = np.concatenate(
        [
            np.exp(random.uniform(-708, 709, size=4000)),
            1 + random.normal(size=4000) * 10.0 ** random.uniform(-15, -1, size=4000),
            2.0 ** np.arange(-1022, 1024),
            [np.finfo(float).tiny, np.finfo(float).max, np.sqrt(0.5), np.sqrt(2.0), 1.0],
        ]
    )
    ln = values(kernel, "lanes_logarithm", x)[0]
    assert units(ln, x, mpmath.log) < 1
    assert ln[-1] == 0


def test_exponential_is_right_to_one_unit_in_the_last_place(kernel: Kernel):
    """Below -700 it stays what it is there: nothing beside 1."""
    random = np.random.default_rng(1)
    x = np.concatenate(
        [random.uniform(-700, 708, size=3000), draw_magnitudes(random, -18, 1), [0.0]]
    )
    y = values(kernel, "lanes_exponential", x)[0]
    assert units(y, x, mpmath.exp) < 1
    assert y[-1] == 1
    below = values(kernel, "lanes_exponential", np.array([-700.0, -1e3, -1e300, -np.inf]))[0]
    np.testing.assert_array_equal(below, below[0])


def test_hyperbolic_tangent_is_right_to_two_units_in_the_last_place(kernel: Kernel):
    """Near 0, where it is x, as well as where it ends in 1; and it is odd."""
    x = np.concatenate([draw_magnitudes(np.random.default_rng(2), -300, 2), [0.0, 1e300]])
    y = values(kernel, "lanes_hyperbolic_tangent", x)[0]
    assert units(y, x, mpmath.tanh) < 2
    assert np.all(np.abs(y) <= 1)
    np.testing.assert_array_equal(values(kernel, "lanes_hyperbolic_tangent", -x)[0], -y)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1 / 9, 2.25, 4.0])
def test_power_is_right_to_two_units_in_the_last_place(kernel: Kernel, exponent: float):
    """For all that a penetration or a stretch can be."""
    random = np.random.default_rng(3)
    x = np.concatenate([np.exp(random.uniform(-25, 25, size=2000)), 2.0 ** np.arange(-30, 30)])
    y = values(kernel, "lanes_power", x, exponent)[0]
    assert units(y, x, lambda v: v ** mpmath.mpf(exponent)) < 2


def test_powers_of_zero_are_zero_and_zero_to_the_zero_is_one(kernel: Kernel):
    x = np.zeros(3)
    np.testing.assert_array_equal(values(kernel, "lanes_power", x, 0.5)[0], 0)
    np.testing.assert_array_equal(values(kernel, "lanes_power", x, 0.0)[0], 1)


def test_sine_and_cosine_are_right_to_rounding_in_all_quadrants(kernel: Kernel):
    """Rounding of the angle and of the result; near 0, without the first, all digits."""
    random = np.random.default_rng(4)
    x = np.concatenate(
        [
            random.uniform(-100, 100, size=2000),
            random.uniform(-1e5, 1e5, size=500),
            np.pi / 4 * np.arange(-40, 41),
        ]
    )
    s, c = values(kernel, "lanes_sine_cosine", x, results=2)
    assert np.max(np.abs(errors(s, x, mpmath.sin))) < 1.5e-16
    assert np.max(np.abs(errors(c, x, mpmath.cos))) < 1.5e-16
    small = draw_magnitudes(random, -20, -1)
    assert units(values(kernel, "lanes_sine_cosine", small, results=2)[0], small, mpmath.sin) < 1


def test_the_kernel_leaves_the_vector_functions_of_the_c_library_alone(kernel_library: Path):
    """gfortran puts them into loops unasked; they give other bits than the scalar ones."""
    words = [machine.program("nm"), "--dynamic", "--undefined-only", kernel_library]
    listed = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    assert "dgesv" in listed  # the list is there
    assert "_ZGV" not in listed


@pytest.mark.parametrize("name", ["lanes_exponential", "lanes_hyperbolic_tangent"])
def test_what_is_no_number_stays_none(kernel: Kernel, name: str):
    """Limits of the argument do not hide it."""
    assert np.isnan(values(kernel, name, np.array([np.nan]))[0, 0])


def draw_magnitudes(random: np.random.Generator, low: float, high: float) -> Floats:
    """Return numbers of either sign with magnitudes from 10**low to 10**high."""
    return random.choice([-1, 1], size=2000) * 10.0 ** random.uniform(low, high, size=2000)
