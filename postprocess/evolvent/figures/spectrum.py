"""Spectra of several histories in one figure."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.errors import USAGE, HistoryError
from evolvent.figures.style import ABOVE, MARKERS, STYLE, legend, line_style, log_ticks
from evolvent.units import axis_label, engineering

FEW = 60  # maximum number of lines drawn as stems; more are a curve
MARKED = 12  # peaks of a curve
DEPTH = 1e-4  # of the largest line: smaller lines are not shown
HEIGHT = 1e-3  # of the largest line: the axis ends at the last line above it


def draw_spectra(spectra: Sequence[tuple[str, xr.Dataset]]) -> Figure:
    """Draw amplitudes over frequency or order, on a logarithmic scale.

    Parameters
    ----------
    spectra : names and spectra, all over the same variable.
    """
    over = _common_axis([spectrum for _, spectrum in spectra])
    first = spectra[0][1]
    tops = [float(spectrum["amplitude"][1:].max()) for _, spectrum in spectra]
    factor, unit = engineering(tops, str(first["amplitude"].attrs["units"]))
    top = max(max(tops), np.finfo(float).tiny)
    last = max(_last_shown(spectrum, over, HEIGHT * top) for _, spectrum in spectra)
    scale, hertz = engineering(last, "Hz") if over == "frequency" else (1.0, "")
    with rc_context(STYLE):
        figure = Figure(figsize=(7.5, 4.4), layout="constrained")
        axis = figure.subplots()
        for number, (label, spectrum) in enumerate(spectra):
            shown = spectrum.isel({over: slice(1, None)})
            shown = shown.isel({over: np.flatnonzero(shown[over] <= last * 1.0001)})
            shown = shown.assign_coords({over: shown[over] * scale})
            _draw(axis, shown, over, factor, number, len(spectra), label, DEPTH * top * factor)
        axis.set_yscale("log")
        axis.set_ylim(DEPTH * top * factor, 2.0 * top * factor)
        axis.set_xlim(0.0, 1.03 * last * scale)
        log_ticks(axis.yaxis)
        axis.set_xlabel(
            axis_label("frequency", hertz) if hertz else str(first[over].attrs["long_name"])
        )
        axis.set_ylabel(axis_label("amplitude", unit))
        handles, labels = axis.get_legend_handles_labels()
        names = dict(zip(labels, handles, strict=True)) if len(spectra) > 1 else {}
        legend(figure, names, ABOVE, textwrap.fill(described(first), 80))
    return figure


def described(result: xr.Dataset) -> str:
    """Description of the signal, for the heading of a figure."""
    name = str(result.attrs.get("quantity_long_name", "")).split(",")[0]
    return ", ".join(filter(None, [name, str(result.attrs.get("place", ""))]))


def _common_axis(spectra: list[xr.Dataset]) -> str:
    """Common axis of the spectra; reject spectra of different quantities or axes."""
    for attribute, what in (("order_of", "orders"), ("quantity", "quantities")):
        kinds = sorted({str(s.attrs.get(attribute)) or "frequency" for s in spectra})
        if len(kinds) > 1:
            raise HistoryError(
                f"spectra of different {what} cannot share a figure: {', '.join(kinds)}; draw "
                "each separately",
                USAGE,
            )
    return str(spectra[0]["amplitude"].dims[0])


def _last_shown(spectrum: xr.Dataset, over: str, least: float) -> float:
    high = np.flatnonzero(spectrum["amplitude"].values[1:] >= least)
    return float(spectrum[over][1 + int(high[-1]) if high.size else -1])


def _draw(
    axis: Axes, shown: xr.Dataset, over: str, factor: float, number: int, many: int, label: str,
    lower_limit: float,
) -> None:  # fmt: skip
    abscissa, amplitude = shown[over].values, shown["amplitude"].values * factor
    style = line_style(number)
    dot: dict[str, Any] = {
        "marker": MARKERS[number % len(MARKERS)],
        "markersize": 5.5,
        "markerfacecolor": style["color"] if number % 2 == 0 else "white",
        "markeredgecolor": style["color"],
        "linestyle": "none",
        "zorder": 3,
        "clip_on": False,
    }
    if abscissa.size <= FEW:
        apart = 0.22 * (abscissa[1] - abscissa[0] if abscissa.size > 1 else 1.0)
        beside = abscissa + apart * (number - (many - 1) / 2)
        axis.vlines(
            beside, lower_limit, amplitude, color=style["color"], linestyle=style["linestyle"]
        )
        high = amplitude > lower_limit
        axis.plot(beside[high], amplitude[high], label=label, **dot)
        return
    axis.plot(
        abscissa, np.maximum(amplitude, lower_limit / 10), linewidth=0.8, color=style["color"]
    )
    tops = np.flatnonzero((amplitude[1:-1] > amplitude[:-2]) & (amplitude[1:-1] >= amplitude[2:]))
    tops = tops[
        amplitude[1:-1][tops] > lower_limit
    ]  # marks below the floor would lie outside the panel
    tops = 1 + tops[np.argsort(-amplitude[1:-1][tops], kind="stable")][:MARKED]
    axis.plot(abscissa[tops], amplitude[tops], label=label, **dot)
