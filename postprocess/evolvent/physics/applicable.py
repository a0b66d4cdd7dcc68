"""To which meshes of a history an invariant applies, when, and the depth that measures them."""

from __future__ import annotations

import numpy as np
import xarray as xr

from evolvent.history import require

CLOSED_FORM = 0  # value of `tracking`
LOADED = 1  # value of `contact_mode`: the flanks press on each other
APART = 3  # value of `contact_mode`: the flanks are too far apart to track points on them
DEPTH_BOUND = 1e-10  # least bound of what is measured by the depth
ROUNDING = 4 * float(np.finfo(float).eps)  # of a sum of lengths


class NotApplicableError(Exception):
    """An invariant says nothing about this history; the message is the reason."""


def is_tracked(history: xr.Dataset) -> xr.DataArray:
    """Tell when contact points are tracked, dims (time, mesh)."""
    apart = require(history, "contact_mode") == APART
    return (~apart & (require(history, "tracking") != CLOSED_FORM)).transpose("time", "mesh")


def tracked_meshes(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes whose contact points are tracked, and tell when, dims (time, mesh)."""
    if not (require(history, "tracking") != CLOSED_FORM).any():
        raise NotApplicableError("closed form: no contact points are tracked")
    when = is_tracked(history)
    ever = when.any("time").values
    if not ever.any():
        raise NotApplicableError("the flanks are too far apart to track points on them")
    return history.isel(mesh=ever), when.isel(mesh=ever)


def pressed_meshes(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes that ever touch, and give the depth that measures them [m], dim (mesh)."""
    pressed = require(history, "penetration") > 0.0
    loaded = require(history, "contact_mode") == LOADED
    touched = (pressed | (loaded & is_rigid(history))).any("time").values
    if not touched.any():
        raise NotApplicableError("the teeth never touch")
    kept = history.isel(mesh=touched)
    return kept, depth_scale(kept)


def depth_scale(history: xr.Dataset) -> xr.DataArray:
    """Depth by which lengths in a mesh are measured [m], dim (mesh).

    The largest penetration, or the reference one where the teeth hardly touch or are rigid: the
    unit of the integrator's errors. It is at least so large that the rounding of the lengths of
    which a gap is the sum stays within the bound.
    """
    depth = require(history, "penetration").max("time")
    reference = require(history, "reference_penetration")
    arcs = require(history, "base_radius") * abs(require(history, "angle_deviation")).max("time")
    moved = abs(require(history, "centre_displacement")).max("time").sum("axis")
    driving, driven = of_meshes(history, (arcs + moved).transpose("wheel"))
    least = ROUNDING * (driving + driven).values / DEPTH_BOUND
    return depth.copy(data=np.max([depth.values, reference.values, least], axis=0))


def is_rigid(history: xr.Dataset) -> xr.DataArray:
    """Tell which meshes have rigid contact, dim (mesh)."""
    return require(history, "rigid_contact") == 1


def rigid_meshes(history: xr.Dataset) -> tuple[xr.Dataset, xr.DataArray]:
    """Keep the meshes with rigid contact, and tell when they are closed, dims (time, mesh)."""
    which = is_rigid(history).values
    if not which.any():
        raise NotApplicableError("no contact is rigid")
    rigid = history.isel(mesh=which)
    closed = require(rigid, "contact_mode") == LOADED
    if not closed.any():
        raise NotApplicableError("no rigid contact is ever closed")
    return rigid, closed


def base_radii(history: xr.Dataset) -> tuple[xr.DataArray, xr.DataArray]:
    """Base radii of the driving and the driven wheel of each mesh [m], dims (mesh)."""
    return of_meshes(history, require(history, "base_radius"))


def of_meshes(history: xr.Dataset, constant: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Values (wheel) of the driving and of the driven wheel of each mesh, dims (mesh)."""
    values = constant.values
    driving, driven = (
        xr.DataArray(values[require(history, f"{side}_wheel").values.astype(int)], dims="mesh")
        for side in ("driving", "driven")
    )
    return driving, driven
