"""Figures of a summary: a result against one or two parameters, and Sobol indices.

Cases that did not finish are part of the answer and are shown: crosses at their parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import LINES, STYLE
from evolvent.sweep.errors import USAGE, SweepError
from evolvent.sweep.journal import DONE, did_not_finish
from evolvent.units import displayed, prefixed

MOST_LINES = 6  # of one figure; more cannot be told apart
WIDE = 50.0  # ratio of the ends of a positive range that is drawn on a log axis
BAD = "#b3202c"
MARKED: dict[str, Any] = {
    "linestyle": "none",
    "marker": "x",
    "color": BAD,
    "markersize": 6,
    "zorder": 4,
}
MAP_COLOURS = "viridis"


@dataclass(frozen=True)
class _Axis:
    """A parameter as numbers on an axis."""

    label: str
    values: np.ndarray
    texts: list[str]  # of the numbers 0, 1, ... if the parameter is a text
    log: bool

    def prepare(self, axis: Axes, which: str) -> None:
        getattr(axis, f"set_{which}label")(self.label)
        if self.texts:
            getattr(axis, f"set_{which}ticks")(range(len(self.texts)), self.texts)
        elif self.log:
            getattr(axis, f"set_{which}scale")("log")


def figure_response(summary: xr.Dataset, response: str, against: Sequence[str] = ()) -> Figure:
    """Draw a result against one parameter, as lines or points, or against two, as a map.

    Parameters
    ----------
    summary : as from `open_summary`.
    response : name of a result.
    against : one or two parameters; the one of most values if none is named.
    """
    result = _result(summary, response)
    varying = varying_parameters(summary)
    names = list(against) or _most_varied(summary, varying)
    for name in names:
        if name not in parameters(summary):
            raise SweepError(
                f"the summary has no parameter '{name}'; it has {', '.join(parameters(summary))}",
                USAGE,
            )
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 4.6), layout="constrained")
        axis = figure.subplots()
        if len(names) == 1:
            _draw_lines(axis, summary, result, names[0], [v for v in varying if v != names[0]])
        elif len(names) == 2:
            others = [v for v in varying if v not in names]
            _draw_map(figure, axis, summary, result, names[0], names[1], others)
        else:
            raise SweepError("a figure shows a result against one or two parameters", USAGE)
        handles, labels = axis.get_legend_handles_labels()
        if labels:
            above: Any = "outside upper left"
            figure.legend(handles, labels, loc=above, ncols=3, columnspacing=1.4)
    return figure


def figure_indices(indices: xr.Dataset) -> Figure:
    """Draw sensitivity indices with their confidence intervals, dims (parameter)."""
    names = [str(name) for name in indices["parameter"].values]
    kinds = [kind for kind in ("first_order", "total") if kind in indices]
    colours = {"first_order": LINES[0]["color"], "total": LINES[2]["color"]}
    labels = {"first_order": "first order", "total": "total"}
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
                color=colours[kind],
                error_kw={"ecolor": "#555555", "capsize": 3},
                label=labels[kind],
            )
        axis.set_yticks(range(len(names)), names)
        axis.set_axisbelow(True)
        axis.invert_yaxis()
        axis.set_xlabel(f"share of the variance of {indices.attrs['response']}")
        axis.set_xlim(left=min(0.0, axis.get_xlim()[0]))
        above: Any = "outside upper left"
        figure.legend(loc=above, ncols=2)
    return figure


def parameters(summary: xr.Dataset) -> list[str]:
    """Names of the parameters."""
    return [str(n) for n, v in summary.variables.items() if v.attrs.get("role") == "parameter"]


def results(summary: xr.Dataset) -> list[str]:
    """Names of the results."""
    return [str(n) for n, v in summary.variables.items() if v.attrs.get("role") == "result"]


def varying_parameters(summary: xr.Dataset) -> list[str]:
    """Parameters that were chosen freely: not constant, not derived, not tied to one before."""
    chosen: list[str] = []
    ranks: list[np.ndarray] = []
    for name in parameters(summary):
        if summary[name].attrs.get("derived", 0):
            continue
        rank = np.unique(summary[name].values, return_inverse=True)[1]
        if rank.max(initial=0) == 0 or any(_follows(rank, other) for other in ranks):
            continue
        chosen.append(name)
        ranks.append(rank)
    return chosen


def _follows(rank: np.ndarray, other: np.ndarray) -> bool:
    """Whether one rises or falls with the other through all cases."""
    return np.array_equal(rank, other) or np.array_equal(rank, other.max() - other)


def _most_varied(summary: xr.Dataset, varying: list[str]) -> list[str]:
    if not varying:
        raise SweepError("no parameter varies; there is nothing to draw against")
    numeric = [name for name in varying if summary[name].dtype.kind in "if"]
    return [max(numeric or varying, key=lambda name: np.unique(summary[name].values).size)]


def _result(summary: xr.Dataset, name: str) -> xr.DataArray:
    if name not in results(summary):
        raise SweepError(
            f"the summary has no result '{name}'; it has {', '.join(results(summary))}", USAGE
        )
    return summary[name]


def _axis(summary: xr.Dataset, name: str) -> _Axis:
    values = summary[name].values
    if values.dtype.kind not in "if":
        texts, numbers = np.unique(values.astype(str), return_inverse=True)
        return _Axis(name, numbers.astype(float), [str(text) for text in texts], False)
    units = str(summary[name].attrs.get("units", ""))
    factor, shown = prefixed(float(np.abs(values).max(initial=0.0)), units)
    label = name.replace("_", " ") + (f" [{shown}]" if shown else "")
    return _Axis(label, values * factor, [], _is_wide(values))


def _is_wide(values: np.ndarray) -> bool:
    """Whether values want a log axis: a wide range, most of it near its lower end."""
    if values.size == 0 or values.min() <= 0.0 or values.max() <= WIDE * values.min():
        return False
    return bool(np.median(values) < 0.25 * values.max())


def _scaled(summary: xr.Dataset, result: xr.DataArray) -> tuple[np.ndarray, str]:
    """Values of the cases that are done, NaN for the others, and the label."""
    values = np.where(summary["status"].values == DONE, result.values, np.nan)
    finite = np.abs(values[np.isfinite(values)])
    factor, shown = prefixed(float(finite.max(initial=0.0)), str(result.attrs.get("units", "1")))
    label = str(result.attrs.get("long_name") or str(result.name).replace("_", " "))
    return values * factor, f"{label} [{shown}]" if shown else label


def _draw_lines(
    axis: Axes, summary: xr.Dataset, result: xr.DataArray, name: str, others: list[str]
) -> None:
    x = _axis(summary, name)
    values, label = _scaled(summary, result)
    x.prepare(axis, "x")
    axis.set_ylabel(label)
    if _is_wide(values[np.isfinite(values)]):
        axis.set_yscale("log")
    for number, (text, members) in enumerate(_groups(summary, name, others)):
        order = members[np.argsort(x.values[members], kind="stable")]
        kept = order[np.isfinite(values[order])]
        if text is None:
            axis.plot(x.values[kept], values[kept], ".", color=LINES[0]["color"], markersize=4)
        else:
            style: dict[str, Any] = LINES[number % len(LINES)]
            dots: dict[str, Any] = {"marker": ".", "markersize": 6} if members.size <= 60 else {}
            # A gap in the line where a case failed.
            shown = values[order]
            axis.plot(x.values[order], shown, label=text or None, **style, **dots)
    failed = did_not_finish(summary["status"].values)
    if failed.any():
        axis.plot(
            x.values[failed],
            np.full(int(failed.sum()), 0.03),
            transform=axis.get_xaxis_transform(),
            label=_counted(failed, "did not finish"),
            **MARKED,
        )
    axis.margins(y=0.08)


def _groups(
    summary: xr.Dataset, name: str, others: list[str]
) -> list[tuple[str | None, np.ndarray]]:
    """Cases that make a line: those that differ in `name` only. A text of None makes points."""
    everything = np.arange(summary.sizes["case"])
    if not others:
        return [("", everything)]
    # Only as many cases can differ in one parameter as it has values.
    size = np.unique(summary[name].values).size
    combinations = np.stack(
        [np.unique(summary[o].values, return_inverse=True)[1] for o in others], axis=1
    )
    distinct, which = np.unique(combinations, axis=0, return_inverse=True)
    which = which.reshape(-1)
    if len(distinct) > MOST_LINES or size * len(distinct) != everything.size:
        return [(None, everything)]
    groups: list[tuple[str | None, np.ndarray]] = []
    for number in range(len(distinct)):
        members = np.flatnonzero(which == number)
        text = ", ".join(f"{o} = {_shown(summary, o, members[0])}" for o in others)
        groups.append((text, members))
    return groups


def _shown(summary: xr.Dataset, name: str, case: int) -> str:
    value = summary[name].values[case]
    if not isinstance(value, float | np.floating | int | np.integer):
        return str(value)
    units = displayed(str(summary[name].attrs.get("units", "1")))
    return f"{value:.4g} {units}".strip()


def _draw_map(
    figure: Figure,
    axis: Axes,
    summary: xr.Dataset,
    result: xr.DataArray,
    first: str,
    second: str,
    others: list[str],
) -> None:
    x, y = _axis(summary, first), _axis(summary, second)
    values, label = _scaled(summary, result)
    x.prepare(axis, "x")
    y.prepare(axis, "y")
    columns, column = np.unique(x.values, return_inverse=True)
    rows, row = np.unique(y.values, return_inverse=True)
    if not others and columns.size * rows.size == values.size:
        cells = np.full((rows.size, columns.size), np.nan)
        cells[row, column] = values
        drawn: Any = axis.pcolormesh(columns, rows, cells, cmap=MAP_COLOURS, shading="nearest")
        axis.grid(visible=False)
    else:
        good = np.isfinite(values)
        drawn = axis.scatter(
            x.values[good], y.values[good], c=values[good], s=14, cmap=MAP_COLOURS, zorder=3
        )
    figure.colorbar(drawn, ax=axis, label=label)
    failed = did_not_finish(summary["status"].values)
    if failed.any():
        axis.plot(
            x.values[failed], y.values[failed], label=_counted(failed, "did not finish"), **MARKED
        )


def _counted(chosen: np.ndarray, word: str) -> str:
    return f"{word}: {int(chosen.sum())} of {chosen.size}"
