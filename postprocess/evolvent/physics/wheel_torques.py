"""What acts on the wheels of a history: torques of contacts and shafts, inertia of rotors."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import base_radii


def contact_torque(history: xr.Dataset) -> xr.DataArray:
    """Torque of all contacts on each wheel about its axle [N m], dims (time, wheel).

    sigma (F_n r_b + F_t l), summed over the meshes of the wheel; counterclockwise positive. Where
    several tooth pairs share the load, what the model says of their torques.
    """
    several = history.sizes.get("pair", 1) > 1
    force, friction = require(history, "normal_force"), require(history, "friction_force")
    total = xr.zeros_like(require(history, "load_torque"))
    for side, base_radius in zip(("driving", "driven"), base_radii(history), strict=True):
        arm = require(history, f"friction_arm_{side}")
        torque = (force * base_radius + friction * arm) * require(history, "flank")
        if several:
            torque = require(history, f"mesh_torque_{side}")
        _add_to(total, require(history, f"{side}_wheel"), torque)
    return total.assign_attrs(units="N m", long_name="torque of the contacts")


def shaft_torque(history: xr.Dataset) -> xr.DataArray:
    """Torque of all shafts on each wheel [N m], dims (time, wheel); 0 without shafts."""
    total = xr.zeros_like(require(history, "load_torque"))
    if "shaft" in history.sizes:
        torque = require(history, "shaft_torque")
        _add_to(total, require(history, "shaft_wheel_first"), -torque)
        _add_to(total, require(history, "shaft_wheel_second"), torque)
    return total.assign_attrs(units="N m", long_name="torque of the shafts")


def _add_to(total: xr.DataArray, wheels: xr.DataArray, torque: xr.DataArray) -> None:
    """Add torques to those of their wheels, of which one may have several."""
    of_wheels = total.transpose("wheel", "time").values  # a view
    np.add.at(of_wheels, wheels.values.astype(int), torque.transpose(..., "time").values)


def largest_shaft_torque(history: xr.Dataset) -> xr.DataArray:
    """Largest torque of any shaft on each wheel [N m], dim (wheel); their sum may be rounding."""
    largest = xr.zeros_like(require(history, "inertia"))
    for shaft in range(history.sizes.get("shaft", 0)):
        torque = float(abs(require(history, "shaft_torque").isel(shaft=shaft)).max())
        for end in ("first", "second"):
            wheel = {"wheel": int(require(history, f"shaft_wheel_{end}")[shaft])}
            largest[wheel] = max(torque, float(largest[wheel]))
    return largest


def rotor_inertia(history: xr.Dataset) -> xr.DataArray:
    """Moment of inertia of each wheel and all that rigid shafts join to it [kg m2], dim (wheel)."""
    inertia = require(history, "inertia")
    rotor = np.arange(inertia.size)
    for shaft in range(history.sizes.get("shaft", 0)):
        if int(require(history, "rigid_shaft")[shaft]) == 1:
            first = int(require(history, "shaft_wheel_first")[shaft])
            second = int(require(history, "shaft_wheel_second")[shaft])
            rotor[rotor == rotor[second]] = rotor[first]
    totals = np.bincount(rotor, weights=inertia.values, minlength=inertia.size)
    return inertia.copy(data=totals[rotor])
