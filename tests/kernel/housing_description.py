"""Descriptions of housings with the keys of the case file, in SI units and radians."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from kernel.description import Block

HOUSING_FIXED, PRESCRIBED, MOUNTED = "fixed", "prescribed", "mounted"
CONSTANT, RATE, HARMONIC, SPLINE = "constant", "rate", "harmonic", "table"
X, Y, Z, TURN_X, TURN_Y, TURN_Z = range(6)

_MOUNT = {
    "mount_point": "point",
    **{
        name: name
        for name in ("stiffness", "damping", "rotational_stiffness", "rotational_damping")
    },
}


def term(
    coordinate: int,
    kind: str,
    value: float = 0.0,
    *,
    frequency: float = 0.0,
    phase: float = 0.0,
    table: Sequence[tuple[float, float]] = (),
) -> Block:
    """Term of a prescribed motion; table: (time, value) pairs."""
    result = Block(coordinate=coordinate, kind=kind, axis="xyz"[coordinate % 3])
    if kind == HARMONIC:
        result.update(amplitude=value, frequency=frequency, phase=phase)
    elif kind == SPLINE:
        result.update(time=[t for t, _ in table], value=[v for _, v in table])
    else:
        result.value = value
    return result


def housing(kind: str, *, terms: Sequence[Block] = (), **values: Any) -> Block:
    """Housing with the given values; others are 0, the orientation is that of the ground."""
    result = Block(kind=kind)
    for key, first in (("translation", X), ("rotation", TURN_X)):
        of_key = [
            {name: value for name, value in one.items() if name != "coordinate"}
            for one in terms
            if first <= one.coordinate < first + 3
        ]
        if of_key:
            result[key] = of_key
    mount = {_MOUNT[name]: values.pop(name) for name in list(values) if name in _MOUNT}
    if mount:
        result.mount = mount
    result.update(values)
    return result
