"""Branches of periodic orbits over a parameter, with stability and bifurcations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.response import SHOWN
from evolvent.figures.style import LINES, STYLE, legend
from evolvent.units import axis_label, engineering

PAIR, MESH = 1, 2
# by `orbit_kind` and `orbit_grazing` (None: any value); regular points have no mark
MARKS: dict[tuple[int, int | None], tuple[str, dict[str, Any]]] = {
    (1, None): ("fold", {"marker": "o", "markersize": 5}),
    (2, None): ("crossing", {"marker": "X", "markersize": 6}),
    (3, None): ("period doubling", {"marker": "D", "markersize": 5}),
    (4, None): ("Neimark-Sacker", {"marker": "^", "markersize": 6}),
    (5, PAIR): ("one tooth pair just touches", {"marker": "|", "markersize": 9}),
    (5, MESH): ("the mesh just parts", {"marker": "|", "markersize": 9, "markeredgewidth": 2}),
    (6, PAIR): (
        "fold where one tooth pair just touches",
        {"marker": "s", "markersize": 6, "markerfacecolor": "white"},
    ),
    (6, MESH): (
        "fold with grazing of the mesh",
        {"marker": "h", "markersize": 7, "markerfacecolor": "white"},
    ),
}
MARK_COLOR = "#8c1c3a"
UNSTABLE = (0, (3, 2))


def draw_orbits(orbits: xr.Dataset) -> Figure:
    """Draw results of each mesh over the parameter: stable orbits solid, unstable ones dashed.

    Orbits of one common period, of two and so on have their own colours. Longer periods have
    thinner lines, so that coincident lines remain visible; the bottom panel shows the ranges of
    each period. Folds and other special points are marked.

    Parameters
    ----------
    orbits : as `evolvent respond --method orbits` writes it.
    """
    meshes = [str(name) for name in orbits["mesh"].values]
    shown = [(name, mesh) for mesh in range(len(meshes)) for name in SHOWN]
    scale, unit = engineering(
        orbits["orbit_parameter"].values, orbits["orbit_parameter"].attrs["units"]
    )
    x = orbits["orbit_parameter"].values * scale
    with rc_context(STYLE):
        several = len(np.unique(orbits["orbit_period"].values)) > 1
        ratios = [1.0] * len(shown) + [0.45] * several
        figure = Figure(figsize=(7.5, 1.8 + 2.6 * sum(ratios)), layout="constrained")
        panels = figure.subplots(len(ratios), 1, sharex=True, squeeze=False, height_ratios=ratios)[
            :, 0
        ]
        for panel, (name, mesh) in zip(panels, shown, strict=False):
            values = orbits[name].isel(mesh=mesh)
            factor, of = engineering(values.values, str(values.attrs["units"]))
            _draw_branches(panel, orbits, x, values.values * factor)
            _draw_marks(panel, orbits, x, values.values * factor)
            text = SHOWN[name] if len(meshes) == 1 else f"{SHOWN[name]}, {meshes[mesh]}"
            panel.set_ylabel(axis_label(text, of))
            panel.set_ylim(bottom=0.0)
        if several:
            _draw_periods(panels[-1], orbits, x)
        panels[-1].set_xlabel(axis_label(str(orbits.attrs["parameter"]), unit))
        handles, labels = panels[0].get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
        if x.size > 0 and np.all(x <= 0):
            panels[-1].invert_xaxis()  # the faster speed is on the right
    return figure


def _draw_branches(panel: Axes, orbits: xr.Dataset, x: np.ndarray, y: np.ndarray) -> None:
    """Draw all branches, coloured by period."""
    periods = sorted({int(period) for period in orbits["orbit_period"].values})
    in_order = sorted(_pieces(orbits), key=lambda piece: (piece[1], not piece[2]))  # of the legend
    for piece, period, is_stable in in_order:
        color = LINES[periods.index(period) % len(LINES)]["color"]
        index = periods.index(period)
        text = f"period {period}, {'stable' if is_stable else 'unstable'}"
        panel.plot(x[piece], y[piece], color=color, label=text, zorder=2 + 0.1 * index,
                   linestyle="-" if is_stable else UNSTABLE,
                   linewidth=max(0.6, 1.7 - 0.3 * index))  # fmt: skip


def _draw_periods(panel: Axes, orbits: xr.Dataset, x: np.ndarray) -> None:
    """Draw the parameter ranges of the orbits of each period; stable ones are thick lines."""
    periods = sorted({int(period) for period in orbits["orbit_period"].values})
    for piece, period, is_stable in _pieces(orbits):
        index = periods.index(period)
        color = LINES[index % len(LINES)]["color"]
        panel.plot(x[piece], np.full(x[piece].size, index), color=color,
                   linewidth=4.0 if is_stable else 1.0,
                   linestyle="-", solid_capstyle="butt")  # fmt: skip
    panel.set_yticks(range(len(periods)), [str(period) for period in periods])
    panel.set_ylim(-0.6, len(periods) - 0.4)
    panel.set_ylabel("period")


def _pieces(orbits: xr.Dataset) -> Iterator[tuple[slice, int, bool]]:
    """Segments of branches of equal stability; a special point belongs to both neighbours."""
    branch = orbits["orbit_branch"].values
    ordinary = orbits["orbit_kind"].values == 0
    stable = orbits["orbit_stable"].values == 1
    period = orbits["orbit_period"].values
    for number in np.unique(branch):
        (points,) = np.nonzero(branch == number)
        first, now = int(points[0]), None
        last = first
        for k in points.tolist():
            if ordinary[k]:
                if now is not None and bool(stable[k]) != now:
                    yield slice(first, max(last + 1, k)), int(period[k]), now
                    first = max(last, k - 1)
                now, last = bool(stable[k]), k
        if now is not None:
            yield slice(first, int(points[-1]) + 1), int(period[points[-1]]), now


def _draw_marks(panel: Axes, orbits: xr.Dataset, x: np.ndarray, y: np.ndarray) -> None:
    """Mark the special points."""
    for (kind, grazing), (text, style) in MARKS.items():
        at = orbits["orbit_kind"].values == kind
        if grazing is not None:
            at = at & (_grazing(orbits) == grazing)
        if at.any():
            panel.plot(x[at], y[at], linestyle="none", color=MARK_COLOR, label=text, **style)


def _grazing(orbits: xr.Dataset) -> np.ndarray:
    """What grazes at each point (pair or mesh); files of earlier versions refer to the mesh."""
    if "orbit_grazing" in orbits:
        return np.asarray(orbits["orbit_grazing"].values)
    return np.full(orbits["orbit_kind"].values.shape, MESH)
