"""What must hold of rigid contacts: they stay closed."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import (
    DEPTH_BOUND,
    base_radii,
    depth_scale,
    of_meshes,
    rigid_meshes,
)
from evolvent.physics.invariant import DEPTH, invariant
from evolvent.physics.wheel_torques import rotor_inertia


@invariant("rigid gap", "kappa = 0", DEPTH, 2 * DEPTH_BOUND, 1.0)
def rigid_gap(history: xr.Dataset) -> xr.DataArray:
    """Gap of closed rigid contacts over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, section 7.3.
    """
    rigid, closed = rigid_meshes(history)
    gap = require(rigid, "gap") / depth_scale(rigid)
    return gap.where(closed, 0.0).transpose("time", "mesh")


@invariant("rigid gap rate", "kappa' = 0", "vibration of that depth", 1e-10, 1.0)
def rigid_gap_rate(history: xr.Dataset) -> xr.DataArray:
    """Rate of the gap of closed rigid contacts over that of a vibration, dims (time, mesh).

    The scale is the depth times the natural frequency of a contact of stiffness F_0/h_0 between the
    two wheels.
    """
    rigid, closed = rigid_meshes(history)
    radii = base_radii(rigid)
    inertias = of_meshes(rigid, rotor_inertia(rigid))
    mobility = sum(r**2 / inertia for r, inertia in zip(radii, inertias, strict=True))
    force, depth = require(rigid, "reference_force"), require(rigid, "reference_penetration")
    frequency = np.sqrt(force / depth * mobility)
    rate = require(rigid, "gap_rate") / (depth_scale(rigid) * frequency)
    return rate.where(closed, 0.0).transpose("time", "mesh")
