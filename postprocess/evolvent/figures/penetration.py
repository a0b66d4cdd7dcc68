"""Transmission error and penetration of each mesh."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from evolvent.figures.over_time import Curve, Panel, figure_over_time, of_mesh, panel_title
from evolvent.history import require
from evolvent.told_extremes import peaks


def figure_penetration(history: xr.Dataset, events: xr.Dataset | None = None) -> Figure:
    """Draw transmission error Delta and penetration h over time, one panel a mesh.

    Parameters
    ----------
    history : with transmission_error and penetration [m], dims (time, mesh).
    events : as from `open_events`; marked if given.

    Source: Kosenko & Gusev 2011, Figure 3.
    """
    panels = [
        Panel(
            "length along the line of action",
            [
                Curve(
                    f"{label} ${symbol}$",
                    require(history, name).isel(mesh=mesh),
                    peaks=peaks(history, name, mesh),
                )
                for name, label, symbol in (
                    ("transmission_error", "transmission error", r"\Delta"),
                    ("penetration", "penetration", "h"),
                )
            ],
            panel_title(history, mesh),
            of_mesh(events, mesh),
        )
        for mesh in range(history.sizes["mesh"])
    ]
    return figure_over_time(panels)
