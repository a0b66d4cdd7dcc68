"""Descriptions of housings as `evolvent/kernel.h` has them."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

from kernel.kernel import _double, _int

HOUSING_FIXED, PRESCRIBED, MOUNTED = range(3)
CONSTANT, RATE, HARMONIC, SPLINE = range(4)
X, Y, Z, TURN_X, TURN_Y, TURN_Z = range(6)

_vector = _double * 3
_quaternion = _double * 4
_numbers = ctypes.POINTER(_double)


class MotionTerm(ctypes.Structure):
    """`evl_motion_term`."""

    _fields_ = [
        ("coordinate", _int),
        ("kind", _int),
        ("value", _double),
        ("frequency", _double),
        ("phase", _double),
        ("n", _int),
        ("time", _numbers),
        ("values", _numbers),
    ]


class HousingDescription(ctypes.Structure):
    """`evl_housing`."""

    _fields_ = [
        ("kind", _int),
        ("gravity", _vector),
        ("n_terms", _int),
        ("terms", ctypes.POINTER(MotionTerm)),
        ("mass", _double),
        *((name, _vector) for name in ("centre_of_mass", "inertia", "products_of_inertia")),
        *((name, _vector) for name in ("mount_point", "stiffness", "damping")),
        *((name, _vector) for name in ("rotational_stiffness", "rotational_damping")),
        *((name, _vector) for name in ("force", "moment", "position")),
        ("orientation", _quaternion),
        ("velocity", _vector),
        ("angular_velocity", _vector),
    ]


def term(
    coordinate: int,
    kind: int,
    value: float = 0.0,
    *,
    frequency: float = 0.0,
    phase: float = 0.0,
    table: Sequence[tuple[float, float]] = (),
) -> MotionTerm:
    """Term of a prescribed motion; table: (time, value) pairs."""
    result = MotionTerm(
        coordinate=coordinate, kind=kind, value=value, frequency=frequency, phase=phase
    )
    if table:
        result.n = len(table)
        result.time = (_double * len(table))(*(time for time, _ in table))
        result.values = (_double * len(table))(*(knot for _, knot in table))
    return result


def housing(kind: int, *, terms: Sequence[MotionTerm] = (), **values: Any) -> HousingDescription:
    """Housing with the numbers that are given; the others are 0, the orientation the ground's."""
    result = HousingDescription(kind=kind, orientation=_quaternion(1.0))
    if terms:
        result.n_terms = len(terms)
        result.terms = (MotionTerm * len(terms))(*terms)
    for name, given in values.items():
        field = getattr(result, name)
        is_vector = isinstance(field, ctypes.Array)
        setattr(result, name, type(field)(*map(float, given)) if is_vector else given)
    return result
