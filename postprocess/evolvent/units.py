"""SI prefixes, so that axes and tables read 3.2 nm and not 3.2e-09 m."""

from __future__ import annotations

import math
import re

import numpy as np
from numpy.typing import ArrayLike

PREFIXES = dict(
    zip(range(-15, 15, 3), ("f", "p", "n", "µ", "m", "", "k", "M", "G", "T"), strict=True)
)
SUPERSCRIPTS = {2: "²", 3: "³", 4: "⁴"}
# Units that take a prefix at their front; "kg" has one already and "1" has nothing to carry it.
PREFIXABLE = ("m", "N", "Pa", "J", "rad", "s", "W")


def prefixed(values: ArrayLike, units: str) -> tuple[float, str]:
    """Choose a prefix.

    Parameters
    ----------
    values : what is to be shown, in `units`; the largest absolute value counts.
    units : SI unit such as "m", "rad/s", "N m"; "1" if without.

    Returns
    -------
    The factor that values are to be multiplied by, and the unit with its prefix. The factor is 1
    for units that take none, for 0 and for what is no finite number.
    """
    sizes = np.abs(np.asarray(values, dtype=float))
    largest = float(sizes[np.isfinite(sizes)].max(initial=0.0))
    exponent = 0
    head = units.replace("/", " ").split()
    if head and head[0] in PREFIXABLE and largest != 0.0:
        # A little slack: 999.9999 of one unit is better shown as 1 of the next.
        exponent = 3 * math.floor((math.log10(largest) + 1e-9) / 3)
        exponent = min(max(exponent, min(PREFIXES)), max(PREFIXES))
    return 10.0**-exponent, PREFIXES[exponent] + displayed(units)


def displayed(units: str) -> str:
    """Write a UDUNITS string as print has it: "kg m2 s-1" as kg·m²/s, "1" as nothing."""
    above: list[str] = []
    below: list[str] = []
    for factor in units.split():
        match = re.fullmatch(r"([A-Za-z]+)(-?\d+)?", factor)
        if match is None or units == "1":
            return "" if units == "1" else units
        power = int(match[2] or 1)
        (above if power > 0 else below).append(match[1] + SUPERSCRIPTS.get(abs(power), ""))
    if not below:
        return "·".join(above)
    denominator = below[0] if len(below) == 1 else f"({'·'.join(below)})"
    return f"{'·'.join(above) or '1'}/{denominator}"


def quantity(value: float, units: str, digits: int = 6) -> str:
    """Write a value with its prefixed unit, such as "65.4406 mm"; angles in degrees as well."""
    if units == "1":
        return f"{value:.{digits}g}"
    factor, shown = prefixed(value, units)
    text = f"{value * factor:.{digits}g} {shown}"
    return f"{text} ({math.degrees(value):.{digits}g}°)" if units == "rad" else text
