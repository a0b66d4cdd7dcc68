"""Normal forces of all meshes."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from evolvent.figures.over_time import Curve, Panel, figure_over_time, name_of
from evolvent.history import require
from evolvent.told_extremes import peaks


def figure_normal_force(history: xr.Dataset, events: xr.Dataset | None = None) -> Figure:
    """Draw the normal force F_n [N] of every mesh over time, dims (time, mesh)."""
    force = require(history, "normal_force")
    curves = [
        Curve(
            name_of(history, "mesh", m),
            force.isel(mesh=m),
            peaks=peaks(history, "normal_force", m),
        )
        for m in range(force.mesh.size)
    ]
    return figure_over_time([Panel("normal force $F_n$", curves, events=events)])
