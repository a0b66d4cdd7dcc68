"""Stacked panels over time with their events: common part of all figures over time."""

from __future__ import annotations

import textwrap
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from evolvent.figures.style import ABOVE, BELOW, MAX_MARKS, STYLE, legend, line_style
from evolvent.physics.thinning import thinned
from evolvent.units import axis_label, engineering

# Events shown in figures, with their marks at the lower edge.
EVENT_MARKS = {
    "tooth_switch": ("tooth switch", "^"),
    "tooth_switch_back": ("tooth switch back", "v"),
    "contact_closed": ("contact closed", "s"),
    "contact_opened": ("contact opened", "o"),
    "sliding_began": ("sliding began", "|"),
    "sliding_ended": ("sliding ended", "x"),
}
PEAK = "extreme over the run"
MAX_POINTS = 6000  # of a line; more are not visible and make an SVG of many megabytes
FLAT = 2e-4  # minimum axis range relative to the values; below it tick labels need 6 digits
TALL, SMALL, FEW = 2.7, 2.1, 3  # panel heights [inch], for few and for more panels
WIDEST = (27, 18)  # characters per line of axis labels


@dataclass(frozen=True)
class Curve:
    """One line of a figure."""

    label: str  # in the legend; equal labels have the same style in all panels
    values: xr.DataArray  # dim (time); drawn over its coordinate
    style: int | None = None  # index for `line_style`; by the order of labels if None
    peaks: Sequence[tuple[float, float]] = ()  # times [s] and values of the marked extremes


@dataclass(frozen=True)
class Panel:
    """One pair of axes over time."""

    ylabel: str  # stacked panels with the same label have the same unit
    curves: list[Curve]
    title: str = ""  # shown if there are several panels
    events: xr.Dataset | None = None  # as from `open_events`; marked if given
    window: tuple[float, float] | None = None  # displayed time range [s]; all if None


@dataclass(frozen=True)
class Over:
    """Horizontal axis of panels: the coordinate `time` of their curves and events."""

    label: str = "time"
    units: str = "s"


TIME = Over()


@dataclass(frozen=True)
class _Scale:
    """Factor from SI and unit of an axis."""

    factor: float
    unit: str


def figure_over_time(
    panels: Sequence[Panel | None], columns: int = 1, over: Over = TIME, heading: str = ""
) -> Figure:
    """Draw stacked panels, with the legend above and the events below.

    The panels share the time axis unless one of them has its own time range.

    Parameters
    ----------
    panels : row by row; None leaves a cell empty.
    columns : number of panels in a row.
    heading : a line at the top.
    """
    there = [panel for panel in panels if panel is not None]
    shared = over is TIME and all(panel.window is None for panel in there)
    rows = -(-len(panels) // columns)
    height = 1.9 + (TALL if rows <= FEW else SMALL) * rows
    styles = _styles([curve for panel in there for curve in panel.curves])
    with rc_context(STYLE):
        figure = Figure(
            figsize=(7.5 if columns == 1 else 4.7 * columns, height), layout="constrained"
        )
        share: Any = "col" if shared else False
        grid = figure.subplots(rows, columns, sharex=share, squeeze=False).ravel()
        marks: dict[str, Any] = {}
        crowded: Counter[str] = Counter()
        entries: dict[str, Any] = {}
        for number, (axis, panel) in enumerate(
            zip(grid, [*panels, *[None] * len(grid)], strict=False)
        ):
            if panel is None:
                axis.set_visible(False)
                continue
            x = _x_scale(panels[number % columns :: columns] if shared else [panel], over.units)
            column = [other for other in panels[number % columns :: columns] if other is not None]
            y = _y_scale([other for other in column if other.ylabel == panel.ylabel])
            label = textwrap.fill(panel.ylabel, WIDEST[rows > FEW])
            _draw(axis, panel, x, y, styles)
            axis.set_ylabel(axis_label(label, y.unit))
            if panel.events is not None:
                marks |= _mark_events(axis, panel.events, x.factor, crowded)
            named = zip(*axis.get_legend_handles_labels(), strict=True)
            entries |= {label: handle for handle, label in named if label not in {*marks, *entries}}
            if panel.title and len(there) > 1:
                axis.set_title(panel.title, loc="left", fontsize=12)
            below = panels[number + columns :: columns]
            if not shared or all(other is None for other in below):
                axis.set_xlabel(axis_label(over.label, x.unit))
                axis.tick_params(labelbottom=True)
        if PEAK in entries:
            entries[PEAK] = entries.pop(PEAK)  # move to the end
        legend(figure, entries, ABOVE, heading)
        if crowded:
            counted = ", ".join(f"{number} of {label}" for label, number in crowded.items())
            marks[f"too many to mark: {counted}"] = Line2D([], [], linestyle="none")
        legend(figure, marks, BELOW)
    return figure


def _styles(curves: Sequence[Curve]) -> dict[str, int]:
    """Index of the style of each label, in the order of occurrence."""
    labels = dict.fromkeys(curve.label for curve in curves if curve.style is None)
    return {label: number for number, label in enumerate(labels)}


def _x_scale(panels: Sequence[Panel | None], units: str) -> _Scale:
    ends = [
        curve.values["time"].values[[0, -1]] if panel.window is None else panel.window
        for panel in panels
        if panel is not None
        for curve in panel.curves
        if curve.values.size
    ]
    return _Scale(*engineering(np.array(ends), units))


def _y_scale(panels: Sequence[Panel]) -> _Scale:
    curves = [(curve, panel.window) for panel in panels for curve in panel.curves]
    units = str(curves[0][0].values.attrs.get("units", "1"))
    shown = [_within(curve.values, window) for curve, window in curves]
    heights = [
        value
        for (curve, _), values in zip(curves, shown, strict=True)
        for _, value in _peaks_within(curve, values)
    ]
    return _Scale(*engineering(np.concatenate([heights, *(v.values for v in shown)]), units))


def _draw(axis: Axes, panel: Panel, x: _Scale, y: _Scale, styles: dict[str, int]) -> None:
    begin, end = np.inf, -np.inf
    for curve in panel.curves:
        values = _within(curve.values, panel.window)
        style = line_style(styles[curve.label] if curve.style is None else curve.style)
        if values.dtype.kind in "iub":  # constant from one output to the next
            style["drawstyle"] = "steps-post"
            axis.yaxis.set_major_locator(MaxNLocator(nbins="auto", integer=True))
        times = values["time"].values * x.factor
        rows = thinned(values.values, MAX_POINTS)
        heights = values.values[rows] * y.factor
        axis.plot(times[rows], heights, label=curve.label or "_", **style)
        peaks = [(t * x.factor, v * y.factor) for t, v in _peaks_within(curve, values)]
        _mark_peaks(axis, peaks, style["color"])
        if times.size:
            begin, end = min(begin, times.min()), max(end, times.max())
    if begin < end:
        axis.set_xlim(begin, end)
    axis.margins(y=0.08)
    low, high = axis.get_ylim()
    middle = (low + high) / 2
    if high - low < FLAT * abs(middle):
        axis.set_ylim(middle - FLAT / 2 * abs(middle), middle + FLAT / 2 * abs(middle))


def _peaks_within(curve: Curve, shown: xr.DataArray) -> list[tuple[float, float]]:
    """Extremes within the displayed times; others would lie outside the panel."""
    times = shown["time"].values
    return [peak for peak in curve.peaks if times.size and times[0] <= peak[0] <= times[-1]]


def _mark_peaks(axis: Axes, peaks: Sequence[tuple[float, float]], color: Any) -> None:
    """Mark the extremes over the run at their exact times, also between outputs."""
    if peaks:
        axis.plot(
            [time for time, _ in peaks],
            [value for _, value in peaks],
            linestyle="none",
            marker="D",
            markersize=7,
            markerfacecolor="white",
            markeredgecolor=color,
            markeredgewidth=1.6,
            clip_on=False,
            zorder=3,
            label=PEAK,
        )


def _within(values: xr.DataArray, window: tuple[float, float] | None) -> xr.DataArray:
    return values if window is None else values.sel(time=slice(*window))


def _mark_events(
    axis: Axes, events: xr.Dataset, factor: float, crowded: Counter[str]
) -> dict[str, Any]:
    """Mark events at the lower edge; return marks by label, and count those too dense to mark."""
    begin, end = axis.get_xlim()
    when = events["time"].values * factor
    inside = (when >= begin) & (when <= end)
    marks: dict[str, Any] = {}
    for kind, (label, marker) in EVENT_MARKS.items():
        times = when[inside & (events["kind"].values == kind)]
        if times.size > MAX_MARKS:
            crowded[label] += int(times.size)
            continue
        if times.size == 0:
            continue
        if kind.startswith("tooth_switch"):
            for time in times:
                axis.axvline(time, color="#999999", linewidth=0.8, linestyle=":", zorder=0.5)
        (marks[label],) = axis.plot(
            times,
            np.full(times.size, 0.025),
            marker,
            transform=axis.get_xaxis_transform(),
            color="#555555",
            markersize=5,
            markerfacecolor="#bbbbbb",
            clip_on=False,
            zorder=2.5,
            label=label,
        )
    return marks


def of_mesh(events: xr.Dataset | None, mesh: int) -> xr.Dataset | None:
    """Select the events of a mesh and those without a mesh."""
    if events is None:
        return None
    return events.isel(event=np.isin(events["mesh"].values, [-1, mesh]))
