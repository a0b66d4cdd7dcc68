"""Campbell picture: orders over speed, natural frequencies, and where they meet."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import ABOVE, LINES, STYLE

RPM = 30.0 / math.pi
HEADROOM = 1.12  # above the highest natural frequency
ORDER: dict[bool, dict[str, Any]] = {
    True: {"color": "#666666", "linewidth": 1.0, "linestyle": "-"},
    False: {"color": "#999999", "linewidth": 0.9, "linestyle": (0, (1.5, 2.5))},
}


def draw_campbell(result: xr.Dataset) -> Figure:
    """Draw natural frequencies and orders over the speed, and mark where they meet.

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
                **{**LINES[number % len(LINES)], "linewidth": 2.0},
            )  # fmt: skip
        meshes = {_name(e) for e, is_mesh in _excitations(result) if is_mesh}
        for index in range(result.sizes["excitation"]):
            _draw_order(axis, result.isel(excitation=index), top, len(meshes) > 1)
        for is_mesh in sorted({is_mesh for _, is_mesh in _excitations(result)}, reverse=True):
            axis.plot(
                [], [], label=f"orders of {'meshes' if is_mesh else 'wheels'}", **ORDER[is_mesh]
            )
        axis.plot(
            result["crossing_speed"] * RPM, result["crossing_frequency"] / 1000.0,
            linestyle="none", marker="o", markersize=6, markerfacecolor="white",
            markeredgecolor="#10243e", markeredgewidth=1.4, zorder=4,
        )  # fmt: skip
        axis.set_xlim(speed[0] * RPM, speed[-1] * RPM)
        axis.set_ylim(0.0, top)
        axis.set_xlabel(f"speed of {result.attrs['wheel']} [rpm]")
        axis.set_ylabel("frequency [kHz]")
        figure.legend(loc=ABOVE, ncols=2)
    return figure


def _draw_order(axis: Axes, one: xr.Dataset, top: float, named: bool) -> None:
    """One order from the left border to the upper or the right one; those of meshes are named."""
    speed = one["speed"].values
    slope = float(one["excitation_order"]) / (2000.0 * np.pi)
    is_mesh = bool(one["is_mesh"])
    axis.plot(speed * RPM, slope * speed, zorder=1.5, **ORDER[is_mesh])
    end = min(float(speed[-1]), top / slope)
    if end <= speed[0] or not is_mesh:
        return
    at_top = end < speed[-1]
    text = str(one["excitation"].item())
    axis.annotate(
        f"{text.split(' ')[0]}x{f' {_name(text)}' if named else ''}",
        (end * RPM, slope * end),
        xytext=(0, 3) if at_top else (4, 0),
        textcoords="offset points",
        ha="center" if at_top else "left",
        va="bottom" if at_top else "center",
        fontsize=10,
        color="#444444",
    )


def _excitations(result: xr.Dataset) -> list[tuple[str, bool]]:
    """Names of the orders, and whether each is one of a mesh."""
    names = [str(name) for name in result["excitation"].values]
    return list(zip(names, result["is_mesh"].values.astype(bool).tolist(), strict=True))


def _name(excitation: str) -> str:
    """Name of a mesh in "2 x mesh NAME"."""
    return excitation.split(" ", 3)[-1]
