"""Quantities of tooth pairs along the path of contact, over the roll angle."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.errors import USAGE, HistoryError
from evolvent.figures.long_histories import drawable
from evolvent.figures.style import ABOVE, STYLE, legend, line_style
from evolvent.history import require, source_name
from evolvent.physics.undefined_pressure import PRESSURE, note_of_history
from evolvent.signals.selection import over_time, unknown
from evolvent.units import axis_label, engineering

DEGREE = np.pi / 180
MARK: dict[str, Any] = {"color": "#777777", "linewidth": 1.0, "linestyle": ":", "zorder": 1.2}
POINTS = "A start, C pitch point, E end of the path of contact; from B to D a single pair"
MOST_LINES = 40  # passes of tooth pairs of a mesh: the last ones
PAIRS = "pair_"  # prefix of the quantities of tooth pairs


class Path(NamedTuple):
    """Roll angles of the driving flank [rad]: rho_A over its base radius."""

    start: float
    end: float
    single: tuple[float, float] | None  # limits of single contact; None at contact ratios from 2
    pitch_point: float


def path_of(history: xr.Dataset, mesh: int) -> Path:
    """Characteristic roll angles on the path of contact of a mesh."""
    one = history.isel(mesh=mesh)
    radius = abs(float(require(history, "base_radius")[int(require(one, "driving_wheel"))]))
    start = float(require(one, "rho_start_driving"))
    pitch, ratio = float(require(one, "base_pitch")), float(require(one, "contact_ratio"))
    end = start + ratio * pitch
    single = (end - pitch, start + pitch) if 1.0 < ratio < 2.0 else None
    # The pitch point divides the line of action in the ratio of the numbers of teeth.
    teeth = require(history, "teeth").values
    a, b = (float(teeth[int(require(one, f"{w}_wheel"))]) for w in ("driving", "driven"))
    point = float(require(one, "line_of_action_length")) * a / (a + b)
    return Path(
        start / radius,
        end / radius,
        None if single is None else (single[0] / radius, single[1] / radius),
        point / radius,
    )


def passes(history: xr.Dataset, name: str, mesh: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Roll angle [rad] and value along the path of each tooth pair of the drive flanks.

    Parameters
    ----------
    history : with pair_position, pair_on_path, pair_number (time, mesh, pair).
    name : variable of the same dimensions.

    Returns
    -------
    One entry per pass, in chronological order.
    """
    radius = abs(
        float(require(history, "base_radius")[int(require(history, "driving_wheel")[mesh])])
    )
    found: list[tuple[int, np.ndarray, np.ndarray]] = []
    for index, kind in enumerate(map(str, history["pair"].values)):
        if not kind.startswith("drive"):
            continue
        one = history.isel(mesh=mesh, pair=index)
        angle = require(one, "pair_position").values / radius
        values = require(one, name).values.astype(float)
        seen = (require(one, "pair_on_path").values > 0) & np.isfinite(angle)
        number = require(one, "pair_number").values
        breaks = 1 + np.flatnonzero((np.diff(number) != 0) | (np.diff(seen.astype(int)) != 0))
        for part in np.split(np.arange(angle.size), breaks):
            if part.size and seen[part[0]]:
                found.append((int(part[0]), angle[part], values[part]))
    return [(angle, values) for _, angle, values in sorted(found, key=lambda one: one[0])]


def draw_on_path(
    runs: Sequence[tuple[str, xr.Dataset]], names: Sequence[str], meshes: Sequence[str] = ()
) -> Figure:
    """Draw variables of tooth pairs over the roll angle, one row of panels per mesh.

    Roll angle is rho_A over the base radius of the driving wheel: its rotation while the contact
    moves from its base circle. All passes of one run have one style.

    Parameters
    ----------
    runs : labels and histories, with the same meshes.
    names : variables of tooth pairs; each has a column.
    meshes : names of meshes; all if empty.
    """
    first = runs[0][1]
    shown = list(meshes) or [str(name) for name in first["mesh"].values]
    if len({tuple(history["mesh"].values) for _, history in runs}) > 1 and not meshes:
        raise HistoryError(
            "the histories have different meshes; draw each separately, or select one with --mesh",
            USAGE,
        )
    for _, history in runs:
        _check(history, names, shown)
    runs = [(label, drawable(history, [*names, "pair_number"])) for label, history in runs]
    with rc_context(STYLE):
        wide = max(7.5, 5.0 * len(names))
        figure = Figure(figsize=(wide, 1.4 + 3.2 * len(shown)), layout="constrained")
        grid = figure.subplots(len(shown), len(names), squeeze=False, sharex="row")
        entries: dict[str, Any] = {}
        for row, mesh in zip(grid, shown, strict=True):
            for axis, name in zip(row, names, strict=True):
                entries |= _draw(axis, runs, name, mesh)
                if len(shown) > 1:
                    axis.set_title(f"mesh {mesh}", loc="left", fontsize=12, pad=20)
        figure.supxlabel(POINTS, x=0.01, ha="left", fontsize=10, color="#555555")
        if len(runs) > 1:
            legend(figure, entries, ABOVE)
    return figure


def _check(history: xr.Dataset, names: Sequence[str], meshes: Sequence[str]) -> None:
    source = source_name(history)
    there = [str(name) for name in require(history, "mesh").values]
    for mesh in meshes:
        if mesh not in there:
            raise HistoryError(
                f"{source}: has no mesh `{mesh}`; there is {', '.join(there)}", USAGE
            )
    for name in names:
        if name not in over_time(history):
            raise HistoryError(f"{source}: {unknown(history, name)}", USAGE)
        if "pair" not in history[name].dims:
            of_pairs = [n for n in over_time(history) if "pair" in history[n].dims]
            raise HistoryError(
                f"{source}: `{name}` is not of tooth pairs, so it has no position on the path of "
                f"contact; there is {', '.join(of_pairs)}",
                USAGE,
            )


def _draw(
    axis: Axes, runs: Sequence[tuple[str, xr.Dataset]], name: str, mesh: str
) -> dict[str, Any]:
    """Draw one panel; return its lines by label."""
    entries: dict[str, Any] = {}
    number = [str(one) for one in runs[0][1]["mesh"].values].index(mesh)
    found = [(label, history, _passes_of(history, name, mesh)) for label, history in runs]
    sizes = [np.abs(values) for *_, tracks in found for _, values in tracks]
    units = str(runs[0][1][name].attrs.get("units", "1"))
    factor, unit = engineering(np.concatenate(sizes) if sizes else 0.0, units)
    for style, (label, _, tracks) in enumerate(found):
        for angle, values in tracks[-MOST_LINES:]:
            (entries[label],) = axis.plot(
                angle / DEGREE, values * factor, **{**line_style(style), "linewidth": 0.9}
            )
    if name == PRESSURE:
        notes = dict.fromkeys(note_of_history(history, number) for _, history, _ in found)
        axis.text(
            0.02,
            0.02,
            "\n".join(textwrap.fill(note, 40) for note in notes),
            transform=axis.transAxes,
            fontsize=9,
            color="#555555",
        )
    path = path_of(runs[0][1], number)
    _mark_path(axis, path)
    ends = [path.start, path.end]
    # Beyond the path of contact, include only positions with load: corner contact.
    ends += [
        end for *_, tracks in found for angle, v in tracks for end in _ends(angle[np.abs(v) > 0])
    ]
    margin = 0.02 * (max(ends) - min(ends))
    axis.set_xlim((min(ends) - margin) / DEGREE, (max(ends) + margin) / DEGREE)
    wheel = runs[0][1]["wheel"].values[int(runs[0][1]["driving_wheel"][number])]
    axis.set_xlabel(f"roll angle of {wheel} [°]")
    axis.set_ylabel(axis_label(name.removeprefix(PAIRS).replace("_", " "), unit))
    if (
        sizes
        and min(values.min() for *_, tracks in found for _, values in tracks if values.size) >= 0
    ):
        axis.set_ylim(bottom=0.0)
    return entries


def _ends(angle: np.ndarray) -> list[float]:
    return [float(angle.min()), float(angle.max())] if angle.size else []


def _passes_of(history: xr.Dataset, name: str, mesh: str) -> list[tuple[np.ndarray, np.ndarray]]:
    return passes(history, name, [str(one) for one in history["mesh"].values].index(mesh))


def _mark_path(axis: Axes, path: Path) -> None:
    """Mark points A to E of the path: start, single contact B to D, pitch point C, end."""
    points = {"A": path.start, "C": path.pitch_point, "E": path.end}
    if path.single is not None:
        points |= {"B": path.single[0], "D": path.single[1]}
    for text, angle in points.items():
        axis.axvline(angle / DEGREE, **MARK)
        axis.annotate(
            text, (angle / DEGREE, 1.0), xytext=(0, 3), xycoords=("data", "axes fraction"),
            textcoords="offset points", ha="center", fontsize=11, color="#555555",
        )  # fmt: skip
