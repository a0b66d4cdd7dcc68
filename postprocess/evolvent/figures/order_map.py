"""Order maps: amplitudes of orders during a run-up."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib import colormaps, rc_context
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from evolvent.errors import USAGE, HistoryError
from evolvent.figures.spectrum import described
from evolvent.figures.style import STYLE, log_ticks
from evolvent.units import axis_label, engineering

DARK = colormaps["magma_r"]  # lightness decreases monotonically: readable in grey as well
DEPTH = 1e-3  # of the largest line: smaller amplitudes get the lightest colour
HEIGHT = 1e-2  # of the largest line: the axis ends at the last order above it
RPM = 30.0 / math.pi


def draw_order_maps(
    maps: Sequence[tuple[str, xr.Dataset]], over_time: bool = False, as_frequency: bool = False
) -> Figure:
    """Draw amplitudes over speed and order, one panel per map, with a common colour scale.

    Parameters
    ----------
    maps : names and order maps of one quantity.
    over_time : time instead of speed; always so if the speed is not monotonic.
    as_frequency : frequency instead of order.
    """
    if len({str(one.attrs.get("quantity")) for _, one in maps}) > 1:
        raise HistoryError(
            "order maps of different quantities cannot share a figure; draw each separately",
            USAGE,
        )
    first = maps[0][1]
    by_speed = not over_time and all(_is_monotonic(one["speed"].values) for _, one in maps)
    top = max(float(one["amplitude"][:, 1:].max()) for _, one in maps)
    factor, unit = engineering(top, str(first["amplitude"].attrs["units"]))
    scale = LogNorm(DEPTH * top * factor, top * factor) if top > 0 else None
    last = max(_last(one, HEIGHT * top, as_frequency) for _, one in maps)
    scale_y, hertz = engineering(last, "Hz") if as_frequency else (1.0, "")
    scale_t, unit_t = engineering([one["time"].values[-1] for _, one in maps], "s")
    with rc_context({**STYLE, "axes.grid": False}):
        figure = Figure(figsize=(7.5, 0.6 + 3.6 * len(maps)), layout="constrained")
        panels = figure.subplots(len(maps), 1, sharex=True, sharey=True, squeeze=False)[:, 0]
        for panel, (label, one) in zip(panels, maps, strict=True):
            x = one["speed"].values * RPM if by_speed else one["time"].values * scale_t
            y = one["frequency"].values if as_frequency else one["order"].values[None, :]
            y = y * scale_y
            shape = one["amplitude"].shape
            drawn = panel.pcolormesh(
                np.broadcast_to(x[:, None], shape)[:, 1:],
                np.broadcast_to(y, shape)[:, 1:],
                np.maximum(one["amplitude"].values[:, 1:] * factor, DEPTH * top * factor),
                norm=scale, cmap=DARK, shading="nearest", rasterized=True,
            )  # fmt: skip
            panel.set_ylabel(axis_label("frequency", hertz) if hertz else _order_label(one))
            panel.set_ylim(0.0, last * scale_y)
            if len(maps) > 1:
                panel.set_title(label, loc="left", fontsize=12)
        wheel = first.attrs.get("wheel", "")
        panels[-1].set_xlabel(f"speed of {wheel} [rpm]" if by_speed else axis_label("time", unit_t))
        heading = textwrap.fill(described(first), 80)
        figure.suptitle(heading, x=0.01, ha="left", fontsize=11)
        bar = figure.colorbar(drawn, ax=list(panels), extend="min")
        bar.set_label(axis_label("amplitude", unit))
        if scale is not None:
            log_ticks(bar.ax.yaxis)
    return figure


def _last(one: xr.Dataset, least: float, as_frequency: bool) -> float:
    """Axis limit slightly above the highest order, or frequency, with a line of this height."""
    high = np.argwhere(one["amplitude"].values[:, 1:] >= least)
    abscissae = one["frequency"].values if as_frequency else one["order"].values[None, :]
    if not high.size:
        return float(abscissae.max())
    rows, lines = high[:, 0] if as_frequency else 0 * high[:, 0], 1 + high[:, 1]
    return min(1.05 * float(abscissae[rows, lines].max()), float(abscissae.max()))


def _order_label(one: xr.Dataset) -> str:
    return str(one["order"].attrs["long_name"])


def _is_monotonic(values: np.ndarray) -> bool:
    steps = np.diff(values)
    return bool((steps > 0).all() or (steps < 0).all())
