"""Panels over time below each other, with their events: what all figures over time share."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import ABOVE, BELOW, LINES, MAX_MARKS, STYLE
from evolvent.units import engineering

# Events that a reader of the figures asks about, with their marks at the lower edge.
EVENT_MARKS = {
    "tooth_switch": ("tooth switch", "^"),
    "tooth_switch_back": ("tooth switch back", "v"),
    "contact_closed": ("contact closed", "s"),
    "contact_opened": ("contact opened", "o"),
    "sliding_began": ("sliding began", "|"),
    "sliding_ended": ("sliding ended", "x"),
}
PEAK = "extreme over the run"
MAX_POINTS = 6000  # of a line; more cannot be seen and make an SVG of many megabytes


@dataclass(frozen=True)
class Curve:
    """One line of a figure."""

    label: str
    values: xr.DataArray  # dim (time)
    style: int | None = None  # number in `LINES`; that of its place in the panel if None
    peaks: Sequence[tuple[float, float]] = ()  # times [s] and values of the extremes, marked


@dataclass(frozen=True)
class Panel:
    """One pair of axes over time."""

    ylabel: str
    curves: list[Curve]
    title: str = ""  # shown if there are several panels
    events: xr.Dataset | None = None  # as from `open_events`; marked if given
    window: tuple[float, float] | None = None  # the times that are shown [s]; all if None


def figure_over_time(panels: Sequence[Panel]) -> Figure:
    """Draw panels below each other, their curves named above and their events below.

    The panels share the time axis unless one of them shows a window of its own.
    """
    shared = all(panel.window is None for panel in panels)
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 1.9 + 2.7 * len(panels)), layout="constrained")
        axes = figure.subplots(len(panels), 1, sharex=shared, squeeze=False)[:, 0]
        marks: set[str] = set()
        for axis, panel in zip(axes, panels, strict=True):
            _draw(axis, panel)
            if panel.events is not None:
                marks.update(_mark_events(axis, panel.events))
            if panel.title and len(panels) > 1:
                axis.set_title(panel.title, loc="left", fontsize=12)
            if axis is axes[-1] or not shared:
                axis.set_xlabel("time [s]")
        _legends(figure, list(axes), marks)
    return figure


def _draw(axis: Axes, panel: Panel) -> None:
    shown = [_within(curve.values, panel.window) for curve in panel.curves]
    units = str(shown[0].attrs.get("units", "1"))
    shown_peaks = [
        _peaks_within(curve, values) for curve, values in zip(panel.curves, shown, strict=True)
    ]
    heights = [value for curve in shown_peaks for _, value in curve]
    factor, unit = engineering(
        np.concatenate([heights, *(values.values for values in shown)]), units
    )
    for number, (curve, values) in enumerate(zip(panel.curves, shown, strict=True)):
        style = LINES[(number if curve.style is None else curve.style) % len(LINES)]
        axis.plot(
            *_thinned(values["time"].values, values.values * factor), label=curve.label, **style
        )
    for line, places in zip(list(axis.lines), shown_peaks, strict=True):
        _mark_peaks(axis, places, factor, line.get_color())
    axis.set_ylabel(f"{panel.ylabel} [{unit}]" if unit else panel.ylabel)
    times = [values["time"].values for values in shown if values.size]
    if times:
        begin, end = min(t[0] for t in times), max(t[-1] for t in times)
        if begin < end:
            axis.set_xlim(begin, end)
    axis.margins(y=0.08)
    axis.ticklabel_format(useOffset=False)


def _peaks_within(curve: Curve, shown: xr.DataArray) -> list[tuple[float, float]]:
    """Extremes among the times that are shown: one beyond would stand outside of the panel."""
    times = shown["time"].values
    return [peak for peak in curve.peaks if times.size and times[0] <= peak[0] <= times[-1]]


def _mark_peaks(
    axis: Axes, places: Sequence[tuple[float, float]], factor: float, color: Any
) -> None:
    """Mark where the extremes over the run were reached, though no output lies there."""
    if places:
        axis.plot(
            [time for time, _ in places],
            [value * factor for _, value in places],
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


def _mark_events(axis: Axes, events: xr.Dataset) -> list[str]:
    """Mark events at the lower edge; return the labels of the marks."""
    begin, end = axis.get_xlim()
    inside = (events["time"].values >= begin) & (events["time"].values <= end)
    labels, crowded = [], []
    for kind, (label, marker) in EVENT_MARKS.items():
        times = events["time"].values[inside & (events["kind"].values == kind)]
        if times.size > MAX_MARKS:
            crowded.append(f"{times.size} of {label}")
            continue
        if times.size == 0:
            continue
        if kind.startswith("tooth_switch"):
            for time in times:
                axis.axvline(time, color="#999999", linewidth=0.8, linestyle=":", zorder=0.5)
        axis.plot(
            times,
            np.full(times.size, 0.025),
            marker,
            transform=axis.get_xaxis_transform(),
            color="#555555",
            markersize=5,
            markerfacecolor="#bbbbbb",
            label=label,
        )
        labels.append(label)
    if crowded:
        labels.append(f"too many to mark: {', '.join(crowded)}")
        axis.plot([], [], " ", label=labels[-1])
    return labels


def _legends(figure: Figure, axes: list[Axes], marks: set[str]) -> None:
    """Name the curves above the panels and the events below, where they hide nothing."""
    entries: dict[str, Any] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    curves = [label for label in entries if label not in marks]
    for place, labels in ((ABOVE, curves), (BELOW, [label for label in entries if label in marks])):
        if labels:
            handles = [entries[label] for label in labels]
            figure.legend(handles, labels, loc=place, ncols=4, columnspacing=1.4)


def _thinned(time: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Keep the smallest and the largest value of each of equal blocks if there are too many."""
    if values.size <= MAX_POINTS:
        return time, values
    block = -(-values.size // (MAX_POINTS // 2))
    starts = np.arange(0, values.size, block)
    finite = np.where(np.isfinite(values), values, values[np.isfinite(values)][0])
    low = [s + int(np.argmin(finite[s : s + block])) for s in starts]
    high = [s + int(np.argmax(finite[s : s + block])) for s in starts]
    kept = np.unique(np.concatenate([low, high, [0, values.size - 1]]))
    return time[kept], values[kept]


def of_mesh(events: xr.Dataset | None, mesh: int) -> xr.Dataset | None:
    """Keep the events of a mesh and those that concern none."""
    if events is None:
        return None
    return events.isel(event=np.isin(events["mesh"].values, [-1, mesh]))
