"""What must hold of the contact points: they lie on both flanks and on the line of action."""

from __future__ import annotations

import xarray as xr

from evolvent.history import require
from evolvent.physics.applicable import DEPTH_BOUND, base_radii, pressed_meshes, tracked_meshes
from evolvent.physics.invariant import DEPTH, invariant


@invariant("gradient ratio", "lambda = -r_bB/r_bA", "itself", 1e-12, 1e-3)
def gradient_ratio(history: xr.Dataset) -> xr.DataArray:
    """lambda over its constant value -r_bB/r_bA, minus 1, dims (time, mesh).

    Source: Kosenko & Gusev 2011, Assertion 2.
    """
    tracked, when = tracked_meshes(history)
    driving, driven = base_radii(tracked)
    return (require(tracked, "gradient_ratio") * driving / driven + 1.0).where(when, 0.0)


@invariant(
    "transmission error", "Delta = h + e + R (inv alpha - inv alpha_0)", DEPTH, DEPTH_BOUND, 1.0
)
def transmission_error_identity(history: xr.Dataset) -> xr.DataArray:
    """Delta - h - e - R (inv alpha - inv alpha_0) over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, (19), generalised to axles that move.
    """
    pressed, depth = pressed_meshes(history)
    lag = require(pressed, "transmission_error") + require(pressed, "gap")
    lag = lag - require(pressed, "flank_deviation")
    return (lag - require(pressed, "separation_curvature")) / depth


@invariant("points on flanks", "r_b g(r_P) = 0", DEPTH, DEPTH_BOUND, 1.0)
def distance_from_flanks(history: xr.Dataset) -> xr.DataArray:
    """Distance of the tracked points from their flanks, r_b g, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, (1).
    """
    return _of_both_wheels(history, "tracking_residual")


@invariant("points on line of action", "(r_P - K_A).t = 0", DEPTH, DEPTH_BOUND, 1.0)
def distance_from_line_of_action(history: xr.Dataset) -> xr.DataArray:
    """Distance of the tracked points from the line of action, (r_P - K_A).t, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, Assertion 1.
    """
    return _of_both_wheels(history, "line_distance")


def _of_both_wheels(history: xr.Dataset, name: str) -> xr.DataArray:
    tracked, when = tracked_meshes(history)
    pressed, depth = pressed_meshes(tracked)
    sides = ["driving", "driven"]
    distances = [require(pressed, f"{name}_{side}") for side in sides]
    both = xr.concat(distances, dim=xr.DataArray(sides, dims="wheel_of_mesh", name="wheel_of_mesh"))
    relative = (both / depth).where(when.sel(mesh=depth["mesh"]), 0.0)
    return relative.transpose("wheel_of_mesh", "time", "mesh")
