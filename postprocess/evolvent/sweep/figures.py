"""Figures of a summary: a result against one or two parameters, and Sobol indices.

Cases that did not finish are shown as crosses at their parameters.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.errors import USAGE, SweepError
from evolvent.figures.style import ABOVE, LINES, STYLE, legend, line_style, log_ticks
from evolvent.sweep.journal import DONE, did_not_finish
from evolvent.units import axis_label, engineering

MOST_LINES = 6  # of one figure; more cannot be distinguished
WIDE = 50.0  # ratio of the ends of a positive range for which the axis is logarithmic
BAD = "#b3202c"
MARKED: dict[str, Any] = {
    "linestyle": "none",
    "marker": "x",
    "color": BAD,
    "markersize": 6,
    "clip_on": False,
    "zorder": 4,
}
MAP_COLOURS = "viridis"
WIDEST_LABEL = 44  # characters; longer labels are wrapped


def figure_response(summary: xr.Dataset, response: str, against: Sequence[str] = ()) -> Figure:
    """Draw a result against one parameter, as lines or points, or against two, as a map.

    Parameters
    ----------
    summary : as from `open_summary`.
    response : name of a result.
    against : one or two parameters; by default the one with most values.
    """
    result = _one_of(summary, "result", response)
    varying = varying_parameters(summary)
    names = list(against) or _most_varied(summary, varying)
    for name in names:
        _one_of(summary, "parameter", name)
    others = [name for name in varying if name not in names]
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 4.6), layout="constrained")
        axis = figure.subplots()
        if len(names) == 1:
            _draw_lines(axis, summary, result, names[0], others)
        elif len(names) == 2:
            _draw_map(axis, summary, result, names[0], names[1], others)
        else:
            raise SweepError("a figure shows a result against one or two parameters", USAGE)
        for ruler in (axis.xaxis, axis.yaxis):
            if ruler.get_scale() == "log":
                log_ticks(ruler)
        handles, labels = axis.get_legend_handles_labels()
        legend(figure, dict(zip(labels, handles, strict=True)))
    return figure


def figure_indices(indices: xr.Dataset) -> Figure:
    """Draw sensitivity indices with their confidence intervals, dims (parameter)."""
    names = [str(name) for name in indices["parameter"].values]
    lines = {"first_order": LINES[0], "total": LINES[2]}
    kinds = [kind for kind in lines if kind in indices]
    width = 0.8 / len(kinds)
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 1.8 + 0.7 * len(names)), layout="constrained")
        axis = figure.subplots()
        for number, kind in enumerate(kinds):
            axis.barh(
                np.arange(len(names)) + (number - 0.5 * (len(kinds) - 1)) * width,
                indices[kind].values,
                height=0.9 * width,
                xerr=indices[f"{kind}_confidence"].values,
                color=lines[kind]["color"],
                error_kw={"ecolor": "#555555", "capsize": 3},
                label=kind.replace("_", " "),
            )
        axis.set_yticks(range(len(names)), names)
        axis.set_axisbelow(True)
        axis.invert_yaxis()
        axis.set_xlabel(f"share of the variance of {indices.attrs['response']}")
        axis.set_xlim(left=min(0.0, axis.get_xlim()[0]))
        figure.legend(loc=ABOVE, ncols=2)
    return figure


def with_role(summary: xr.Dataset, role: str) -> list[str]:
    """Names of the variables with a role: "parameter" or "result"."""
    return [str(n) for n, v in summary.variables.items() if v.attrs.get("role") == role]


def varying_parameters(summary: xr.Dataset) -> list[str]:
    """Independent parameters: not constant, not derived, not tied to an earlier one."""
    chosen: dict[str, np.ndarray] = {}
    for name in with_role(summary, "parameter"):
        rank = np.unique(summary[name].values, return_inverse=True)[1]
        is_free = rank.max(initial=0) > 0 and not summary[name].attrs.get("derived", 0)
        if is_free and not any(_follows(rank, other) for other in chosen.values()):
            chosen[name] = rank
    return list(chosen)


def _follows(rank: np.ndarray, other: np.ndarray) -> bool:
    """Whether one increases or decreases with the other in all cases."""
    return np.array_equal(rank, other) or np.array_equal(rank, other.max() - other)


def _most_varied(summary: xr.Dataset, varying: list[str]) -> list[str]:
    if not varying:
        raise SweepError("no parameter varies; a figure needs one")
    numeric = [name for name in varying if summary[name].dtype.kind in "if"]
    return [max(numeric or varying, key=lambda name: np.unique(summary[name].values).size)]


def _one_of(summary: xr.Dataset, role: str, name: str) -> xr.DataArray:
    known = with_role(summary, role)
    if name not in known:
        raise SweepError(f"the summary has no {role} '{name}'; it has {', '.join(known)}", USAGE)
    return summary[name]


def _along(axis: Axes, which: str, summary: xr.Dataset, name: str) -> np.ndarray:
    """Set up an axis for a parameter; return its values on that axis."""
    values = summary[name].values
    if values.dtype.kind not in "if":
        texts, numbers = np.unique(values.astype(str), return_inverse=True)
        axis.set(**{f"{which}label": name})
        getattr(axis, f"set_{which}ticks")(range(len(texts)), texts.tolist())
        return np.asarray(numbers, dtype=float)
    units = str(summary[name].attrs.get("units", ""))
    factor, shown = engineering(values, units)
    label = axis_label(name.replace("_", " "), shown)
    scale = "log" if _is_wide(values) else "linear"
    axis.set(**{f"{which}label": label, f"{which}scale": scale})
    return np.asarray(values * factor)


def _is_wide(values: np.ndarray) -> bool:
    """Whether a log axis is suitable: a wide range with most values near its lower end."""
    if values.size == 0 or values.min() <= 0.0 or values.max() <= WIDE * values.min():
        return False
    return bool(np.median(values) < 0.25 * values.max())


def _scaled(summary: xr.Dataset, result: xr.DataArray) -> tuple[np.ndarray, str]:
    """Values of the finished cases, NaN for the others, and the label."""
    values = np.where(summary["status"].values == DONE, result.values, np.nan)
    factor, shown = engineering(values, str(result.attrs.get("units", "1")))
    label = str(result.attrs.get("long_name") or str(result.name).replace("_", " "))
    wrapped = "\n".join(textwrap.wrap(label, WIDEST_LABEL))
    return values * factor, axis_label(wrapped, shown)


def _draw_lines(
    axis: Axes, summary: xr.Dataset, result: xr.DataArray, name: str, others: list[str]
) -> None:
    x = _along(axis, "x", summary, name)
    values, label = _scaled(summary, result)
    finite = np.isfinite(values)
    axis.set(ylabel=label, yscale="log" if _is_wide(values[finite]) else "linear")
    groups = _groups(summary, name, others)
    if groups is None:
        axis.plot(x[finite], values[finite], ".", color=LINES[0]["color"], markersize=4)
    for number, (text, members) in enumerate((groups or {}).items()):
        order = members[np.argsort(x[members], kind="stable")]
        style = line_style(number)
        dots: dict[str, Any] = {"marker": ".", "markersize": 6} if members.size <= 60 else {}
        # A gap in the line where a case failed.
        axis.plot(x[order], values[order], label=text or None, **style, **dots)
    edge = np.full(x.size, 0.03)
    _mark_unfinished(axis, summary, x, edge, transform=axis.get_xaxis_transform())
    axis.margins(y=0.08)


def _groups(summary: xr.Dataset, name: str, others: list[str]) -> dict[str, np.ndarray] | None:
    """Groups of cases that form a line, by label: they differ in `name` only. None for points."""
    n_cases = summary.sizes["case"]
    if not others:
        return {"": np.arange(n_cases)}
    which = summary[others].to_dataframe().groupby(others).ngroup().to_numpy()
    groups = [np.flatnonzero(which == number) for number in range(int(which.max()) + 1)]
    # The number of cases that differ in one parameter is limited by its number of values.
    if len(groups) > MOST_LINES or np.unique(summary[name]).size * len(groups) != n_cases:
        return None
    return {
        ", ".join(f"{other} = {_shown(summary[other], members[0])}" for other in others): members
        for members in groups
    }


def _shown(values: xr.DataArray, case: int) -> str:
    value = values.values[case]
    if not isinstance(value, float | np.floating | int | np.integer):
        return str(value)
    factor, unit = engineering(values.values, str(values.attrs.get("units", "1")))
    return f"{value * factor:.4g} {unit}".strip()


def _draw_map(
    axis: Axes,
    summary: xr.Dataset,
    result: xr.DataArray,
    first: str,
    second: str,
    others: list[str],
) -> None:
    x, y = _along(axis, "x", summary, first), _along(axis, "y", summary, second)
    values, label = _scaled(summary, result)
    columns, column = np.unique(x, return_inverse=True)
    rows, row = np.unique(y, return_inverse=True)
    if not others and columns.size * rows.size == values.size:
        cells = np.full((rows.size, columns.size), np.nan)
        cells[row, column] = values
        drawn: Any = axis.pcolormesh(columns, rows, cells, cmap=MAP_COLOURS, shading="nearest")
        axis.grid(visible=False)
    else:
        good = np.isfinite(values)
        drawn = axis.scatter(x[good], y[good], c=values[good], s=14, cmap=MAP_COLOURS, zorder=3)
    axis.figure.colorbar(drawn, ax=axis, label=label)
    _mark_unfinished(axis, summary, x, y)


def _mark_unfinished(
    axis: Axes, summary: xr.Dataset, x: np.ndarray, y: np.ndarray, **options: Any
) -> None:
    """Mark the cases that did not finish by crosses, and count them in the legend."""
    failed = did_not_finish(summary["status"].values)
    if failed.any():
        label = f"did not finish: {int(failed.sum())} of {failed.size}"
        axis.plot(x[failed], y[failed], label=label, **MARKED, **options)
