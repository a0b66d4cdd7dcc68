"""Campbell diagram: orders over speed, natural frequencies, and their intersections."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import STYLE, legend, line_style

RPM = 30.0 / math.pi
HIGH, WIDE = 0.042, 0.032  # size of an order's label, relative to the axes
HEADROOM = 1.12  # upper limit over the highest natural frequency
ORDER: dict[bool, dict[str, Any]] = {
    True: {"color": "#666666", "linewidth": 1.0, "linestyle": "-"},
    False: {"color": "#999999", "linewidth": 0.9, "linestyle": (0, (1.5, 2.5))},
}


def draw_campbell(result: xr.Dataset) -> Figure:
    """Draw natural frequencies and orders over the speed, and mark their intersections.

    Parameters
    ----------
    result : as `evolvent-post campbell` writes it.
    """
    speed = result["speed"].values
    top = HEADROOM * float(result["natural_frequency"].max()) / 1000.0
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 5.0), layout="constrained")
        axis = figure.subplots()
        for number, mode in enumerate(result["mode"].values):
            one = result.sel(mode=mode)
            damping = float(one["damping_ratio"].mean())
            axis.plot(
                speed * RPM, one["natural_frequency"] / 1000.0,
                label=f"mode {mode}, damping ratio {damping:.3g}",
                **{**line_style(number), "linewidth": 2.0},
            )  # fmt: skip
        _draw_orders(axis, result, top)
        for is_mesh in sorted({is_mesh for _, is_mesh in _excitations(result)}, reverse=True):
            axis.plot(
                [], [], label=f"orders of {'meshes' if is_mesh else 'wheels'}", **ORDER[is_mesh]
            )
        axis.plot(
            result["crossing_speed"] * RPM, result["crossing_frequency"] / 1000.0,
            linestyle="none", marker="o", markersize=6, markerfacecolor="white",
            markeredgecolor="#10243e", markeredgewidth=1.4, zorder=4, clip_on=False,
        )  # fmt: skip
        axis.set_xlim(speed[0] * RPM, speed[-1] * RPM)
        axis.set_ylim(0.0, top)
        axis.set_xlabel(f"speed of {result.attrs['wheel']} [rpm]")
        axis.set_ylabel("frequency [kHz]")
        handles, labels = axis.get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
    return figure


def _draw_orders(axis: Axes, result: xr.Dataset, top: float) -> None:
    """Draw orders from the left border to the upper or right one; label those of meshes."""
    speed = result["speed"].values
    excitations = _excitations(result)
    several = len({_name(text) for text, is_mesh in excitations if is_mesh}) > 1
    right, above = [], []
    for (text, is_mesh), order in zip(excitations, result["excitation_order"].values, strict=True):
        slope = float(order) / (2000.0 * np.pi)
        axis.plot(speed * RPM, slope * speed, zorder=1.5, **ORDER[is_mesh])
        if not is_mesh or slope * speed[0] >= top:
            continue
        name = f"{text.split(' ')[0]}x{f' {_name(text)}' if several else ''}"
        if slope * speed[-1] <= top:
            right.append((slope * float(speed[-1]) / top, name))
        else:
            above.append(((top / slope - speed[0]) / (speed[-1] - speed[0]), name))
    upright = {"rotation": 90, "ha": "center", "va": "bottom"} if several else {"ha": "center"}
    for (_, name), position in zip(sorted(right), spread(sorted(right), HIGH), strict=True):
        _write(axis, name, (1.0, position), (4, 0), ha="left", va="center")
    for (_, name), position in zip(sorted(above), spread(sorted(above), WIDE), strict=True):
        _write(axis, name, (position, 1.0), (0, 4), **upright)


def spread(labels: list[tuple[float, str]], least: float) -> list[float]:
    """Positions of labels near their targets, with a minimum spacing.

    Parameters
    ----------
    labels : target positions and texts, in ascending order.
    least : minimum spacing.
    """
    clusters: list[tuple[float, int]] = []  # mean position, number of labels
    for position, _ in labels:
        clusters.append((position, 1))
        while len(clusters) > 1:
            (a, n), (b, m) = clusters[-2:]
            if b - a >= least * (n + m) / 2:
                break
            clusters[-2:] = [((n * a + m * b) / (n + m), n + m)]
    return [a + least * (i - (n - 1) / 2) for a, n in clusters for i in range(n)]


def _write(
    axis: Axes, text: str, position: tuple[float, float], shift: tuple[int, int], **how: Any
) -> None:
    axis.annotate(
        text, position, xytext=shift, xycoords="axes fraction", textcoords="offset points",
        fontsize=10, color="#444444", **how,
    )  # fmt: skip


def _excitations(result: xr.Dataset) -> list[tuple[str, bool]]:
    """Names of the orders, and whether each belongs to a mesh."""
    names = [str(name) for name in result["excitation"].values]
    return list(zip(names, result["is_mesh"].values.astype(bool).tolist(), strict=True))


def _name(excitation: str) -> str:
    """Name of a mesh in "2 x mesh NAME"."""
    return excitation.split(" ", 3)[-1]
