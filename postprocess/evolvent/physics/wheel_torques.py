"""Torques of contacts and shafts on the wheels of a history, and inertia of rotors."""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values, largest
from evolvent.physics.applicable import base_radii

SIDES = ("driving", "driven")


def contact_torque(part: Part) -> Values:
    """Torque of all contacts on each wheel about its axis [N m], dims (time, wheel).

    sigma (F_n r_b + F_t l), summed over the meshes of the wheel; counterclockwise positive. If
    several tooth pairs share the load, the torques computed by the model are used.
    """
    total = np.zeros_like(part["load_torque"], dtype=float)
    for side, base_radius in zip(SIDES, base_radii(part.recording), strict=True):
        _add_to(total, part.recording[f"{side}_wheel"], _mesh_torque(part, side, base_radius))
    return total


def largest_mesh_torque(run: Recording) -> Values:
    """Largest torque of any mesh on each wheel [N m], dim (wheel); their sum may be rounding."""
    found = np.zeros_like(run["inertia"])
    for side, base_radius in zip(SIDES, base_radii(run), strict=True):

        def sizes(part: Part, side: str = side, base_radius: Values = base_radius) -> Values:
            return np.asarray(abs(_mesh_torque(part, side, base_radius)))

        np.fmax.at(found, run[f"{side}_wheel"].astype(int), largest(run, sizes))
    return found


def _mesh_torque(part: Part, side: str, base_radius: Values) -> Values:
    """Torque of each mesh on its wheel of that side [N m], dims (time, mesh)."""
    if part.recording.sizes.get("pair", 1) > 1:
        return part[f"mesh_torque_{side}"]
    force, friction = part["normal_force"], part["friction_force"]
    torque = (force * base_radius + friction * part[f"friction_arm_{side}"]) * part["flank"]
    return np.asarray(torque)


def shaft_torque(part: Part) -> Values:
    """Torque of all shafts on each wheel [N m], dims (time, wheel); 0 without shafts."""
    total = np.zeros_like(part["load_torque"], dtype=float)
    if "shaft" in part.recording.sizes:
        torque = part["shaft_torque"]
        _add_to(total, part["shaft_wheel_first"], -torque)
        _add_to(total, part["shaft_wheel_second"], torque)
    return total


def _add_to(total: Values, wheels: Values, torque: Values) -> None:
    """Add torques to those of their wheels; a wheel may occur several times."""
    np.add.at(total.T, wheels.astype(int), torque.T)


def largest_shaft_torque(run: Recording) -> Values:
    """Largest torque of any shaft on each wheel [N m], dim (wheel); their sum may be rounding."""
    found = np.zeros_like(run["inertia"])
    if run.sizes.get("shaft", 0):
        torques = largest(run, lambda part: abs(part["shaft_torque"]))
        for end in ("first", "second"):
            np.fmax.at(found, run[f"shaft_wheel_{end}"].astype(int), torques)
    return found


def rotor_inertia(run: Recording) -> Values:
    """Moment of inertia of each wheel and all that rigid shafts join to it [kg m2], dim (wheel)."""
    inertia = run["inertia"]
    rotor = np.arange(inertia.size)
    for shaft in range(run.sizes.get("shaft", 0)):
        if int(run["rigid_shaft"][shaft]) == 1:
            first = int(run["shaft_wheel_first"][shaft])
            second = int(run["shaft_wheel_second"][shaft])
            rotor[rotor == rotor[second]] = rotor[first]
    totals = np.bincount(rotor, weights=inertia, minlength=inertia.size)
    return np.asarray(totals[rotor])
