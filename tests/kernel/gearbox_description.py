"""Descriptions of gearboxes as `evolvent/kernel.h` has them, with defaults for the tests.

`wheel`, `load`, `mesh` and `initial` fill in every field that a test does not care about.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kernel.deviations import DeviationDescription
from kernel.kernel import (
    CONTACT,
    DAMPING,
    FRICTION,
    Kernel,
    KindInfo,
    LawChoice,
    _double,
    _int,
    _pair,
)

FIXED, SLIDER, BEARING = range(3)
TORQUE, VISCOUS, TABLE, SPEED = range(4)
CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL = range(3)
REST, STEADY, SPEEDS = range(3)

_bool = ctypes.c_bool


class GearDescription(ctypes.Structure):
    """`evl_gear`."""

    _fields_ = [
        ("normal_module", _double),
        ("pressure_angle", _double),
        ("profile_shift", _double),
        ("rack_addendum", _double),
        ("rack_dedendum", _double),
        ("rack_root_radius", _double),
        ("has_tip_diameter", _bool),
        ("tip_diameter", _double),
        ("has_tip_alteration", _bool),
        ("tip_alteration", _double),
        ("thickness_allowance", _double),
        ("bore", _double),
    ]


class SupportDescription(ctypes.Structure):
    """`evl_support`."""

    _fields_ = [("kind", _int), ("counts", _int * 8), ("numbers", ctypes.POINTER(_double))]


class WheelDescription(ctypes.Structure):
    """`evl_wheel`."""

    _fields_ = [
        ("teeth", _int),
        ("has_pitch_radius", _bool),
        ("pitch_radius", _double),
        ("width", _double),
        ("has_centre", _bool),
        ("centre", _pair),
        ("youngs_modulus", _double),
        ("poisson_ratio", _double),
        ("density", _double),
        ("has_inertia", _bool),
        ("inertia", _double),
        ("has_mass", _bool),
        ("mass", _double),
        ("support", SupportDescription),
        ("has_transverse_inertia", _bool),
        ("transverse_inertia", _double),
        ("axial_position", _double),
        ("has_gear", _bool),
        ("gear", GearDescription),
        ("deviation", DeviationDescription),
    ]


class LoadDescription(ctypes.Structure):
    """`evl_load`."""

    _fields_ = [
        ("wheel", _int),
        ("kind", _int),
        ("against_housing", _bool),
        ("counts", _int * 8),
        ("numbers", ctypes.POINTER(_double)),
    ]


class MeshDescription(ctypes.Structure):
    """`evl_mesh`."""

    _fields_ = [
        ("driving", _int),
        ("driven", _int),
        ("driving_rotation", _int),
        ("has_centre_line_angle", _bool),
        ("centre_line_angle", _double),
        ("paper_rule", _bool),
        ("pressure_angle", _double),
        ("contact", LawChoice),
        ("damping", LawChoice),
        ("friction", LawChoice),
        ("tracking", _int),
        ("has_centre_distance", _bool),
        ("centre_distance", _double),
        ("has_backlash", _bool),
        ("backlash", _double),
    ]


class ShaftDescription(ctypes.Structure):
    """`evl_shaft`."""

    _fields_ = [
        *((name, _int) for name in ("wheel_a", "wheel_b")),
        ("rigid", _bool),
        *((name, _double) for name in ("stiffness", "damping")),
    ]


class InitialDescription(ctypes.Structure):
    """`evl_initial`."""

    _fields_ = [
        ("kind", _int),
        ("speeds", ctypes.POINTER(_double)),
        ("gaps", ctypes.POINTER(_double)),
        ("mesh_position", _double),
    ]


def _filled(structure: Any, defaults: dict[str, Any], given: dict[str, Any]) -> Any:
    values = {**defaults, **given}
    optional = ("pitch_radius", "centre", "inertia", "mass", "transverse_inertia", "gear")
    for name in (*optional, "centre_line_angle", "centre_distance", "backlash"):
        if name in values and hasattr(structure, f"has_{name}"):
            values[f"has_{name}"] = values[name] is not None
            if values[name] is None:
                del values[name]
    for name, value in values.items():
        pair = isinstance(getattr(structure, name), ctypes.Array)
        setattr(structure, name, type(getattr(structure, name))(*value) if pair else value)
    return structure


def wheel(**fields: Any) -> WheelDescription:
    """Steel wheel on a fixed axle; None for what shall follow from the mesh."""
    defaults = {
        **{"teeth": 20, "pitch_radius": None, "width": 0.1, "centre": None},
        **{"youngs_modulus": 2e11, "poisson_ratio": 0.3, "density": 7800.0},
        **{"inertia": None, "mass": None},
    }
    given = {key: fields.pop(key) for key in list(fields) if key.startswith("support_")}
    return _filled(WheelDescription(), {**defaults, "support": support(**given)}, fields)


def support(
    support_kind: int = FIXED,
    support_direction: float = 0.0,
    support_mass: float = 0.0,
    support_stiffness: tuple[float, float] = (0.0, 0.0),
    support_damping: tuple[float, float] = (0.0, 0.0),
) -> SupportDescription:
    """Support of any kind; the direction in radians, of a slider the first of each pair."""
    of_kind = {
        SLIDER: [
            [float(np.degrees(support_direction))],
            [support_mass],
            [support_stiffness[0]],
            [support_damping[0]],
        ],
        BEARING: [[support_mass], list(support_stiffness), list(support_damping)],
    }
    return support_of(support_kind, of_kind.get(support_kind, []))


def support_of(kind: int, parameters: list[list[float]]) -> SupportDescription:
    """Support by the numbers of each of its kind's parameters; [] for one not given."""
    numbers = [number for parameter in parameters for number in parameter]
    counts = [len(parameter) for parameter in parameters]
    return SupportDescription(kind, (_int * 8)(*counts), (_double * len(numbers))(*numbers))


def load(
    wheel: int,
    kind: int,
    value: float = 0.0,
    table: ArrayLike | None = None,
    *,
    against_housing: bool = False,
) -> LoadDescription:
    """Load of a wheel; table: (time, value) pairs."""
    knots = np.array(() if table is None else table, dtype=float).reshape(-1, 2)
    series = [list(knots[:, 0]), list(knots[:, 1])]
    of_kind = {TABLE: series, SPEED: [[value] if table is None else [], *series]}
    return load_of(wheel, kind, of_kind.get(kind, [[value]]), against_housing=against_housing)


def load_of(
    wheel: int, kind: int, parameters: list[list[float]], *, against_housing: bool = False
) -> LoadDescription:
    """Load of a wheel by the numbers of each of its kind's parameters; [] for one not given."""
    numbers = [number for parameter in parameters for number in parameter]
    counts = [len(parameter) for parameter in parameters]
    return LoadDescription(
        wheel=wheel,
        kind=kind,
        against_housing=against_housing,
        counts=(_int * 8)(*counts),
        numbers=(_double * len(numbers))(*numbers),
    )


def load_like(
    kernel: Kernel, wheel: int, sample: dict[str, Any], *, against_housing: bool = False
) -> LoadDescription:
    """Load of a wheel in the words of the case file."""
    kind, series = _numbers_of(kernel.load_kinds(), sample)
    return load_of(wheel, kind, series, against_housing=against_housing)


def support_like(kernel: Kernel, sample: dict[str, Any]) -> SupportDescription:
    """Support in the words of the case file."""
    return support_of(*_numbers_of(kernel.support_kinds(), sample))


def _numbers_of(kinds: list[KindInfo], sample: dict[str, Any]) -> tuple[int, list[list[float]]]:
    """Index of the kind, and the numbers of each of its parameters."""
    kind = [info.name.decode() for info in kinds].index(sample["kind"])
    rows = kinds[kind].parameters[: kinds[kind].n_parameters]
    given = [sample.get(row.name.decode(), []) for row in rows]
    return kind, [value if isinstance(value, list) else [value] for value in given]


def shaft(
    wheel_a: int, wheel_b: int, stiffness: float | None = None, damping: float = 0.0
) -> ShaftDescription:
    """Shaft between two wheels; rigid without a stiffness."""
    return ShaftDescription(wheel_a, wheel_b, stiffness is None, stiffness or 0.0, damping)


def mesh(
    kernel: Kernel,
    driving: int = 0,
    driven: int = 1,
    *,
    damping: float | tuple[str, float] | None = 1e4,
    friction: float | tuple[float, float] = 0.0,
    pressure_angle: float | None = None,
    **fields: Any,
) -> MeshDescription:
    """Mesh with Johnson's law; friction: coefficient, or that and the regularisation velocity.

    `damping` is the coefficient of the linear law, or the name of another law with its coefficient,
    or None for no damping; without a pressure angle the paper's rule gives it.
    """
    name, coefficient = damping if isinstance(damping, tuple) else ("linear", damping)
    no_damping = kernel.law(DAMPING, "none")
    f, delta = friction if isinstance(friction, tuple) else (friction, 1e-4)
    defaults = {
        **{"driving": driving, "driven": driven, "driving_rotation": -1, "centre_line_angle": 0.0},
        **{"paper_rule": pressure_angle is None, "pressure_angle": pressure_angle or 0.0},
        "contact": kernel.law(CONTACT, "johnson"),
        "damping": no_damping
        if damping is None
        else kernel.law(DAMPING, name, coefficient=coefficient),
        "friction": kernel.law(FRICTION, "coulomb", coefficient=f, regularisation_velocity=delta),
        "tracking": CLOSED_FORM,
    }
    return _filled(MeshDescription(), defaults, fields)


def initial(
    kind: int = REST, speeds: ArrayLike | None = None, gaps: ArrayLike | None = None
) -> InitialDescription:
    """Start of a run."""
    description = InitialDescription(kind=kind)
    for name, given in (("speeds", speeds), ("gaps", gaps)):
        if given is not None:
            values = np.atleast_1d(np.asarray(given, dtype=float))
            setattr(description, name, (_double * len(values))(*values))
    return description
