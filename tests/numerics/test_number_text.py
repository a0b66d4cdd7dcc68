"""Numbers as messages of the kernel show them: six digits, against Python's formats."""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import numpy as np
import pytest


def shown(library: Path, value: float) -> str:
    """The number with the unit N."""
    c = ctypes.CDLL(str(library))
    text = ctypes.create_string_buffer(64)
    length = c.st_quantity(ctypes.c_double(value), text)
    return text.raw[:length].decode()


def expected(value: float) -> str:
    """Six significant digits without trailing zeros."""
    if 1e-3 <= abs(value) < 1e6:
        text = f"{value:.{max(0, 5 - math.floor(math.log10(abs(value))))}f}"
        digits, exponent = text, ""
    else:
        digits, letter, exponent = f"{value:.5E}".partition("E")
        exponent = letter + exponent
    return f"{digits.rstrip('0').rstrip('.') if '.' in digits else digits}{exponent} N"


@pytest.mark.parametrize("sign", [1, -1])
def test_every_decade_has_six_digits(kernel_test_library: Path, sign: int) -> None:
    """From the smallest double to the largest; beside each power of ten, too, and any digits."""
    digits = np.random.default_rng(3).uniform(1, 10, 7).tolist()
    for decade in range(-323, 309):
        for mantissa in (1.0, 0.9999999, 0.999995, 1.5, *digits):
            value = sign * mantissa * float(f"1e{decade}")
            if 0 < abs(value) < math.inf:
                assert shown(kernel_test_library, value) == expected(value)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        *((0.0, "0 N"), (-0.0, "0 N"), (math.nan, "NaN N")),
        *((math.inf, "Infinity N"), (-math.inf, "-Infinity N")),
        *((np.finfo(float).max, "1.79769E+308 N"), (5e-324, "4.94066E-324 N")),
        *((-150.0, "-150 N"), (1e5, "100000 N"), (1e6, "1E+06 N"), (999999.6, "1000000 N")),
    ],
)
def test_special_numbers_are_shown(kernel_test_library: Path, value: float, text: str) -> None:
    assert shown(kernel_test_library, value) == text
