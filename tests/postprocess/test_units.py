"""Engineering units and units as they are printed."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

from evolvent.units import UNITS, axis_label, displayed, engineering, quantity

RESULT_FORMAT = Path(__file__).parents[2] / "docs" / "reference" / "result_format.md"


@pytest.mark.parametrize(
    ("largest", "units", "shown", "factor"),
    [
        (3.2e-9, "m", "nm", 1e9),
        (9.99e-7, "m", "nm", 1e9),
        (1e-6, "m", "µm", 1e6),
        (0.065, "m", "mm", 1e3),
        (1.2, "m", "mm", 1e3),
        (10.0, "m", "m", 1),
        (1e3, "N", "kN", 1e-3),
        (5.04, "N", "N", 1),
        (157.08, "rad s-1", "rpm", 30 / math.pi),
        (0.02, "rad s-1", "mrad/s", 1e3),
        (1.26e9, "Pa", "MPa", 1e-6),
        (2.06e11, "Pa", "GPa", 1e-9),
        (-0.002, "m s-1", "mm/s", 1e3),
        (math.pi / 9, "rad", "°", 180 / math.pi),
        (2e-5, "rad", "µrad", 1e6),
        (4e8, "N m-1", "N/µm", 1e-6),
        (150.0, "N m", "N m", 1),
        (0.05, "s", "ms", 1e3),
        (2.0, "kg m2", "kg m²", 1),
        (2e-4, "kg m2", "kg mm²", 1e6),
        (0.8, "kg", "kg", 1),
        (0.02, "kg", "g", 1e3),
        (1e-30, "m", "fm", 1e15),
        (1e30, "N", "GN", 1e-9),
        (1e-5, "1", "", 1),
        (1e-5, "degree_C", "degree_C", 1),
        (0.0, "m", "m", 1),
        (0.0, "rad s-1", "rpm", 30 / math.pi),
        (math.inf, "N", "N", 1),
        (math.nan, "N", "N", 1),
    ],
)
def test_the_unit_suits_the_largest_value(largest, units, shown, factor):
    found, unit = engineering([0.1 * largest, largest], units)
    assert unit == shown
    assert found == pytest.approx(factor, rel=1e-15)


def test_every_unit_of_the_documented_variables_is_in_the_table():
    cells = re.findall(
        r"^\|[^|]*\|[^|]*\| ([^|]*) \|", RESULT_FORMAT.read_text("utf-8"), re.MULTILINE
    )
    reported = {unit.replace("/m", " m-1") for cell in cells for unit in cell.split(", ")}
    units = {
        unit for unit in reported if re.fullmatch(r"(Hz|[NJWsm]|rad|Pa|kg)( [a-z]+-?\d?)*", unit)
    }
    assert len(units) > 15
    assert units <= set(UNITS)


@pytest.mark.parametrize("units", UNITS)
def test_units_rise_and_their_names_differ(units):
    known = UNITS[units]
    sizes = [unit.least / unit.factor for unit in known]
    assert sizes == sorted(sizes)
    assert len({unit.name for unit in known}) == len(known)


@pytest.mark.parametrize("units", UNITS)
def test_numbers_have_few_digits_over_the_whole_range_of_the_table(units):
    # 1 to 10000 of a unit, but for what lies beyond the table
    low, high = (UNITS[units][i].least / UNITS[units][i].factor for i in (0, -1))
    for exponent in range(math.ceil(math.log10(low)), math.floor(math.log10(high)) + 1):
        factor, _ = engineering(10.0**exponent, units)
        assert 0.099 <= 10.0**exponent * factor <= 1e6


@pytest.mark.parametrize(
    ("units", "shown"),
    [
        ("1", ""),
        ("rad s-2", "rad/s²"),
        ("kg m2 s-2", "kg m²/s²"),
        ("s-1", "1/s"),
        ("um", "µm"),
        ("rpm", "rpm"),
        ("W m-2 K-1", "W/(m² K)"),
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
        (math.pi / 4, "rad", "45°"),
        (50 * math.pi, "rad s-1", "1500 rpm"),
        (1.5, "1", "1.5"),
        (0.0, "m", "0 m"),
        (math.nan, "Pa", "nan Pa"),
    ],
)
def test_quantity_reads_as_text(value, units, text):
    assert quantity(value, units) == text


def test_large_numbers_have_no_exponent():
    assert quantity(1151.0, "rad s-1", 4) == "10990 rpm"
    assert quantity(-123456.0 * math.pi / 30, "rad s-1", 3) == "-123000 rpm"


def test_a_label_of_an_axis_has_its_unit_in_brackets():
    assert axis_label("force", "kN") == "force [kN]"
    assert axis_label("efficiency", "") == "efficiency"
