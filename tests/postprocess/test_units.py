"""Prefixes and units as they are printed."""

from __future__ import annotations

import math

import pytest

from evolvent.units import displayed, prefixed, quantity


@pytest.mark.parametrize(
    ("largest", "units", "shown", "exponent"),
    [
        (3.2e-9, "m", "nm", 9),
        (9.99e-7, "m", "nm", 9),
        (1e-6, "m", "µm", 6),
        (1e3, "N", "kN", -3),
        (5.04, "N", "N", 0),
        (0.21, "rad s-1", "mrad/s", 3),
        (1.1e11, "Pa", "GPa", -9),
        (-0.002, "m s-1", "mm/s", 3),
        (1e-30, "m", "fm", 15),
        (2.0, "kg m2", "kg·m²", 0),
        (2e-9, "kg", "kg", 0),
        (40.0, "N m", "N·m", 0),
        (1e-5, "1", "", 0),
        (0.0, "m", "m", 0),
        (math.inf, "N", "N", 0),
        (math.nan, "N", "N", 0),
    ],
)
def test_prefix_suits_the_largest_value(largest, units, shown, exponent):
    factor, unit = prefixed(largest, units)
    assert unit == shown
    assert factor == pytest.approx(10.0**exponent, rel=1e-15)


@pytest.mark.parametrize(
    ("units", "shown"),
    [
        ("1", ""),
        ("rad s-2", "rad/s²"),
        ("kg m2 s-2", "kg·m²/s²"),
        ("s-1", "1/s"),
        ("W m-2 K-1", "W/(m²·K)"),
        ("N m-1.5", "N m-1.5"),
        ("degree_C", "degree_C"),
    ],
)
def test_units_are_printed_as_in_print(units, shown):
    assert displayed(units) == shown


@pytest.mark.parametrize(
    ("value", "units", "text"),
    [
        (0.0654411, "m", "65.4411 mm"),
        (math.pi / 4, "rad", "785.398 mrad (45°)"),
        (1.5, "1", "1.5"),
        (0.0, "m", "0 m"),
    ],
)
def test_quantity_reads_as_text(value, units, text):
    assert quantity(value, units) == text
