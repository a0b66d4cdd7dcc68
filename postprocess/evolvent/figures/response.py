"""Response over a parameter swept up and down, with its jumps."""

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
OPEN: dict[str, Any] = {"linestyle": "none", "markerfacecolor": "none"}
# by the values of `period`
UNFINISHED: dict[int, tuple[str, dict[str, Any]]] = {
    0: ("not periodic", {"marker": "o", **OPEN}),
    -2: ("still settling", {"marker": "v", **OPEN}),
}
MARK: dict[str, Any] = {"linewidth": 0.8, "alpha": 0.8}


def draw_response(response: xr.Dataset) -> Figure:
    """Draw results of each mesh, and the period of the motion, over the parameter.

    Non-periodic motions are open circles, motions not yet settled open triangles. Jumps are
    vertical lines in the colour of their direction.

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
        period = response["period"].values
        period = np.where(period == -2, 0, np.where(period < 0, np.nan, period))
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
    for style, name, line, period in zip(
        LINES, response["direction"].values, values, response["period"].values, strict=False
    ):
        panel.plot(x, line, label=str(name), **style)
        for code, (text, mark) in UNFINISHED.items():
            at = period == code
            if at.any():
                label = f"{name}, {text}"
                panel.plot(x[at], line[at], color=style["color"], label=label, markersize=4, **mark)


def _mark_jumps(panel: Axes, response: xr.Dataset, scale: float) -> None:
    """Mark the jumps by lines in the colour of their direction."""
    middle = (response["jump_before"].values + response["jump_after"].values) / 2 * scale
    for position, direction in zip(middle, response["jump_direction"].values, strict=True):
        style = LINES[int(direction)]
        panel.axvline(position, color=style["color"], linestyle=style["linestyle"], **MARK)
