"""Balance invariants: energies of the gearbox, torques on each wheel."""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values, integral, largest, largest_size
from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import Deviation, invariant, of_some
from evolvent.physics.wheel_torques import (
    contact_torque,
    largest_mesh_torque,
    largest_shaft_torque,
    rotor_inertia,
    shaft_torque,
)

DIGITS = 1e-9  # of a torque: with the bound of 1e-6, some digits above the rounding of a sum of two
ENERGIES = ("kinetic_energy", "potential_energy", "dissipated_energy", "load_work")


@invariant(
    "energy balance", "T + V + dissipated - work of loads = constant", "energy put in", 1e-10, 10.0
)
def energy_balance(run: Recording) -> Deviation:
    """Energy error since the start over the energy input, dim (time).

    T + V + dissipated - work of the loads is constant. The energy input is the gross work of the
    loads (the positive power on each wheel, integrated over the outputs) plus the energy at the
    start. With few outputs, with gravity or with a moving housing, the largest of these energies
    applies if it is larger. The lower limit is F_0 h_0, the work of the reference forces.
    """

    def stored(part: Part) -> Values:
        return np.asarray(part["kinetic_energy"] + part["potential_energy"])

    def balance(part: Part) -> Values:
        return np.asarray(stored(part) + part["dissipated_energy"] - part["load_work"])

    def power(part: Part) -> Values:
        gained = np.clip(part["load_torque"] * part["angular_velocity"], 0.0, None)
        return np.asarray(np.nansum(gained, axis=1))

    start = Part(run, 0, 1)
    gross = float(integral(run, power))
    tops = [float(largest_size(run, name)) for name in ENERGIES]
    least = float(np.nansum(run["reference_force"] * run["reference_penetration"]))
    scale = max(gross + abs(float(stored(start)[0])), *tops, least)
    first = float(balance(start)[0])
    return Deviation(("time",), lambda part: (balance(part) - first) / scale)


@invariant(
    "torque balance",
    "J omega' = load + sigma (F_n r_b + F_t l) + shafts",
    "largest torque of a mesh or shaft",
    1e-6,
)
def torque_balance(run: Recording) -> Deviation:
    """Compute J omega' - load - contact - shaft torques over the largest mesh or shaft torque.

    Dims (time, wheel). Valid with friction, on approach and recess alike. Wheels with no torque
    but that of their loads are omitted. A rotating housing adds its acceleration about the axes.
    The sum of two meshes, as of an idler, has their rounding errors. A wheel's acceleration is the
    reference wheel's plus its own deviation, so the largest of any wheel determines its rounding;
    a rigid shaft transmits this to all wheels that it joins.
    """
    of_meshes, of_shafts = largest_mesh_torque(run), largest_shaft_torque(run)
    scale = np.where(of_meshes > of_shafts, of_meshes, of_shafts)
    touched = scale > 0.0
    fastest = largest(run, lambda part: abs(part["angular_acceleration"])).max()
    scale = np.maximum(scale, DIGITS * rotor_inertia(run) * fastest)
    if not touched.any():
        raise NotApplicableError("the teeth never touch")

    def deviation(part: Part) -> Values:
        acceleration = part["angular_acceleration"]
        if "quaternion" in run.sizes:  # the housing moves
            along = run.labels("space").index("z")
            acceleration = acceleration + part["housing_angular_acceleration"][:, [along]]
        missing = run["inertia"] * acceleration - part["load_torque"]
        missing = missing - contact_torque(part) - shaft_torque(part)
        return np.asarray(missing[:, touched] / scale[touched])

    return Deviation(("time", "wheel"), deviation, of_some(run, "wheel", touched))
