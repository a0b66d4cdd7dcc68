"""Invariants of rigid contacts: closed contacts have no gap."""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values
from evolvent.physics.applicable import (
    DEPTH_BOUND,
    LOADED,
    base_radii,
    depth_scale,
    of_meshes,
    rigid_meshes,
)
from evolvent.physics.invariant import DEPTH, Deviation, invariant, of_some
from evolvent.physics.wheel_torques import rotor_inertia


@invariant("rigid gap", "kappa = 0", DEPTH, 2 * DEPTH_BOUND, 1.0)
def rigid_gap(run: Recording) -> Deviation:
    """Gap of closed rigid contacts over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, section 7.3.
    """
    return _while_closed(run, "gap", rigid_meshes(run), depth_scale(run))


@invariant("rigid gap rate", "kappa' = 0", "vibration of that depth", 1e-10, 1.0)
def rigid_gap_rate(run: Recording) -> Deviation:
    """Rate of the gap of closed rigid contacts over that of a vibration, dims (time, mesh).

    The scale is the depth times the natural frequency of a contact of stiffness F_0/h_0 between the
    two wheels.
    """
    rigid = rigid_meshes(run)
    inertias = of_meshes(run, rotor_inertia(run))
    with np.errstate(invalid="ignore", divide="ignore"):  # of meshes with other contacts
        mobility = sum(r**2 / j for r, j in zip(base_radii(run), inertias, strict=True))
        frequency = np.sqrt(run["reference_force"] / run["reference_penetration"] * mobility)
    return _while_closed(run, "gap_rate", rigid, depth_scale(run) * frequency)


def _while_closed(run: Recording, name: str, rigid: Values, scale: Values) -> Deviation:
    def deviation(part: Part) -> Values:
        closed = part["contact_mode"][:, rigid] == LOADED
        return np.where(closed, part[name][:, rigid] / scale[rigid], 0.0)

    return Deviation(("time", "mesh"), deviation, of_some(run, "mesh", rigid))
