"""Motions over a parameter that went up and down, with their jumps."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import LINES, STYLE, legend
from evolvent.units import axis_label, engineering

SHOWN = {
    "transmission_error_standard_deviation": "deviation of the\ntransmission error",
    "dynamic_factor": "dynamic factor",
}
NOT_PERIODIC: dict[str, Any] = {"linestyle": "none", "marker": "o", "markerfacecolor": "none"}
MARK: dict[str, Any] = {"linewidth": 0.8, "alpha": 0.8}


def draw_response(response: xr.Dataset) -> Figure:
    """Draw numbers of each mesh, and the period of the motion, over the parameter.

    Motions that do not repeat are open circles; jumps are lines at their place, in the colour of
    their direction.

    Parameters
    ----------
    response : as `evolvent respond` writes it.
    """
    meshes = [str(name) for name in response["mesh"].values]
    shown = [(name, mesh) for mesh in range(len(meshes)) for name in SHOWN]
    scale, unit = engineering(response["parameter"].values, response["parameter"].attrs["units"])
    x = response["parameter"].values * scale
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 1.5 + 2.1 * (len(shown) + 0.7)), layout="constrained")
        ratios = [1.0] * len(shown) + [0.7]
        panels = figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[
            :, 0
        ]
        for panel, (name, mesh) in zip(panels[:-1], shown, strict=True):
            values = response[name].isel(mesh=mesh)
            factor, of = engineering(values.values, str(values.attrs["units"]))
            _draw_directions(panel, response, x, values.values * factor)
            text = SHOWN[name] if len(meshes) == 1 else f"{SHOWN[name]}, {meshes[mesh]}"
            panel.set_ylabel(axis_label(text, of))
            panel.set_ylim(bottom=0.0)
        period = np.where(response["period"].values < 0, np.nan, response["period"].values)
        _draw_directions(panels[-1], response, x, period)
        panels[-1].set_ylabel("period\n[common periods]")
        panels[-1].set_ylim(-0.5, max(2.0, np.nanmax(period, initial=0.0)) + 0.5)
        panels[-1].set_xlabel(axis_label(str(response.attrs["parameter"]), unit))
        panels[-1].set_xlim(x[0], x[-1])  # the first value is on the left, whatever its sign
        for panel in panels:
            _mark_jumps(panel, response, scale)
        handles, labels = panels[0].get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
    return figure


def _draw_directions(panel: Axes, response: xr.Dataset, x: np.ndarray, values: np.ndarray) -> None:
    """Draw a line for each direction: values (direction, parameter)."""
    wild = response["period"].values == 0
    for style, name, line, is_wild in zip(
        LINES, response["direction"].values, values, wild, strict=False
    ):
        panel.plot(x, line, label=str(name), **style)
        if is_wild.any():
            color = style["color"]
            label = f"{name}, not periodic"
            panel.plot(
                x[is_wild], line[is_wild], color=color, label=label, markersize=4, **NOT_PERIODIC
            )


def _mark_jumps(panel: Axes, response: xr.Dataset, scale: float) -> None:
    """Draw a line where a motion jumps, in the colour of its direction."""
    middle = (response["jump_before"].values + response["jump_after"].values) / 2 * scale
    for place, direction in zip(middle, response["jump_direction"].values, strict=True):
        style = LINES[int(direction)]
        panel.axvline(place, color=style["color"], linestyle=style["linestyle"], **MARK)
