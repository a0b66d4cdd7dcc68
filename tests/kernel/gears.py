"""Gears defined by a basic rack in Python: a thin ctypes binding of the kernel.

Those of a gearbox by `tests/gearbox/geometry_calls.f90`, gears alone by
`tests/geometry/gear_calls.f90`.
"""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kernel.description import Block, described
from kernel.gearbox import Gearbox
from kernel.interface import fields
from kernel.kernel import OK, Floats, Integers, Kernel, Status, _error, _floats


class GearGeometry(ctypes.Structure):
    """A gear."""

    _fields_ = fields("gear_t")

    def fields(self) -> list[float]:
        """Values of all fields, without the padding bytes between them."""
        return [getattr(self, name) for name, _ in self._fields_]


class GearMesh(ctypes.Structure):
    """Two gears in mesh."""

    _fields_ = fields("gear_mesh_t")


def gear_description(module: float = 0.002, **given: Any) -> Block:
    """Describe a gear with a module; by default with the rack of ISO 53, profile A."""
    rack = {"rack_addendum": 1.0, "rack_dedendum": 1.25, "rack_root_radius": 0.38}
    of_rack = {key.removeprefix("rack_"): given.pop(key, value) for key, value in rack.items()}
    defaults = {"module": module, "pressure_angle": np.radians(20), "profile_shift": 0.0}
    return Block({**defaults, "thickness_allowance": 0.0, "rack": Block(of_rack), **given})


def gear(kernel: Kernel, teeth: int, module: float = 0.002, **given: Any) -> GearGeometry:
    """Geometry of a gear; raises KernelError if it is rejected."""
    geometry, status = GearGeometry(), Status()
    form = gear_description(module, **given)
    wheel = {"name": "w", "material": "m", "width": 1.0, "teeth": teeth, **form}
    with described(kernel.library, {"wheels": [wheel]}, status) as description:
        if description:
            kernel.library.test_gear_derive(description, geometry, status)
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
    """Geometry of two gears in mesh; raises KernelError if it is rejected."""
    mesh = GearMesh()
    distance = (centre_distance is not None, centre_distance or 0.0)
    gap = (backlash is not None, backlash or 0.0)
    kernel.checked("test_gear_mesh_derive", a, b, *distance, *gap, mesh)
    return mesh


def mesh_geometry(
    kernel: Kernel, a: GearGeometry, b: GearGeometry, centre_distance: float
) -> GearMesh:
    """Geometry of two gears at a centre distance, without a check that they can mesh."""
    mesh = GearMesh()
    kernel.library.test_gear_mesh_geometry(a, b, centre_distance, mesh)
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
    numbers = (centre_distance, working_pressure_angle, rho_tip)
    return float(kernel.library.test_tip_gap(a, mate, *numbers))


def tooth_thickness(
    kernel: Kernel, geometry: GearGeometry, radii: ArrayLike
) -> tuple[Floats, Integers]:
    """Tooth thickness at radii, and the codes."""
    (r,) = _floats(radii)
    thickness, codes = np.empty(len(r)), np.empty(len(r), np.int32)
    kernel.library.test_gear_tooth_thickness(geometry, len(r), r, thickness, codes)
    return thickness, codes


def involute_value(kernel: Kernel, angles: ArrayLike) -> Floats:
    """Return inv alpha of angles."""
    (alpha,) = _floats(angles)
    values = np.empty(len(alpha))
    kernel.library.test_involute_value(len(alpha), alpha, values)
    return values


def involute_inverse(kernel: Kernel, involutes: ArrayLike) -> Floats:
    """Return the angles with these involute functions."""
    (values,) = _floats(involutes)
    angles = np.empty(len(values))
    kernel.library.test_involute_inverse(len(values), values, angles)
    return angles


def gear_of(gearbox: Gearbox, wheel: int) -> GearGeometry | None:
    """Geometry of a wheel defined by a basic rack in a gearbox; None for other wheels."""
    geometry = GearGeometry()
    return geometry if gearbox.library.test_gear_of(gearbox.handle, wheel, geometry) else None


def mesh_of(gearbox: Gearbox, mesh: int) -> GearMesh | None:
    """Geometry of a mesh of a gearbox; None unless both gears are defined by a basic rack."""
    geometry = GearMesh()
    return geometry if gearbox.library.test_mesh_of(gearbox.handle, mesh, geometry) else None
