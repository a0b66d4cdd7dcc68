"""Engineering units: axes and tables read 3.2 µm and 1500 rpm, not 3.2e-06 m and 157.08 rad/s."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

SUPERSCRIPTS = {2: "²", 3: "³", 4: "⁴"}
PREFIXES = {"f": 1e-15, "p": 1e-12, "n": 1e-9, "µ": 1e-6, "m": 1e-3, "": 1.0, "k": 1e3, "M": 1e6}
PREFIXES |= {"G": 1e9, "T": 1e12}
MICRO = re.compile("^u(?=[A-Za-z])")  # as it is typed
PLAIN = 1e7  # smaller numbers have no exponent: 10990 rpm, not 1.099e+04 rpm
SLACK = 1e-9  # 999.9999999 of one unit is shown as 1 of the next


class Unit(NamedTuple):
    """One unit for the display of values."""

    name: str  # as it is printed
    factor: float  # from SI to it
    least: float = 1.0  # smallest value for which it is used, in this unit


def _with(prefixes: str, rest: str, **least: float) -> list[Unit]:
    """Units that differ by their prefixes; a dot denotes no prefix."""
    names = [prefix.replace(".", "") for prefix in prefixes]
    return [Unit(p + rest, 1.0 / PREFIXES[p], least.get(p or "none", 1.0)) for p in names]


# The units of each SI unit, as a history writes it, from small to large.
UNITS: dict[str, list[Unit]] = {
    "m": _with("fpnµm.", "m", none=10.0),  # drawings are in mm
    "m s-1": _with("pnµm.", "m/s"),
    "m s-2": _with("pnµm.", "m/s²"),
    "rad": [*_with("pnµm", "rad"), Unit("°", 180.0 / math.pi)],
    "rad s-1": [*_with("pnµm", "rad/s"), Unit("rpm", 30.0 / math.pi)],
    "rad s-2": _with("pnµm.k", "rad/s²"),
    "s": _with("pnµm.", "s"),
    "Hz": _with("µm.kM", "Hz"),
    "N": _with("pnµm.kMG", "N"),
    "N m": _with("pnµm.kMG", "N m"),
    "N m-1": [Unit("N/m", 1.0), Unit("N/mm", 1e-3), Unit("N/µm", 1e-6)],
    "N s m-1": _with("m.kM", "N s/m"),
    "N m rad-1": _with("m.kMG", "N m/rad"),
    "N m s rad-1": _with("µm.kM", "N m s/rad"),
    "Pa": _with(".kMG", "Pa", G=10.0),  # contact pressures in MPa, moduli in GPa
    "J": _with("pnµm.kMG", "J"),
    "W": _with("pnµm.kMG", "W"),
    "kg": [Unit("mg", 1e6), Unit("g", 1e3), Unit("kg", 1.0, 0.1)],
    "kg m2": [Unit("kg mm²", 1e6), Unit("kg m²", 1.0, 0.1)],
}


def engineering(values: ArrayLike, units: str) -> tuple[float, str]:
    """Choose the unit for the display of values: the largest in which they are not below 1.

    Parameters
    ----------
    values : displayed together, in SI; the largest absolute value counts.
    units : as the attribute `units` of a variable has it, such as "m", "rad s-1"; "1" if without.

    Returns
    -------
    The factor for the values, and the unit; empty for "1". If all values are 0 or not finite, the
    SI unit if it is in the table, else the largest. Units that are not in the table are unchanged.
    """
    import numpy as np

    sizes = np.abs(np.asarray(values, dtype=float))
    largest = float(sizes[np.isfinite(sizes)].max(initial=0.0))
    known = UNITS.get(units)
    if known is None:
        return 1.0, displayed(units)
    if largest == 0.0:
        chosen = next((unit for unit in known if unit.factor == 1.0), known[-1])
    else:
        fits = [u for u in known if largest * u.factor >= u.least * (1.0 - SLACK)]
        chosen = fits[-1] if fits else known[0]
    return chosen.factor, chosen.name


def displayed(units: str) -> str:
    """Format a UDUNITS string for print: "kg m2 s-1" as kg m²/s, "1" as an empty string."""
    above: list[str] = []
    below: list[str] = []
    for factor in units.split():
        match = re.fullmatch(r"([A-Za-z]+)(-?\d+)?", factor)
        if match is None or units == "1":
            return "" if units == "1" else units
        power = int(match[2] or 1)
        (above if power > 0 else below).append(
            MICRO.sub("µ", match[1]) + SUPERSCRIPTS.get(abs(power), "")
        )
    if not below:
        return " ".join(above)
    denominator = below[0] if len(below) == 1 else f"({' '.join(below)})"
    return f"{' '.join(above) or '1'}/{denominator}"


def quantity(value: float, units: str, digits: int = 6) -> str:
    """Format a value in its engineering unit, such as "65.4406 mm", "45°", "1500 rpm"."""
    factor, shown = engineering(value, units)
    text = f"{value * factor:.{digits}g}"
    if "e+" in text and abs(value * factor) < PLAIN:
        text = f"{float(text):.0f}"
    return f"{text}{'' if shown in ('', '°') else ' '}{shown}"


def axis_label(text: str, unit: str) -> str:
    """Label of an axis or column: text, and unit if there is one."""
    return f"{text} [{unit}]" if unit else text
