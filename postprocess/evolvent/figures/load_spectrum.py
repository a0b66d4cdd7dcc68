"""Load spectra of wheels: numbers of cycles over their range."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from evolvent.figures.style import ABOVE, LINES, STYLE, legend, log_ticks
from evolvent.physics.load_spectrum import FACE_LOAD, PointSpectrum, WheelSpectrum
from evolvent.units import axis_label, engineering

CLASSES = 24
HATCHES = ("", "////", "....", "xxxx")


def draw_load_spectra(spectra: Sequence[WheelSpectrum]) -> Figure:
    """Draw histograms of the most loaded tooth of each wheel: root stress, and tooth force."""
    rows = [
        (what, unit, found)
        for what, unit, points in (
            ("range of the root stress", "Pa", [s.worst_root for s in spectra]),
            ("range of the tooth force", "N", [s.worst_force for s in spectra]),
        )
        if (found := [(s, p) for s, p in zip(spectra, points, strict=True) if p is not None])
    ]
    entries: dict[str, Any] = {}
    with rc_context({**STYLE, "hatch.linewidth": 0.8}):
        figure = Figure(figsize=(7.5, 3.3 * len(rows)), layout="constrained")
        for axis, (what, unit, found) in zip(
            figure.subplots(len(rows), squeeze=False)[:, 0], rows, strict=True
        ):
            _draw(axis, spectra, found, what, unit, entries)
        window = "cycles of the most loaded tooth in the last revolutions; " + FACE_LOAD
        legend(figure, entries, ABOVE, textwrap.fill(window, 80))
    return figure


def _draw(
    axis: Axes,
    spectra: Sequence[WheelSpectrum],
    found: list[tuple[WheelSpectrum, PointSpectrum]],
    what: str,
    unit: str,
    entries: dict[str, Any],
) -> None:
    """Draw histograms of several wheels side by side in common classes."""
    top = max(point.cycles.largest for _, point in found)
    factor, name = engineering(top, unit)
    limits = np.linspace(0.0, top * (1 + 1e-9), CLASSES + 1)
    width = (limits[1] - limits[0]) * factor / (len(found) + 0.25)
    most, least = 1.0, 1.0
    for position, (spectrum, point) in enumerate(found):
        counts, _ = np.histogram(point.cycles.ranges, limits, weights=point.cycles.counts)
        number = list(spectra).index(spectrum)
        left = limits[:-1] * factor + position * width
        turns = spectrum.window.turns
        label = f"{spectrum.wheel}, {turns:.4g} revolution{'s' if turns != 1 else ''}"
        entries[label] = axis.bar(
            left[counts > 0],
            counts[counts > 0],
            width,
            align="edge",
            facecolor=LINES[number % len(LINES)]["color"] if number % 2 == 0 else "white",
            edgecolor=LINES[number % len(LINES)]["color"],
            hatch=HATCHES[number % len(HATCHES)] or None,
            zorder=3,
        )
        most = max(most, float(counts.max()))
        least = min(least, float(counts[counts > 0].min()))
    axis.set_yscale("log")
    axis.set_ylim(0.3 * least, 3.0 * most)
    axis.set_xlim(0.0, 1.02 * top * factor)
    log_ticks(axis.yaxis)
    axis.grid(axis="x", visible=False)
    axis.set_xlabel(axis_label(what, name))
    axis.set_ylabel("number of cycles")
