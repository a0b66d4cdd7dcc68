"""Zoomable figures of all quantities of a history, in one page that works offline.

The values are embedded as compressed binary arrays, thinned out to the size limit: the minimum and
maximum of each interval of a line are retained with their times. plotly.js draws them; it is part
of the Python package plotly and is embedded compressed as well.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
import xarray as xr
from markupsafe import Markup
from numpy.typing import NDArray

from evolvent.errors import needing
from evolvent.figures.style import LINES
from evolvent.history.recording import at_rows, ever, recording_of
from evolvent.physics.extremes import recorded_extremes
from evolvent.physics.thinning import thinned, thinned_lines
from evolvent.units import engineering

MOST_ROWS = 12_000  # of a line: a wide screen has 4000 pixels, and figures are zoomed
LARGEST = 3_300_000  # characters of the values; a page then is below 6 MB
FAVOUR = 4  # ratio of the rows of initially displayed lines to those of other lines
MOST_EVENTS = 2000  # of one type
FIRST = ("transmission_error", "pair_normal_force", "pair_contact_pressure", "angular_velocity")
GROUPS = {"pair": "Tooth pairs", "mesh": "Meshes", "wheel": "Wheels"}


@dataclass(frozen=True)
class Line:
    """One line of a figure."""

    label: str
    rows: NDArray[np.int64]  # of the history
    values: NDArray[np.float64]  # at these rows, in SI


@dataclass(frozen=True)
class Quantity:
    """One figure."""

    name: str
    text: str
    units: str
    group: str
    lines: list[Line]
    extremes: list[tuple[float, float, str]] = field(default_factory=list)  # time [s], value, where


@dataclass(frozen=True)
class Explorer:
    """Contents of the page."""

    facts: Markup  # JSON
    numbers: str  # compressed, in base 64
    library: str  # plotly.js, compressed, in base 64
    library_name: str
    groups: dict[str, list[tuple[str, str, bool]]]  # name, text, whether it is displayed initially
    note: str
    window: str  # time range displayed initially; "" if all


def explorer(
    history: xr.Dataset, events: xr.Dataset, window: tuple[float, float] | None = None
) -> Explorer:
    """Collect the figures of a history that has outputs.

    Parameters
    ----------
    history, events : as from `open_history` and `open_events`.
    window : time range displayed initially [s]; all if None.

    Raises
    ------
    EvolventError
        The Python package plotly is not installed.
    """
    library, name = _library()
    outputs = history.sizes["time"]
    quantities = list(_quantities(history))
    first = _first(quantities)
    most = MOST_ROWS
    packed = _packed(history, quantities)
    while len(packed[1]) > LARGEST:
        most = max(8, int(0.95 * most * min(LARGEST / len(packed[1]), 1)))
        quantities = [
            _thinner(q, min(MOST_ROWS, most * (FAVOUR if q.name in first else 1)))
            for q in quantities
        ]
        packed = _packed(history, quantities)
    facts, numbers = packed
    whole = history["time"].values[[0, -1]]
    time_factor, time_unit = engineering(whole, "s")
    facts |= {
        "time_unit": time_unit,
        "whole": (whole * time_factor).tolist(),
        "window": None if window is None else [t * time_factor for t in window],
        "first": first,
        "events": _events(history, events, time_factor),
        "styles": [_style(line) for line in LINES],
    }
    groups: dict[str, list[tuple[str, str, bool]]] = {}
    for q in quantities:
        groups.setdefault(q.group, []).append((q.name, q.text, q.name in first))
    sizes = [line.rows.size for q in quantities for line in q.lines if line.rows.size > 2]
    note = f"All {outputs:,} outputs are in the page."
    if min(sizes, default=outputs) < outputs:
        note = (
            f"The lines show {min(sizes):,} to {max(sizes):,} of {outputs:,} outputs: the smallest "
            "and the largest of each interval, without loss of extremes."
        )
    if history.sizes.get("pair", 1) > 1:
        note += " Tooth pairs use the slots drive 0, drive 1 and so on in turn."
    shown = "" if window is None else f"{window[0]:.6g} to {window[1]:.6g} s"
    return Explorer(_json(facts), numbers, library, name, groups, note, shown)


def _quantities(history: xr.Dataset) -> Iterator[Quantity]:
    """Variables over time that are not 0 throughout."""
    for name in map(str, history.data_vars):
        variable = history[name]
        if variable.dims[:1] != ("time",) or variable.dtype.kind not in "iuf":
            continue
        found = list(_lines(history, variable))
        if not any(np.nan_to_num(line.values).any() for line in found):
            continue
        dims = variable.dims[1:]
        other = str(dims[0]).capitalize() + "s" if dims else "Gearbox"
        group = next((text for dim, text in GROUPS.items() if dim in dims), other)
        text = str(variable.attrs.get("long_name", name)).split(";")[0]
        if text[0].isdigit():  # meanings of its values
            text = f"{name.replace('_', ' ')}: {text}"
        begin, end = history["time"].values[[0, -1]]
        marked = [
            (float(e.time[mesh]), float(e.value[mesh]), str(where))
            for e in recorded_extremes(history)
            if e.output == name
            for mesh, where in enumerate(history["mesh"].values)
            if np.isfinite(float(e.value[mesh])) and begin <= float(e.time[mesh]) <= end
        ]
        yield Quantity(name, text, str(variable.attrs.get("units", "1")), group, found, marked)


def _lines(history: xr.Dataset, variable: xr.DataArray) -> Iterator[Line]:
    """Lines of a variable; tooth pairs that never have a value are omitted."""
    run, name = recording_of(history), str(variable.name)
    dims = [str(dim) for dim in variable.dims[1:]]
    has_value = ever(run, lambda part: np.isfinite(part[name])).ravel()
    if "pair" in dims:
        has_value &= ever(run, lambda part: (part[name] != 0) & ~np.isnan(part[name])).ravel()
    is_level = ~ever(run, lambda part: ~(part[name] == run.read(name, 0, 1))).ravel()
    rows = thinned_lines(run, name, MOST_ROWS)
    rows = [_ends(run.n) if level else each for each, level in zip(rows, is_level, strict=True)]
    indices = np.ndindex(variable.shape[1:])
    for number, (index, values) in enumerate(zip(indices, at_rows(run, name, rows), strict=True)):
        if not has_value[number]:
            continue
        selected = list(zip(dims, index, strict=True))
        # Dimensions of length 1 are omitted from the label, unless all have length 1.
        named = [(d, i) for d, i in selected if history.sizes[d] > 1] or selected
        names = [str(history[d].values[i]).replace("_", " ") for d, i in named]
        yield Line(" ".join(names) or "value", rows[number], values.astype(float))


def _ends(n: int) -> NDArray[np.int64]:
    return np.unique([0, n - 1])


def _thinner(quantity: Quantity, most: int) -> Quantity:
    lines = []
    for line in quantity.lines:
        retained = thinned(line.values, most)
        lines.append(Line(line.label, line.rows[retained], line.values[retained]))
    return Quantity(
        quantity.name, quantity.text, quantity.units, quantity.group, lines, quantity.extremes
    )


def _packed(history: xr.Dataset, quantities: list[Quantity]) -> tuple[dict[str, Any], str]:
    """Pack all values into one byte array; return its description and the array.

    Order: times as doubles; then for each line its rows among these times, as differences, and its
    values as floats.
    """
    used = np.unique(np.concatenate([line.rows for q in quantities for line in q.lines]))
    time_factor, _ = engineering(history["time"].values[[0, -1]], "s")
    pieces = [(history["time"].values[used] * time_factor).astype("<f8").tobytes()]
    facts: dict[str, Any] = {"times": used.size, "quantities": []}
    for q in quantities:
        tops = [v for _, v, _ in q.extremes]
        factor, unit = engineering(
            np.concatenate([tops, *(line.values for line in q.lines)]), q.units
        )
        lines = []
        for line in q.lines:
            selected = np.searchsorted(used, line.rows)
            pieces.append(np.diff(selected, prepend=0).astype("<u4").tobytes())
            pieces.append((line.values * factor).astype("<f4").tobytes())
            lines.append({"label": line.label, "size": int(line.rows.size)})
        marks = [[t * time_factor, v * factor, where] for t, v, where in q.extremes]
        facts["quantities"].append(
            {"name": q.name, "text": q.text, "unit": unit, "lines": lines, "extremes": marks}
        )
    return facts, _compressed(b"".join(pieces))


def _first(quantities: list[Quantity]) -> list[str]:
    """Names displayed initially; the mesh force if there is at most one line of pair forces."""
    names = {q.name: len(q.lines) for q in quantities}
    preferred = list(FIRST)
    if names.get("pair_normal_force", 0) < 2:
        preferred[1] = "normal_force"
    return [name for name in preferred if name in names] or list(names)[:1]


def _events(history: xr.Dataset, events: xr.Dataset, factor: float) -> list[dict[str, Any]]:
    """Times of the events of each type; of very many only some."""
    shown = []
    kinds = events["kind"].values
    begin, end = history["time"].values[[0, -1]]
    inside = (events["time"].values >= begin) & (events["time"].values <= end)
    for kind in dict.fromkeys(kinds):
        times = events["time"].values[(kinds == kind) & inside] * factor
        if times.size == 0:
            continue
        step = -(-times.size // MOST_EVENTS)
        text = str(kind).replace("_", " ") + (f" (one of {step})" if step > 1 else "")
        shown.append({"label": text, "times": times[::step].tolist()})
    return shown


def _style(line: dict[str, Any]) -> dict[str, str]:
    """Colour and dashes of a figure's line in the notation of plotly."""
    dashes = line["linestyle"]
    if dashes == "-":
        return {"color": line["color"], "dash": "solid"}
    return {"color": line["color"], "dash": ",".join(f"{1.6 * d:.3g}px" for d in dashes[1])}


def _json(facts: dict[str, Any]) -> Markup:
    """JSON that cannot terminate the HTML element that contains it."""
    return Markup(json.dumps(facts, allow_nan=False).replace("<", "\\u003c"))


@cache
def _library() -> tuple[str, str]:
    with needing("interactive", "interactive pictures need plotly"):
        from plotly.offline import get_plotlyjs, get_plotlyjs_version
    return _compressed(get_plotlyjs().encode()), f"plotly.js {get_plotlyjs_version()}"


def _compressed(content: bytes) -> str:
    """Compress without a date, and encode in base 64 for HTML."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode("ascii")
