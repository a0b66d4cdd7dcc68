"""Load of each tooth pair over the roll angle of the driving wheel, or over time."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.long_histories import drawable
from evolvent.figures.style import BELOW, MAX_MARKS, STYLE, legend, line_style
from evolvent.history import require
from evolvent.physics.teeth import pitches_passed
from evolvent.physics.undefined_pressure import note_of_history
from evolvent.signals.turning import driving_sense
from evolvent.units import axis_label, engineering

NEEDS = ("normal_force", "pair_normal_force", "pair_contact_pressure", "pair_number")
SHOWN_PITCHES = 6.0  # number of readable pitches, if no time range is given
SUM: dict[str, Any] = {"color": "#c4c4c4", "linewidth": 4.0, "zorder": 1.5}
ENTRY, EXIT = ("a pair enters the path", "^"), ("a pair leaves it", "v")
MARKS = {"pair_entered": (ENTRY,), "pair_left": (EXIT,), "tooth_switch": (ENTRY, EXIT)}
MAX_NAMED = 4  # pairs of one style that the legend names


def last_pitches(history: xr.Dataset, n: float = SHOWN_PITCHES) -> xr.Dataset:
    """Return the part of a history in which the fastest teeth pass their last `n` pitches."""
    passed = pitches_passed(history)
    if not passed.size:
        return history
    # a slice, without a copy: histories may have millions of outputs
    return history.isel(time=slice(int(np.argmax(passed >= passed[-1] - n - 1e-9)), None))


def roll_angle(history: xr.Dataset, mesh: int) -> xr.DataArray:
    """Roll angle of a mesh's driving wheel since the start [rad], dim (time).

    Positive in its nominal driving direction.
    """
    wheel = int(require(history, "driving_wheel")[mesh])
    return driving_sense(history, mesh) * require(history, "angle").isel(wheel=wheel)


def on_their_path(history: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable; values of tooth pairs outside the path of contact are NaN.

    Pair slots that never carry load are NaN as well: mostly those of the coast flanks.
    """
    values = require(history, name)
    if "pair" not in values.dims or "pair_on_path" not in history or name == "pair_on_path":
        return values
    shown = history["pair_on_path"] > 0
    if "pair_normal_force" in history:
        carries = (history["pair_normal_force"] > 0).any("time")
        shown = shown & (carries | ~carries.any("pair"))
    return values.where(shown).assign_attrs(values.attrs)


def draw_pairs(
    history: xr.Dataset, events: xr.Dataset | None = None, over_time: bool = False
) -> Figure:
    """Draw normal force and contact pressure of every tooth pair, two panels per mesh.

    Parameters
    ----------
    history : with pair_normal_force [N], pair_contact_pressure [Pa], pair_on_path and pair_number,
        dims (time, mesh, pair).
    events : as from `open_events`; entry and exit of pairs are marked if given.
    over_time : draw over time, not over the roll angle of the driving wheel.
    """
    history = drawable(history, NEEDS)
    n = history.sizes["mesh"]
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 1.5 + 4.1 * n), layout="constrained")
        panels = figure.subplots(2 * n, 1, squeeze=False, height_ratios=[3, 2] * n)[:, 0]
        marks: dict[str, Any] = {}
        for mesh in range(n):
            force, pressure = panels[2 * mesh : 2 * mesh + 2]
            pressure.sharex(force)
            force.tick_params(labelbottom=False)
            name = str(history["mesh"].values[mesh])
            driving = str(history["wheel"].values[int(require(history, "driving_wheel")[mesh])])
            if over_time:
                factor, unit = engineering(history["time"].values, "s")
                x = history["time"].values * factor
                pressure.set_xlabel(axis_label("time", unit))
            else:
                x = np.degrees(roll_angle(history, mesh).values)
                pressure.set_xlabel(f"roll angle of {driving} [°]")
            _draw_pairs(force, pressure, history, mesh, x)
            if events is not None:
                marks.update(_mark_changes(force, history, events, mesh, x))
            entries = zip(*force.get_legend_handles_labels(), strict=True)
            named = {label: handle for handle, label in entries if label not in marks}
            if n > 1:
                anchor: Any = {"bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.1}
                named_by = force.legend(
                    named.values(), named, loc="lower left", ncols=2, title=f"mesh {name}",
                    alignment="left", **anchor,
                )  # fmt: skip
                named_by.get_title().set_fontweight("bold")
            else:
                legend(figure, named)
        legend(figure, marks, BELOW)
    return figure


def _draw_pairs(force: Axes, pressure: Axes, history: xr.Dataset, mesh: int, x: np.ndarray) -> None:
    """Draw one line per pair slot, interrupted where the next pair takes the slot."""
    total = require(history, "normal_force").values[:, mesh]
    loads = require(history, "pair_normal_force").values[:, mesh]
    pressures = require(history, "pair_contact_pressure").values[:, mesh]
    on_path = require(history, "pair_on_path").values[:, mesh] > 0
    numbers = require(history, "pair_number").values[:, mesh]
    load_factor, load_unit = engineering(total, "N")
    pressure_factor, pressure_unit = engineering(pressures, "Pa")
    force.plot(x, total * load_factor, label="sum of all pairs", **SUM)
    coast_shown = False
    for index, name in enumerate(str(v) for v in history["pair"].values):
        kind, slot = name.rsplit("_", 1)
        coast = kind == "coast"
        style: Any = line_style(int(slot))
        seen = on_path[:, index]
        if not seen.any() or (coast and not (loads[:, index] > 0).any()):
            continue
        if coast:
            label = "_" if coast_shown else "pairs of the coast flanks"
            style, coast_shown = {"color": "#9c2f6b", "linewidth": 0.9, "linestyle": "-"}, True
        else:
            label = _naming(np.unique(numbers[seen, index]))
        breaks = 1 + np.flatnonzero(np.diff(numbers[:, index]))
        for axis, values, factor in (
            (force, loads, load_factor),
            (pressure, pressures, pressure_factor),
        ):
            shown = np.where(seen, values[:, index] * factor, np.nan)
            axis.plot(np.insert(x, breaks, np.nan), np.insert(shown, breaks, np.nan), label=label)
            axis.lines[-1].set(**style)
    force.set_ylabel(f"normal force [{load_unit}]")
    pressure.set_ylabel(f"contact\npressure [{pressure_unit}]")
    pressure.set_title(
        note_of_history(history, mesh), loc="left", fontsize=10, color="#555555", pad=4
    )
    for axis in (force, pressure):
        axis.set_ylim(bottom=0.0)
    # space for the marks of entry and exit above the curves
    force.set_ylim(top=1.12 * force.get_ylim()[1])
    if x.size > 1 and x.min() < x.max():
        force.set_xlim(x.min(), x.max())


def _mark_changes(
    axis: Axes, history: xr.Dataset, events: xr.Dataset, mesh: int, x: np.ndarray
) -> dict[str, Any]:
    """Mark entry and exit of pairs at the upper edge; return the marks by label."""
    time = history["time"].values
    when, kinds = events["time"].values, events["kind"].values
    here = (events["mesh"].values == mesh) & (when >= time[0]) & (when <= time[-1])
    if "flank" in events:
        here &= events["flank"].values == 0
    marks: dict[str, Any] = {}
    for label, marker in (ENTRY, EXIT):
        matching = [kind for kind, meant in MARKS.items() if (label, marker) in meant]
        times = when[here & np.isin(kinds, matching)]
        if times.size == 0 or times.size > MAX_MARKS:
            continue
        (marks[label],) = axis.plot(
            np.interp(times, time, x),
            np.full(times.size, 0.95 if marker == "^" else 0.90),
            marker,
            transform=axis.get_xaxis_transform(),
            color="#333333",
            markerfacecolor="#ffffff" if marker == "^" else "#333333",
            markersize=6,
            clip_on=False,
            label=label,
        )
    return marks


def _naming(numbers: np.ndarray) -> str:
    """Label of the tooth pairs of one line, counted in pitches since the start."""
    texts = [str(int(number)) for number in numbers[:MAX_NAMED]]
    if numbers.size > MAX_NAMED:
        texts.append("…")
    return f"tooth pair{'s' if numbers.size > 1 else ''} {', '.join(texts)}"
