"""What must balance: energies of the gearbox, torques on each wheel."""

from __future__ import annotations

import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import NotApplicableError
from evolvent.physics.invariant import invariant
from evolvent.physics.wheel_torques import contact_torque, largest_shaft_torque, shaft_torque

ENERGIES = ("kinetic_energy", "potential_energy", "dissipated_energy", "load_work")


@invariant(
    "energy balance", "T + V + dissipated - work of loads = constant", "energy put in", 1e-10, 10.0
)
def energy_balance(history: xr.Dataset) -> xr.DataArray:
    """Energy that appeared or got lost since the start over the energy put in, dim (time).

    T + V + dissipated - work of the loads is constant. What was put in is the gross work of the
    loads (the positive power on each wheel, integrated over the outputs) and the energy at the
    start; or, where outputs are few or gravity or a moving housing puts in more, the largest of
    these energies; and at least F_0 h_0, the work of the reference forces.
    """
    stored = require(history, "kinetic_energy") + require(history, "potential_energy")
    balance = stored + require(history, "dissipated_energy") - require(history, "load_work")
    power = require(history, "load_torque") * require(history, "angular_velocity")
    gross = float(power.clip(min=0.0).sum("wheel").integrate("time"))
    largest = [float(abs(history[name]).max()) for name in ENERGIES]
    least = float((require(history, "reference_force") * history["reference_penetration"]).sum())
    scale = max(gross + abs(float(stored[0])), *largest, least)
    return (balance - balance[0]) / scale


@invariant(
    "torque balance",
    "J omega' = load + sigma (F_n r_b + F_t l) + shafts",
    "largest contact or shaft torque",
    1e-6,
)
def torque_balance(history: xr.Dataset) -> xr.DataArray:
    """J omega' - load - contact - shaft torques over the wheel's largest contact or shaft torque.

    Dims (time, wheel). With friction, on approach and recess alike; a wheel that nothing turns but
    its loads is left out. A housing that turns adds its acceleration about the axles.
    """
    contact, shaft = contact_torque(history), shaft_torque(history)
    acceleration = require(history, "angular_acceleration")
    if "housing_angular_acceleration" in history:
        of_housing = history["housing_angular_acceleration"].sel(space="z", drop=True)
        acceleration = acceleration + of_housing
    inertia_torque = require(history, "inertia") * acceleration
    of_contacts = abs(contact).max("time")
    of_shafts = largest_shaft_torque(history)
    largest = of_contacts.where(of_contacts > of_shafts, of_shafts)
    touched = largest.values > 0.0
    if not touched.any():
        raise NotApplicableError("the teeth never touch")
    deviation = inertia_torque - require(history, "load_torque") - contact - shaft
    return (deviation / largest).isel(wheel=touched).transpose("time", "wheel")
