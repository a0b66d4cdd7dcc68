"""Self-contained HTML page about one run."""

from __future__ import annotations

import base64
import io
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from jinja2 import Environment, PackageLoader
from matplotlib import rc_context
from matplotlib.figure import Figure

from evolvent.errors import USAGE, AnalysisError, HistoryError
from evolvent.figures.scheme import figure_mesh_scheme
from evolvent.figures.style import STYLE
from evolvent.figures.table import FIGURES, Run
from evolvent.history import run_warning, source_name
from evolvent.library.calls import datasheets_html
from evolvent.pages.explorer import explorer
from evolvent.pages.formulas import formula, symbol
from evolvent.physics.extremes import extremes, extremes_table, is_extreme
from evolvent.physics.invariants import Verdict, check_history
from evolvent.physics.mesh_summary import mesh_summaries
from evolvent.physics.metrics import is_number, metrics_tables, steady_window, window_text
from evolvent.physics.results import results
from evolvent.units import quantity

# Attributes of a history that are shown in their own sections of the page.
SHOWN_ATTRIBUTES = (
    "Conventions",
    "title",
    "evolvent_format",
    "case",
    "status",
    "status_message",
    "warnings",
)


@dataclass(frozen=True)
class Picture:
    """A figure, encoded for the page."""

    title: str
    alternative: str  # alternative text
    source: str  # data URI


def report(
    history: xr.Dataset,
    events: xr.Dataset,
    interactive: bool = False,
    times: tuple[float | None, float | None] = (None, None),
) -> str:
    """Create the page.

    Parameters
    ----------
    history, events : as from `open_history` and `open_events`.
    interactive : zoomable figures with values on hovering, instead of static figures.
    times : first and last time of the figures [s]; else the window of the metrics, if any.

    Returns
    -------
    HTML with embedded style and figures; it needs no other file and no network.

    Raises
    ------
    HistoryError
        There is no output between the times.
    """
    chosen = history.sel(time=slice(*times))
    if chosen.sizes["time"] == 0 and history.sizes["time"]:
        raise HistoryError(f"{source_name(history)}: has no output between --from and --to", USAGE)
    window = steady_window(history) if times == (None, None) else None
    environment = Environment(
        loader=PackageLoader("evolvent.pages"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"formula": formula, "symbol": symbol}
    attributes = {k: v for k, v in history.attrs.items() if k not in SHOWN_ATTRIBUTES}
    numbers = {k: v for k, v in attributes.items() if isinstance(v, int | float | np.number)}
    verdicts = check_history(history)
    sheets, no_sheet = _data_sheets(history)
    return environment.get_template("report.html.j2").render(
        title=str(history.attrs.get("title") or source_name(history)),
        file=source_name(history),
        warnings=_warnings(history),
        status=history.attrs.get("status", "unknown"),
        time=history["time"].values,
        results=results(history),
        names={dim: [str(v) for v in history[dim].values] for dim in ("wheel", "mesh")},
        verdict=_in_a_word(verdicts),
        applied=[v for v in verdicts if v.verdict != "not applicable"],
        not_applied=[v for v in verdicts if v.verdict == "not applicable"],
        explorer=explorer(chosen, events, window) if interactive and chosen.time.size else None,
        figures=[] if interactive else _figures(chosen, events, window),
        sheets=sheets,
        no_sheet=no_sheet,
        schemes=[] if sheets else [_scheme(history, mesh) for mesh in range(history.sizes["mesh"])],
        tables={dim: static_table(history, dim) for dim in ("wheel", "mesh")},
        meshes=mesh_summaries(history),
        extremes=extremes_table(history),
        extremes_note=_extremes_note(history, events),
        window=window_text(history),
        shown=window,
        numbers=[(names, rows) for names, rows in metrics_tables(history) if rows],
        events=event_counts(history, events),
        counts={
            k: f"{v:,}" if isinstance(v, int | np.integer) else f"{v:.6g}"
            for k, v in numbers.items()
        },
        versions={k: str(v) for k, v in attributes.items() if k not in numbers and str(v)},
        case=str(history.attrs.get("case", "")),
    )


def _in_a_word(verdicts: list[Verdict]) -> str:
    """Summary of the verdicts of all invariants."""
    failed = [v.invariant.name for v in verdicts if v.failed]
    if failed:
        return f"Do not use these results before the cause is found. Violated: {', '.join(failed)}."
    passed = sum(v.verdict == "pass" for v in verdicts)
    return f"All {passed} invariants that apply hold." if passed else "No invariant applies."


def static_table(history: xr.Dataset, dim: str) -> dict[str, list[Any]]:
    """Collect the quantities that are constant in time for each wheel or mesh.

    Parameters
    ----------
    history : as from `open_history`.
    dim : "wheel" or "mesh".

    Returns
    -------
    `columns`, the names along `dim`, and `rows`: (long name, symbol, one text per column), without
    quantities that are 0 or unknown for all of them.
    """
    rows = []
    for name, variable in history.data_vars.items():
        if variable.dims not in ((dim,), (dim, "axis")) or is_extreme(str(name)):
            continue
        if is_number(str(name)):
            continue
        units = str(variable.attrs.get("units", "1"))
        names = _names(history, str(name))
        if not names and not np.nan_to_num(variable.values).any():
            continue
        texts = [names[int(v)] if names else _text(v, units) for v in variable.values]
        label = str(name).replace("_", " ") if names else str(variable.attrs.get("long_name", name))
        rows.append((label, str(variable.attrs.get("symbol", "")), texts))
    return {"columns": [str(v) for v in history[dim].values], "rows": rows}


def event_counts(history: xr.Dataset, events: xr.Dataset) -> list[tuple[str, str, int]]:
    """Count the events of each type and mesh: (type in words, name of the mesh or "", number)."""
    names = [str(v) for v in history["mesh"].values]
    counted = Counter(
        (str(kind).replace("_", " "), names[mesh] if mesh >= 0 else "")
        for kind, mesh in zip(events["kind"].values, events["mesh"].values, strict=True)
    )
    return [(kind, mesh, number) for (kind, mesh), number in counted.items()]


def _data_sheets(history: xr.Dataset) -> tuple[list[tuple[str, str]], str]:
    """Names of the meshes with their data sheets in HTML, or why there are none."""
    text = str(history.attrs.get("case", ""))
    if "\n" not in text:
        return [], "the history has no case"
    meshes = [str(name) for name in history["mesh"].values]
    try:
        sheets = datasheets_html(text, f"of {source_name(history)}", meshes)
    except AnalysisError as error:
        return [], str(error).removeprefix("evolvent: ")
    return list(zip(meshes, sheets, strict=True)), ""


def _warnings(history: xr.Dataset) -> list[str]:
    """Warning about the end of the run, if any, and the warnings of its start."""
    end = run_warning(history)
    start = str(history.attrs.get("warnings", "")).splitlines()
    return ([end] if end else []) + start


def _extremes_note(history: xr.Dataset, events: xr.Dataset) -> str:
    """Source of the extremes, and contacts that have none."""
    has_recorded = any(extreme.between_outputs for extreme in extremes(history))
    note = (
        "Extremes include states between the outputs and on both sides of every event."
        if has_recorded
        else "Extremes of the outputs; states between two outputs are not included."
    )
    if "impact" in events["kind"].values:
        note += (
            " An impact of a rigid contact is an impulse without finite force; the normal force "
            "is that between impacts."
        )
    return note


def _names(history: xr.Dataset, variable: str) -> list[str]:
    """Meanings of the values of a variable; empty if they are plain numbers."""
    if variable == "tracking":
        return ["closed form", "algebraic", "differential"]
    if variable in ("driving_wheel", "driven_wheel"):
        return [str(v) for v in history["wheel"].values]
    return []


def _text(values: Any, units: str) -> str:
    if np.ndim(values) == 0 and np.asarray(values).dtype.kind in "iu":
        return str(int(values))
    return ", ".join(quantity(float(v), units) for v in np.atleast_1d(values))


def _scheme(history: xr.Dataset, mesh: int) -> Picture:
    name = str(history["mesh"].values[mesh])
    return _picture(
        f"Mesh {name}",
        "base, pitch and tip circles, line of action and the two flanks in contact, to scale",
        figure_mesh_scheme(history, mesh),
    )


def _figures(
    history: xr.Dataset, events: xr.Dataset, window: tuple[float, float] | None
) -> list[Picture]:
    if history.sizes["time"] == 0:
        return []
    part = history if window is None else history.sel(time=slice(*window))
    return [
        _picture(row.title, row.text, row(Run(part, events)))
        for row in FIGURES.values()
        if row.title and row.fits(Run(part)) and all(name in history for name in row.needs)
    ]


def _picture(title: str, alternative: str, figure: Figure) -> Picture:
    # As a separate image, each SVG has its own namespace of identifiers.
    buffer = io.BytesIO()
    with rc_context(STYLE):
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    encoded = base64.b64encode(buffer.getvalue()).decode("ascii")
    return Picture(title, alternative, f"data:image/svg+xml;base64,{encoded}")
