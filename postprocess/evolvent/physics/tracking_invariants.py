"""Invariants of the contact points: they lie on both flanks and on the line of action."""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values
from evolvent.physics.applicable import (
    DEPTH_BOUND,
    base_radii,
    depth_scale,
    is_tracked,
    pressed_meshes,
    tracked_meshes,
)
from evolvent.physics.invariant import DEPTH, Deviation, invariant, of_some


@invariant("gradient ratio", "lambda = -r_bB/r_bA", "itself", 1e-12, 1e-3)
def gradient_ratio(run: Recording) -> Deviation:
    """Compute lambda over its constant value -r_bB/r_bA, minus 1, dims (time, mesh).

    Source: Kosenko & Gusev 2011, Assertion 2.
    """
    tracked = tracked_meshes(run)
    driving, driven = base_radii(run)

    def deviation(part: Part) -> Values:
        ratio = part["gradient_ratio"] * driving / driven + 1.0
        return np.where(is_tracked(part), ratio, 0.0)[:, tracked]

    return Deviation(("time", "mesh"), deviation, of_some(run, "mesh", tracked))


@invariant(
    "transmission error", "Delta = h + e + R (inv alpha - inv alpha_0)", DEPTH, DEPTH_BOUND, 1.0
)
def transmission_error_identity(run: Recording) -> Deviation:
    """Compute Delta - h - e - R (inv alpha - inv alpha_0) over the depth, dims (time, mesh).

    Source: Kosenko & Gusev 2011, (19), generalised to moving axes.
    """
    pressed = pressed_meshes(run)
    depth = depth_scale(run)

    def deviation(part: Part) -> Values:
        lag = part["transmission_error"] + part["gap"] - part["flank_deviation"]
        return np.asarray((lag - part["separation_curvature"])[:, pressed] / depth[pressed])

    return Deviation(("time", "mesh"), deviation, of_some(run, "mesh", pressed))


@invariant("points on flanks", "r_b g(r_P) = 0", DEPTH, DEPTH_BOUND, 1.0)
def distance_from_flanks(run: Recording) -> Deviation:
    """Distance of the tracked points from their flanks, r_b g, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, (1).
    """
    return _of_both_wheels(run, "tracking_residual")


@invariant("points on line of action", "(r_P - K_A).t = 0", DEPTH, DEPTH_BOUND, 1.0)
def distance_from_line_of_action(run: Recording) -> Deviation:
    """Distance of the tracked points from the line of action, (r_P - K_A).t, over the depth.

    Dims (wheel_of_mesh, time, mesh).   Source: Kosenko & Gusev 2011, Assertion 1.
    """
    return _of_both_wheels(run, "line_distance")


def _of_both_wheels(run: Recording, name: str) -> Deviation:
    pressed = pressed_meshes(run, tracked_meshes(run))
    depth = depth_scale(run)
    sides = ["driving", "driven"]

    def deviation(part: Part) -> Values:
        both = np.stack([part[f"{name}_{side}"] for side in sides])
        return np.where(is_tracked(part), both / depth, 0.0)[:, :, pressed]

    names = {"wheel_of_mesh": sides, **of_some(run, "mesh", pressed)}
    return Deviation(("wheel_of_mesh", "time", "mesh"), deviation, names)
