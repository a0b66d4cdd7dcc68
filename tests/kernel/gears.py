"""Real gears of the kernel from Python: a thin ctypes binding.

Those of a gearbox by `tests/gearbox/geometry_calls.f90`, gears alone by
`tests/geometry/gear_calls.f90`.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kernel.description import Block, create
from kernel.gearbox import Gearbox
from kernel.gearbox_description import _bool
from kernel.kernel import OK, Floats, Integers, Kernel, Status, _at, _double, _error, _int


class GearGeometry(ctypes.Structure):
    """`gear_t` of the kernel."""

    _fields_ = [
        ("teeth", _int),
        *((name, _double) for name in ("normal_module", "pressure_angle", "profile_shift")),
        *((name, _double) for name in ("generating_shift", "undercut_shift", "tip_alteration")),
        *((name, _double) for name in ("pitch", "base_pitch", "reference_radius", "base_radius")),
        *((name, _double) for name in ("tip_radius", "tip_rounding", "tip_form_radius")),
        *((name, _double) for name in ("root_radius", "form_radius", "bore_radius")),
        *((name, _double) for name in ("tooth_depth", "thickness", "thickness_allowance")),
        *((name, _double) for name in ("tip_thickness", "tooth_angle", "tool_depth")),
        ("tool_rounding", _double),
        ("is_undercut", _bool),
    ]

    def fields(self) -> list[float]:
        """All of them: the bytes between them may be any."""
        return [getattr(self, name) for name, _ in self._fields_]


_MESH_NUMBERS = (
    *("centre_distance", "reference_distance", "tight_distance", "base_radius_sum"),
    "working_pressure_angle",
    *("pitch_radius_a", "pitch_radius_b", "line_of_action", "base_pitch"),
    *("path_of_contact", "approach", "recess", "contact_ratio"),
    *("rho_tip_a", "rho_tip_b", "rho_end_a", "rho_end_b"),
    *("active_radius_a", "active_radius_b"),
    *("clearance_a", "clearance_b"),
    *("backlash", "circumferential_backlash", "radial_backlash"),
)


class GearMesh(ctypes.Structure):
    """`gear_mesh_t` of the kernel."""

    _fields_ = [*((name, _double) for name in _MESH_NUMBERS), ("exists", _bool)]


def gear_description(module: float = 0.002, **given: Any) -> Block:
    """Describe a gear; the rack of ISO 53, profile A, and what else a wheel with a module has."""
    rack = {"rack_addendum": 1.0, "rack_dedendum": 1.25, "rack_root_radius": 0.38}
    of_rack = {key.removeprefix("rack_"): given.pop(key, value) for key, value in rack.items()}
    defaults = {"module": module, "pressure_angle": np.radians(20), "profile_shift": 0.0}
    return Block({**defaults, "thickness_allowance": 0.0, "rack": Block(of_rack), **given})


def gear(kernel: Kernel, teeth: int, module: float = 0.002, **given: Any) -> GearGeometry:
    """Geometry of a gear; raises KernelError if it is refused."""
    geometry, status = GearGeometry(), Status()
    form = gear_description(module, **given)
    wheel = {"name": "w", "material": "m", "width": 1.0, "teeth": teeth, **form}
    description = create(kernel.library, {"wheels": [wheel]}, status)
    if description:
        kernel.library.test_gear_derive(description, ctypes.byref(geometry), ctypes.byref(status))
        kernel.library.evl_description_delete(ctypes.byref(description))
    if status.code != OK:
        raise _error(status)
    return geometry


def gear_mesh(
    kernel: Kernel,
    a: GearGeometry,
    b: GearGeometry,
    *,
    centre_distance: float | None = None,
    backlash: float | None = None,
) -> GearMesh:
    """Geometry of two gears in mesh; raises KernelError if it is refused."""
    mesh, status = GearMesh(), Status()
    kernel.library.test_gear_mesh_derive(
        ctypes.byref(a),
        ctypes.byref(b),
        _bool(centre_distance is not None),
        _double(centre_distance or 0.0),
        _bool(backlash is not None),
        _double(backlash or 0.0),
        ctypes.byref(mesh),
        ctypes.byref(status),
    )
    if status.code != OK:
        raise _error(status)
    return mesh


def mesh_geometry(
    kernel: Kernel, a: GearGeometry, b: GearGeometry, centre_distance: float
) -> GearMesh:
    """Geometry of two gears at a centre distance, whether they can mesh or not."""
    mesh = GearMesh()
    kernel.library.test_gear_mesh_geometry(
        ctypes.byref(a), ctypes.byref(b), _double(centre_distance), ctypes.byref(mesh)
    )
    return mesh


def tip_gap(
    kernel: Kernel,
    a: GearGeometry,
    mate: GearGeometry,
    centre_distance: float,
    working_pressure_angle: float,
    rho_tip: float,
) -> float:
    """Smallest gap between the tip of a mate and an undercut gear."""
    ask = kernel.library.test_tip_gap
    ask.restype = _double
    numbers = (_double(centre_distance), _double(working_pressure_angle), _double(rho_tip))
    return float(ask(ctypes.byref(a), ctypes.byref(mate), *numbers))


def tooth_thickness(
    kernel: Kernel, geometry: GearGeometry, radii: ArrayLike
) -> tuple[Floats, Integers]:
    """Tooth thickness at radii, and the codes."""
    r = np.ascontiguousarray(np.atleast_1d(radii), dtype=float)
    thickness, codes = np.empty(len(r)), np.empty(len(r), np.int32)
    kernel.library.test_gear_tooth_thickness(
        ctypes.byref(geometry), len(r), _at(r), _at(thickness), _at(codes)
    )
    return thickness, codes


def involute_value(kernel: Kernel, angles: ArrayLike) -> Floats:
    """Return inv alpha of angles."""
    alpha = np.ascontiguousarray(np.atleast_1d(angles), dtype=float)
    values = np.empty(len(alpha))
    kernel.library.test_involute_value(len(alpha), _at(alpha), _at(values))
    return values


def involute_inverse(kernel: Kernel, involutes: ArrayLike) -> Floats:
    """Return the angles whose involutes these are."""
    values = np.ascontiguousarray(np.atleast_1d(involutes), dtype=float)
    angles = np.empty(len(values))
    kernel.library.test_involute_inverse(len(values), _at(values), _at(angles))
    return angles


def gear_of(gearbox: Gearbox, wheel: int) -> GearGeometry | None:
    """Geometry of a wheel of a gearbox as a real gear; None if it is none."""
    geometry = GearGeometry()
    ask = gearbox.library.test_gear_of
    ask.restype = _bool
    return geometry if ask(gearbox.handle, wheel, ctypes.byref(geometry)) else None


def mesh_of(gearbox: Gearbox, mesh: int) -> GearMesh | None:
    """Geometry of a mesh of a gearbox; None if it is not one of two real gears."""
    geometry = GearMesh()
    ask = gearbox.library.test_mesh_of
    ask.restype = _bool
    return geometry if ask(gearbox.handle, mesh, ctypes.byref(geometry)) else None
