"""Figures of one or several histories over time. They take datasets and return figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.history import require
from evolvent.told_extremes import peaks
from evolvent.units import prefixed

# Told apart by lightness and by dashes, so that they survive a grey printer.
LINES = (
    {"color": "#10243e", "linestyle": "-"},
    {"color": "#d1681c", "linestyle": (0, (5, 2))},
    {"color": "#3f8fc4", "linestyle": (0, (1.2, 1.2))},
    {"color": "#7a9a2b", "linestyle": (0, (6, 1.5, 1.2, 1.5))},
    {"color": "#b78bc0", "linestyle": (0, (3, 1, 1, 1, 1, 1))},
)
STYLE: dict[Any, Any] = {
    "font.size": 12,
    "axes.labelsize": 12,
    "legend.fontsize": 11,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "svg.hashsalt": "evolvent",  # the same figure gives the same file
}
# Events that a reader of the figures asks about, with their marks at the lower edge.
EVENT_MARKS = {
    "tooth_switch": ("tooth switch", "^"),
    "tooth_switch_back": ("tooth switch back", "v"),
    "contact_closed": ("contact closed", "s"),
    "contact_opened": ("contact opened", "o"),
    "sliding_began": ("sliding began", "|"),
    "sliding_ended": ("sliding ended", "x"),
}
# matplotlib's type hints do not know these places.
ABOVE: Any = "outside upper left"
BELOW: Any = "outside lower left"
PEAK = "extreme over the run"
MAX_MARKS = 40  # of one kind of event; more would run into each other and hide the curves
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
            _panel_title(history, mesh),
            _of_mesh(events, mesh),
        )
        for mesh in range(history.sizes["mesh"])
    ]
    return figure_over_time(panels)


def figure_transmission_error(
    histories: Sequence[xr.Dataset], labels: Sequence[str], events: xr.Dataset | None = None
) -> Figure:
    """Draw the transmission error Delta of several runs together, one panel a mesh.

    Parameters
    ----------
    histories : with transmission_error [m], dims (time, mesh), and the same number of meshes.
    labels : one a history.
    events : of one of them; marked if given.

    Source: Kosenko & Gusev 2011, (19) and Figure 4.
    """
    panels = [
        Panel(
            r"transmission error $\Delta$",
            [
                Curve(
                    label,
                    require(history, "transmission_error").isel(mesh=mesh),
                    peaks=peaks(history, "transmission_error", mesh),
                )
                for history, label in zip(histories, labels, strict=True)
            ],
            _panel_title(histories[0], mesh),
            _of_mesh(events, mesh),
        )
        for mesh in range(histories[0].sizes["mesh"])
    ]
    return figure_over_time(panels)


def figure_normal_force(history: xr.Dataset, events: xr.Dataset | None = None) -> Figure:
    """Draw the normal force F_n [N] of every mesh over time, dims (time, mesh)."""
    force = require(history, "normal_force")
    curves = [
        Curve(
            _name(history, "mesh", m),
            force.isel(mesh=m),
            peaks=peaks(history, "normal_force", m),
        )
        for m in range(force.mesh.size)
    ]
    return figure_over_time([Panel("normal force $F_n$", curves, events=events)])


def figure_speeds(history: xr.Dataset, events: xr.Dataset | None = None) -> Figure:
    """Draw the angular velocity [rad/s] of every wheel over time, dims (time, wheel)."""
    speed = require(history, "angular_velocity")
    curves = [
        Curve(_name(history, "wheel", w), speed.isel(wheel=w)) for w in range(speed.wheel.size)
    ]
    return figure_over_time([Panel(r"angular velocity $\omega$", curves, events=events)])


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


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the file's ending; the same data give the same bytes."""
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with rc_context(STYLE):
        figure.savefig(path, dpi=150, metadata=undated.get(path.suffix.lstrip(".").lower()))


def _draw(axis: Axes, panel: Panel) -> None:
    shown = [_within(curve.values, panel.window) for curve in panel.curves]
    units = str(shown[0].attrs.get("units", "1"))
    shown_peaks = [_peaks_within(curve, panel.window) for curve in panel.curves]
    heights = [abs(value) for curve in shown_peaks for _, value in curve]
    largest = max([_largest(values) for values in shown] + heights)
    factor, unit = prefixed(largest, units)
    for number, (curve, values) in enumerate(zip(panel.curves, shown, strict=True)):
        style = LINES[(number if curve.style is None else curve.style) % len(LINES)]
        axis.plot(
            *_thinned(values["time"].values, values.values * factor), label=curve.label, **style
        )
    for number, (curve, places) in enumerate(zip(panel.curves, shown_peaks, strict=True)):
        style = LINES[(number if curve.style is None else curve.style) % len(LINES)]
        _mark_peaks(axis, places, factor, style["color"])
    axis.set_ylabel(f"{panel.ylabel} [{unit}]" if unit else panel.ylabel)
    times = [values["time"].values for values in shown if values.size]
    if times:
        begin, end = min(t[0] for t in times), max(t[-1] for t in times)
        if begin < end:
            axis.set_xlim(begin, end)
    axis.margins(y=0.08)
    axis.ticklabel_format(useOffset=False)


def _peaks_within(curve: Curve, window: tuple[float, float] | None) -> list[tuple[float, float]]:
    return [
        (time, value)
        for time, value in curve.peaks
        if window is None or window[0] <= time <= window[1]
    ]


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


def _largest(values: xr.DataArray) -> float:
    finite = np.abs(values.values[np.isfinite(values.values)])
    return float(finite.max(initial=0.0))


def _of_mesh(events: xr.Dataset | None, mesh: int) -> xr.Dataset | None:
    if events is None:
        return None
    return events.isel(event=np.isin(events["mesh"].values, [-1, mesh]))


def _name(history: xr.Dataset, dim: str, index: int) -> str:
    return str(history[dim].values[index])


def _panel_title(history: xr.Dataset, mesh: int) -> str:
    return f"mesh {_name(history, 'mesh', mesh)}"
