"""Applicability of invariants to meshes and times, and the depth that scales them."""

from __future__ import annotations

import numpy as np

from evolvent.history.recording import Part, Recording, Values, ever, largest

CLOSED_FORM = 0  # value of `tracking`
LOADED = 1  # value of `contact_mode`: the flanks transmit a normal force
APART = 3  # value of `contact_mode`: the flanks are too far apart to track points on them
DEPTH_BOUND = 1e-10  # lower limit of bounds relative to the depth
ROUNDING = 4 * float(np.finfo(float).eps)  # of a sum of lengths


class NotApplicableError(Exception):
    """An invariant does not apply to this history; the message is the reason."""


def is_tracked(part: Part) -> Values:
    """Whether contact points are tracked, dims (time, mesh)."""
    return np.asarray((part["contact_mode"] != APART) & (part["tracking"] != CLOSED_FORM))


def tracked_meshes(run: Recording) -> Values:
    """Whether contact points of a mesh are tracked at any time, dim (mesh)."""
    if not (run["tracking"] != CLOSED_FORM).any():
        raise NotApplicableError("closed form: no contact points are tracked")
    found = ever(run, is_tracked)
    if not found.any():
        raise NotApplicableError("the flanks are too far apart to track points on them")
    return found


def pressed_meshes(run: Recording, among: Values | None = None) -> Values:
    """Whether a mesh is in contact at any time, dim (mesh).

    Parameters
    ----------
    among : mask of the meshes to consider; all if None.
    """
    touched = run.once(_touched)
    touched = touched if among is None else touched & among
    if not touched.any():
        raise NotApplicableError("the teeth never touch")
    return np.asarray(touched)


def _touched(run: Recording) -> Values:
    rigid = is_rigid(run)
    return ever(
        run,
        lambda part: (part["penetration"] > 0.0) | ((part["contact_mode"] == LOADED) & rigid),
    )


def depth_scale(run: Recording) -> Values:
    """Reference depth for lengths in a mesh [m], dim (mesh).

    The largest penetration, or the reference penetration if it is larger (teeth hardly touch or are
    rigid): the unit of the integrator's errors. Its lower limit bounds the rounding error of a gap,
    which is a sum of lengths.
    """
    return np.asarray(run.once(_depth_scale))


def _depth_scale(run: Recording) -> Values:
    depth = largest(run, lambda part: part["penetration"])
    arcs = abs(run["base_radius"]) * largest(run, lambda part: abs(part["angle_deviation"]))
    moved = np.nansum(largest(run, lambda part: abs(part["centre_displacement"])), axis=1)
    driving, driven = of_meshes(run, arcs + moved)
    least = ROUNDING * (driving + driven) / DEPTH_BOUND
    return np.asarray(np.max([depth, run["reference_penetration"], least], axis=0))


def is_rigid(run: Recording) -> Values:
    """Whether a mesh has rigid contact, dim (mesh)."""
    return np.asarray(run["rigid_contact"] == 1)


def rigid_meshes(run: Recording) -> Values:
    """Whether a mesh has rigid contact, dim (mesh); at least one must be closed at some time."""
    rigid = is_rigid(run)
    if not rigid.any():
        raise NotApplicableError("no contact is rigid")
    if not (ever(run, lambda part: part["contact_mode"] == LOADED) & rigid).any():
        raise NotApplicableError("no rigid contact is ever closed")
    return rigid


def base_radii(run: Recording) -> tuple[Values, Values]:
    """Base radii of the driving and the driven wheel of each mesh [m], dims (mesh)."""
    return of_meshes(run, run["base_radius"])


def of_meshes(run: Recording, constant: Values) -> tuple[Values, Values]:
    """Values (wheel) of the driving and of the driven wheel of each mesh, dims (mesh)."""
    driving, driven = (constant[run[f"{side}_wheel"].astype(int)] for side in ("driving", "driven"))
    return driving, driven
