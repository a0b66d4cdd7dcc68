"""Drawing of a mesh to scale: two wheels with their circles, the line of action, two flanks."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from evolvent.figures.style import BELOW, STYLE
from evolvent.physics.teeth import DrawnMesh, drawn_meshes

DRIVING_COLOR, DRIVEN_COLOR, ACTION_COLOR = "#10243e", "#b8530f", "#2b7bb0"
CIRCLES: dict[str, Any] = {"base": (0, (6, 2)), "pitch": (0, (6, 2, 1.2, 2)), "tip": "-"}
LINE_OF_ACTION, PATH_OF_CONTACT, FLANK = 1.0, 3.0, 2.2  # line widths [pt]
# Position of the drawn contact, as a fraction of the path from a to b: clear of the labels.
DRAWN_CONTACT = 0.3


def figure_mesh_scheme(history: xr.Dataset, mesh: int = 0) -> Figure:
    """Draw a mesh to scale: the two wheels, and an enlarged view of the zone of contact.

    Parameters
    ----------
    history : with the static variables of geometry.
    mesh : index of the mesh, from 0.

    Source: Kosenko & Gusev 2011, Figure 1.
    """
    geometry = drawn_meshes(history)[mesh]
    names = [str(history["wheel"].values[wheel]) for wheel in geometry.wheels]
    with rc_context(STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(10.5, 6.3), layout="constrained")
        whole, zone = figure.subplots(1, 2, width_ratios=[1.5, 1.0])
        for axis in (whole, zone):
            _draw(axis, geometry)
            axis.set_aspect("equal")
            axis.set_xlabel("x [m]")
            axis.set_ylabel("y [m]")
        _frame_whole(whole, geometry)
        _frame_zone(zone, geometry)
        _label_wheels(whole, geometry, names)
        _label_points(zone, geometry)
        low, high = zone.get_xlim(), zone.get_ylim()
        frame = Rectangle((low[0], high[0]), low[1] - low[0], high[1] - high[0])
        frame.set(fill=False, edgecolor="#666666", linewidth=0.9)
        whole.add_patch(frame)
        whole.set_title("to scale", loc="left", fontsize=12)
        zone.set_title("the frame, enlarged", loc="left", fontsize=12)
        figure.legend(handles=_legend_entries(), loc=BELOW, ncols=3)
    return figure


def _draw(axis: Axes, geometry: DrawnMesh) -> None:
    turn = np.exp(1j * np.linspace(0.0, 2 * np.pi, 1441))
    for wheel, color in enumerate((DRIVING_COLOR, DRIVEN_COLOR)):
        radii = (geometry.base_radii, geometry.pitch_radii, geometry.tip_radii)
        for style, radius in zip(CIRCLES.values(), radii, strict=True):
            circle = geometry.centres[wheel] + radius[wheel] * turn
            axis.plot(circle.real, circle.imag, color=color, linestyle=style, linewidth=0.9)
    points = geometry.points
    ends = np.array([points["K_A"], points["K_B"]])
    axis.plot(ends.real, ends.imag, color=ACTION_COLOR, linewidth=LINE_OF_ACTION)
    path = np.array([points["a"], points["b"]])
    axis.plot(path.real, path.imag, color=ACTION_COLOR, linewidth=PATH_OF_CONTACT)
    contact = geometry.path[0] + DRAWN_CONTACT * (geometry.path[1] - geometry.path[0])
    for wheel, color in enumerate((DRIVING_COLOR, DRIVEN_COLOR)):
        flank = geometry.flank(wheel, contact)
        axis.plot(flank.real, flank.imag, color=color, linewidth=FLANK)


def _legend_entries() -> list[Line2D]:
    """Legend of the line types; colours and names in the wheels identify the wheels."""
    grey: dict[str, Any] = {"color": "#444444"}
    entries = [
        Line2D([], [], linestyle=style, linewidth=0.9, label=f"{kind} circle", **grey)
        for kind, style in CIRCLES.items()
    ]
    action: dict[str, Any] = {"color": ACTION_COLOR}
    return [
        *entries,
        Line2D([], [], linewidth=LINE_OF_ACTION, label=r"line of action $K_A K_B$", **action),
        Line2D([], [], linewidth=PATH_OF_CONTACT, label="path of contact $ab$", **action),
        Line2D([], [], linewidth=FLANK, label="flanks in contact", **grey),
    ]


def _frame_whole(axis: Axes, geometry: DrawnMesh) -> None:
    centres = np.array(geometry.centres)
    reach = 1.04 * abs(np.array(geometry.tip_radii))
    axis.set_xlim((centres.real - reach).min(), (centres.real + reach).max())
    axis.set_ylim((centres.imag - reach).min(), (centres.imag + reach).max())


def _frame_zone(axis: Axes, geometry: DrawnMesh) -> None:
    ends = np.array([geometry.points["K_A"], geometry.points["K_B"]])
    margin = 0.25 * abs(ends[1] - ends[0])
    axis.set_xlim(ends.real.min() - margin, ends.real.max() + margin)
    axis.set_ylim(ends.imag.min() - margin / 2, ends.imag.max() + margin / 2)


def _label_wheels(axis: Axes, geometry: DrawnMesh, names: list[str]) -> None:
    colors = (DRIVING_COLOR, DRIVEN_COLOR)
    for centre, name, color in zip(geometry.centres, names, colors, strict=True):
        axis.plot(centre.real, centre.imag, "+", color=color, markersize=10)
        axis.annotate(
            name,
            (centre.real, centre.imag),
            xytext=(0, 9),
            textcoords="offset points",
            ha="center",
            color=color,
        )


def _label_points(axis: Axes, geometry: DrawnMesh) -> None:
    """Label the points beside the line of action; neighbours on opposite sides."""
    sides = {"K_A": -1, "a": 1, "P": 1, "b": -1, "K_B": 1}
    names = {"K_A": "$K_A$", "K_B": "$K_B$", "a": "$a$", "b": "$b$", "P": "pitch point"}
    start, _, _ = geometry.line()
    across = (start - geometry.centres[0]) / geometry.base_radii[0]
    for key, point in geometry.points.items():
        axis.plot(point.real, point.imag, "o", color=ACTION_COLOR, markersize=5, zorder=5)
        offset = 14 * sides[key] * across
        axis.annotate(
            names[key],
            (point.real, point.imag),
            xytext=(offset.real, offset.imag),
            textcoords="offset points",
            ha="left" if offset.real > 0 else "right",
            va="center",
            bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none"},
            zorder=6,
        )
