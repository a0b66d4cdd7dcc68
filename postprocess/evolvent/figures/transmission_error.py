"""Transmission errors of several runs together."""

from __future__ import annotations

from collections.abc import Sequence

import xarray as xr
from matplotlib.figure import Figure

from evolvent.figures.over_time import Curve, Panel, figure_over_time, of_mesh, panel_title
from evolvent.history import require
from evolvent.told_extremes import peaks


def figure_transmission_error(
    histories: Sequence[xr.Dataset], labels: Sequence[str], events: xr.Dataset | None = None
) -> Figure:
    """Draw the transmission error Delta of several runs together, one panel a mesh.

    Parameters
    ----------
    histories : with transmission_error [m], dims (time, mesh), and the same number of meshes.
    labels : one a history.
    events : of one of them; marked if given.

    Source: Kosenko & Gusev 2011, (19) and Figure 4.
    """
    panels = [
        Panel(
            r"transmission error $\Delta$",
            [
                Curve(
                    label,
                    require(history, "transmission_error").isel(mesh=mesh),
                    peaks=peaks(history, "transmission_error", mesh),
                )
                for history, label in zip(histories, labels, strict=True)
            ],
            panel_title(histories[0], mesh),
            of_mesh(events, mesh),
        )
        for mesh in range(histories[0].sizes["mesh"])
    ]
    return figure_over_time(panels)
