"""Variables of histories over time or roll angle: arrangement in panels and lines."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from typing import NamedTuple, Protocol

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from evolvent.errors import USAGE, HistoryError
from evolvent.figures.long_histories import drawable
from evolvent.figures.over_time import TIME, Curve, Over, Panel, figure_over_time, of_mesh
from evolvent.figures.pairs import on_their_path, roll_angle
from evolvent.figures.style import MOST_STYLES
from evolvent.history import source_name
from evolvent.physics.extremes import peaks
from evolvent.signals.selection import OPTIONS, index_of, names_along, over_time, unknown

# Labels of frequent quantities; others use the name of the variable.
LABELS = {
    "transmission_error": r"transmission error $\Delta$",
    "penetration": "penetration $h$",
    "normal_force": "normal force $F_n$",
    "angular_velocity": r"speed $\omega$",
}
KINDS = {  # common name of quantities of one unit
    "m": "length", "m s-1": "velocity", "m s-2": "acceleration", "N": "force", "N m": "torque",
    "rad": "angle", "rad s-1": "speed", "rad s-2": "angular acceleration", "Pa": "pressure",
    "J": "energy", "W": "power",
}  # fmt: skip
APART = ("wheel", "shaft", "accelerometer")  # dimensions whose lines share a panel if possible
SAME = 2e-3  # of the panel height: lines with smaller differences are merged
FAR = 0.2  # of the height: if all lines together vary less, each has its own panel
MOST_PANELS = 12
WIDEST_TITLE = 36  # characters of the title of a panel in several columns


class X(StrEnum):
    """Variable on the horizontal axis."""

    TIME = "time"
    ROLL_ANGLE = "roll-angle"


class Shown(Protocol):
    """Part of a run that is drawn."""

    @property
    def history(self) -> xr.Dataset:
        """As from `open_history`, or a part of it."""

    @property
    def events(self) -> xr.Dataset | None:
        """As from `open_events`; marked if given."""

    @property
    def label(self) -> str:
        """In a legend with several runs."""


class _Drawn(NamedTuple):
    """Part of a run that is drawn, thinned out if it is long."""

    history: xr.Dataset
    events: xr.Dataset | None
    label: str


class _Subplot(NamedTuple):
    """A panel: its title, its mesh, and the names and indices of its lines."""

    title: str
    mesh: str | None
    lines: list[tuple[str, dict[str, int]]]


def draw_quantities(
    runs: Sequence[Shown],
    names: Sequence[str],
    chosen: Mapping[str, Sequence[str]] | None = None,
    over: X = X.TIME,
) -> Figure:
    """Draw variables of one or several histories in one figure.

    Quantities of one unit share panels; each mesh has its own panel. Runs with the same names of
    meshes, wheels and so on are overlaid, others are in separate columns. Coincident lines of
    wheels, such as those on one shaft, are merged into one line with all names.

    Parameters
    ----------
    runs : histories with labels.
    names : variables over time.
    chosen : names by dimension, such as {"mesh": ["first"]}; dimensions without an entry are
        complete.
    over : time, or the roll angle of the driving wheel since the start.

    Raises
    ------
    HistoryError
        A variable or name does not exist, a selection fits no variable, or the figure is too large.
    """
    runs = [_Drawn(drawable(r.history, names), r.events, r.label) for r in runs]
    picked = [[_picked(run, name, chosen or {}) for name in names] for run in runs]
    _check_choice(runs[0], picked[0], chosen or {})
    if len({_all_names(values) for values in picked}) == 1:
        columns = [_named(list(_panels(runs, picked, over)))]
    else:
        columns = [list(_panels([r], [v], over)) for r, v in zip(runs, picked, strict=True)]
        columns = [
            [replace(panel, title=_beside(run.label, panel.title)) for panel in column]
            for run, column in zip(runs, columns, strict=True)
        ]
    rows = max(len(column) for column in columns)
    if rows == 0:
        raise HistoryError(
            f"{source_name(runs[0].history)}: {', '.join(names)} has no value in the "
            "selected range",
            USAGE,
        )
    _check_size(runs[0], picked[0], columns)
    filled = [[*column, *[None] * (rows - len(column))] for column in columns]
    return figure_over_time(
        [panel for row in zip(*filled, strict=True) for panel in row],
        len(columns),
        TIME if over is X.TIME else Over("roll angle of the driving wheel", "rad"),
        _heading(picked[0]),
    )


def _beside(label: str, title: str) -> str:
    """Title of a panel beside those of another run."""
    return "\n".join(filter(None, [textwrap.fill(label, WIDEST_TITLE), title]))


def _named(panels: list[Panel]) -> list[Panel]:
    """Label the single line of a single panel, which shows no title."""
    if len(panels) != 1 or any(curve.label for curve in panels[0].curves):
        return panels
    name = panels[0].title.removeprefix("mesh ")
    return [replace(panels[0], curves=[replace(curve, label=name) for curve in panels[0].curves])]


def _picked(run: Shown, name: str, chosen: Mapping[str, Sequence[str]]) -> xr.DataArray:
    """One variable restricted to the selected meshes, wheels and so on."""
    source = source_name(run.history)
    if name not in over_time(run.history):
        raise HistoryError(f"{source}: {unknown(run.history, name)}", USAGE)
    values = on_their_path(run.history, name)
    for dim in [str(dim) for dim in values.dims]:
        selected = chosen.get("axis" if dim == "space" and "space" not in chosen else dim, ())
        if selected:
            values = values.isel({dim: [index_of(source, values, dim, one) for one in selected]})
    return values


def _check_choice(
    run: Shown, picked: Sequence[xr.DataArray], chosen: Mapping[str, Sequence[str]]
) -> None:
    """Reject a selection along a dimension that none of the quantities has."""
    there = {str(dim) for values in picked for dim in values.dims}
    there |= {"axis"} if "space" in there else set()
    for dim in chosen:
        if dim not in there:
            names = ", ".join(f"`{values.name}`" for values in picked)
            raise HistoryError(
                f"{source_name(run.history)}: {names} {'has' if len(picked) == 1 else 'have'} no "
                f"{dim}, so none can be selected; omit {OPTIONS.get(dim, f'--select {dim}=')}",
                USAGE,
            )


def _check_size(
    run: Shown, picked: Sequence[xr.DataArray], columns: Sequence[Sequence[Panel]]
) -> None:
    rows = max(len(column) for column in columns)
    labels = {curve.label for column in columns for panel in column for curve in panel.curves}
    what = None
    if rows > MOST_PANELS:
        what = f"{rows} panels, but at most {MOST_PANELS}"
    elif len(labels) > MOST_STYLES:
        what = f"{len(labels)} different lines, but at most {MOST_STYLES}"
    if what is not None:
        dims = dict.fromkeys(str(dim) for values in picked for dim in values.dims if dim != "time")
        names = ", ".join(str(values.name) for values in picked)
        options = " or ".join(OPTIONS.get(dim, f"--select {dim}=NAME") for dim in dims)
        raise HistoryError(
            f"{source_name(run.history)}: {names} would make {what} can be read; choose "
            f"{'by ' + options if options else 'fewer'}",
            USAGE,
        )


def _all_names(picked: Sequence[xr.DataArray]) -> tuple[tuple[str, ...], ...]:
    return tuple(
        tuple(names_along(values, str(dim)))
        for values in picked
        for dim in values.dims
        if dim != "time"
    )


def _heading(picked: Sequence[xr.DataArray]) -> str:
    """Description of a single quantity, unless its label is self-explanatory."""
    if len(picked) > 1 or picked[0].name in LABELS:
        return ""
    return textwrap.fill(str(picked[0].attrs.get("long_name", "")), 80)


def _panels(
    runs: Sequence[Shown], picked: Sequence[Sequence[xr.DataArray]], over: X
) -> Iterator[Panel]:
    """Stacked panels of runs whose names agree."""
    groups: dict[tuple[str, tuple[str, ...]], list[int]] = {}
    for number, values in enumerate(picked[0]):
        dims = tuple(str(dim) for dim in values.dims if dim != "time")
        groups.setdefault((str(values.attrs.get("units", "1")), dims), []).append(number)
    for (units, dims), members in groups.items():
        arrays = [[values[i] for i in members] for values in picked]
        names = [str(values.name) for values in arrays[0]]
        ylabel = (
            _label(names[0]) if len(names) == 1 else KINDS.get(units, ", ".join(map(_label, names)))
        )
        subplots = _subplots(arrays, dims)
        for subplot in subplots:
            curves = [
                curve
                for run, values in zip(runs, arrays, strict=True)
                for one in values
                for curve in _curves(run, one, subplot, over, (len(names) > 1, len(runs) > 1))
            ]
            title = f"mesh {subplot.title}" if subplot.mesh is not None else subplot.title
            events = _events(runs[0], subplot.mesh, over) if len(runs) == 1 else None
            if curves:
                yield Panel(ylabel, curves, title, events)


def _subplots(arrays: Sequence[Sequence[xr.DataArray]], dims: tuple[str, ...]) -> list[_Subplot]:
    """Panels of quantities along these dimensions."""
    if not dims:
        return [_Subplot("", None, [("", {})])]
    first = arrays[0][0]
    names = names_along(first, dims[0])
    if dims[0] in APART and len(dims) == 1:
        flat = [values.values for run in arrays for values in run]
        together = len(arrays) == 1 and not _far(flat)
        lines = _lines(flat, together)
        named = [(", ".join(names[i] for i in line), {dims[0]: line[0]}) for line in lines]
        if together:
            return [_Subplot("", None, named)]
        return [_Subplot(name, None, [("", index)]) for name, index in named]
    inner: list[tuple[str, dict[str, int]]] = [("", {})]
    for dim in dims[1:]:
        inner = [
            (f"{label} {name}".strip(), {**index, dim: i})
            for label, index in inner
            for i, name in enumerate(names_along(first, dim))
        ]
    return [
        _Subplot(
            name,
            name if dims[0] == "mesh" else None,
            [(label, {dims[0]: i, **index}) for label, index in inner],
        )
        for i, name in enumerate(names)
    ]


def _lines(arrays: Sequence[np.ndarray], together: bool) -> list[list[int]]:
    """Groups of columns that coincide in all arrays (time, column).

    Parameters
    ----------
    together : all lines share a panel, and the tolerance refers to its height, not to each line.
    """
    lines: list[list[int]] = []
    for column in range(arrays[0].shape[1]):
        for line in lines:
            if all(
                np.allclose(
                    values[:, column],
                    values[:, line[0]],
                    rtol=0.0,
                    atol=SAME * _span(values if together else values[:, line[0]]),
                    equal_nan=True,
                )
                for values in arrays
            ):
                line.append(column)
                break
        else:
            lines.append([column])
    return lines


def _far(arrays: Sequence[np.ndarray]) -> bool:
    """Whether the distances of the lines hide their variation in a common panel."""
    span = _span(np.concatenate([values.ravel() for values in arrays]))
    moves = [_span(column) for values in arrays for column in values.T]
    return 0.0 < sum(moves) < FAR * span


def _span(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(finite.max() - finite.min()) if finite.size else 0.0


def _curves(
    run: Shown, values: xr.DataArray, subplot: _Subplot, over: X, labelled: tuple[bool, bool]
) -> Iterator[Curve]:
    """Lines of one quantity of one run in one panel; lines without values are omitted.

    Parameters
    ----------
    labelled : whether labels contain the quantity, and the run.
    """
    name = str(values.name)
    for inner, index in subplot.lines:
        one = values.isel(index)
        if one.size and one.isnull().all():
            continue
        label = [_label(name) if labelled[0] else "", inner, run.label if labelled[1] else ""]
        marked_peaks = []
        if subplot.mesh is not None:
            mesh = names_along(run.history["mesh"], "mesh").index(subplot.mesh)
            marked_peaks = peaks(run.history, name, mesh) if not inner else []
        if over is not X.TIME:
            x = _roll(run, name, subplot.mesh)
            times = run.history["time"].values
            marked_peaks = [(float(np.interp(t, times, x)), v) for t, v in marked_peaks]
            one = one.assign_coords(time=x)
        yield Curve(", ".join(filter(None, label)), one, peaks=marked_peaks)


def _roll(run: Shown, name: str, mesh: str | None) -> np.ndarray:
    if mesh is None:
        raise HistoryError(
            f"{source_name(run.history)}: `{name}` is not of a mesh, so it has no roll angle; "
            "draw it over time",
            USAGE,
        )
    number = names_along(run.history["mesh"], "mesh").index(mesh)
    return np.asarray(roll_angle(run.history, number).values)


def _events(run: Shown, mesh: str | None, over: X) -> xr.Dataset | None:
    """Events to be marked: those of the mesh, or of the only mesh."""
    meshes = names_along(run.history["mesh"], "mesh") if "mesh" in run.history.dims else []
    if run.events is None or (mesh is None and len(meshes) > 1):
        return None
    events = run.events if mesh is None else of_mesh(run.events, meshes.index(mesh))
    if events is None or over is X.TIME or mesh is None:
        return events
    times = run.history["time"].values
    x = np.interp(events["time"].values, times, _roll(run, "", mesh), left=np.nan, right=np.nan)
    return events.assign(time=("event", x))


def _label(name: str) -> str:
    return LABELS.get(name, name.replace("_", " "))
