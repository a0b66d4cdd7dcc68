"""Loaded tooth pairs at an output: contact points, forces and sliding velocities."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from evolvent.history import require
from evolvent.physics.teeth import DrawnMesh

Deviation = Callable[[float], float]  # of the driving flank at a radius of curvature [m]


@dataclass(frozen=True)
class Touch:
    """A loaded tooth pair."""

    point: complex  # contact point, housing frame [m]
    force: complex  # on the driven wheel, with friction [N]; opposite on the driving one
    sliding: complex  # velocity of the driving flank relative to the driven one [m/s]


def touching(
    history: xr.Dataset, mesh: DrawnMesh, number: int, row: int, deviation: Deviation | None = None
) -> list[Touch]:
    """Find the loaded tooth pairs of a mesh.

    Parameters
    ----------
    history : with pair_position [m], pair_normal_force and pair_friction_force [N];
        pair_sliding_velocity [m/s], without which the sliding is 0.
    mesh, number : the mesh and its index in the history.
    row : output.
    deviation : profile deviation that shifts the points; the perfect flanks if None.

    Source: docs/theory/theory.md, forces: -F_n e + F_t t on the driving wheel, v_t along t.
    """
    names = [str(name) for name in history["pair"].values]
    normal, friction, position = (
        require(history, f"pair_{name}").values[row, number]
        for name in ("normal_force", "friction_force", "position")
    )
    sliding = np.zeros_like(normal)
    if "pair_sliding_velocity" in history:
        sliding = np.nan_to_num(history["pair_sliding_velocity"].values[row, number])
    shifts = mesh.shifts(history, row)
    found = []
    for index in np.flatnonzero(normal > 0):
        start, along, _ = mesh.line(names[index].startswith("coast"), shifts)
        across = (start - mesh.centres[0] - shifts[0]) / mesh.base_radii[0]
        rho = float(position[index])
        if deviation is not None:
            rho -= deviation(rho)
        force = complex(normal[index] * along - friction[index] * across)
        found.append(Touch(complex(start + rho * along), force, complex(sliding[index] * across)))
    return found
