"""Style of all figures, and their output files."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

# Distinguishable by colour, lightness and dashes, also in grey print.
LINES: tuple[dict[str, Any], ...] = (
    {"color": "#10243e", "linestyle": "-"},
    {"color": "#d1681c", "linestyle": (0, (5, 2))},
    {"color": "#3f8fc4", "linestyle": (0, (1.2, 1.2))},
    {"color": "#7a9a2b", "linestyle": (0, (6, 1.5, 1.2, 1.5))},
    {"color": "#b78bc0", "linestyle": (0, (3, 1, 1, 1, 1, 1))},
    {"color": "#8c1c3a", "linestyle": (0, (9, 3))},
    {"color": "#17806d", "linestyle": (0, (2.6, 1.4))},
    {"color": "#d0a41e", "linestyle": (0, (8, 1.4, 1.2, 1.4, 1.2, 1.4))},
)
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
MOST_STYLES = len(LINES) * (1 + len(MARKERS))
STYLE: dict[Any, Any] = {
    "font.size": 12,
    "axes.labelsize": 12,
    "axes.formatter.useoffset": False,
    "axes.formatter.use_mathtext": True,
    "legend.fontsize": 11,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "svg.hashsalt": "evolvent",  # the same figure gives the same file
}
# The type hints of matplotlib do not include these locations.
ABOVE: Any = "outside upper left"
BELOW: Any = "outside lower left"
MAX_MARKS = 40  # of one type of event; more would overlap and hide the curves
MOST_COLUMNS = 5  # of a legend
WIDEST = 60  # characters per line of a legend; longer labels are wrapped
FEW_DECADES = 1.7  # of a logarithmic axis: ticks at 2 and 5 as well
PART_OF_DECADE = 0.7  # of a decade: below it the ticks are linear
PLAIN = (1e-4, 1e5)  # tick values written without a power of ten


def line_style(number: int) -> dict[str, Any]:
    """Style of one of several curves; unique for indices below `MOST_STYLES`.

    The first styles differ in colours and dashes, the others also in markers.
    """
    turn, index = divmod(number, len(LINES))
    if turn == 0:
        return dict(LINES[index])
    marker = {"marker": MARKERS[(turn - 1) % len(MARKERS)], "markerfacecolor": "white"}
    # Markers of neighbouring lines are staggered.
    return {**LINES[index], **marker, "markersize": 5.5, "markevery": (index / 100.0, 0.1)}


def legend(
    figure: Figure, entries: Mapping[str, Any], position: Any = ABOVE, heading: str = ""
) -> None:
    """Add a legend outside the panels, with as many columns as fit into the width.

    Parameters
    ----------
    entries : handles by their labels.
    heading : contents of the figure, above the legend.
    """
    if not entries:
        if heading:
            figure.suptitle(heading, x=0.01, ha="left", fontsize=11)
        return
    renderer: Any = FigureCanvasAgg(figure).get_renderer()  # type: ignore[no-untyped-call]
    labels = [textwrap.fill(label, WIDEST) for label in entries]
    widest = 0.98 * figure.get_figwidth() * figure.dpi
    for columns in range(min(MOST_COLUMNS, len(labels)), 0, -1):
        made = figure.legend(
            list(entries.values()),
            labels,
            loc=position,
            ncols=columns,
            columnspacing=1.4,
            title=heading or None,
            title_fontsize=11,
            alignment="left",
        )
        if columns == 1 or made.get_window_extent(renderer).width <= widest:
            return
        made.remove()


def log_ticks(axis: Axis) -> None:
    """Set ticks with plain numbers on a logarithmic axis of any length; its limits are set."""
    low, high = sorted(axis.get_view_interval())
    decades = math.log10(high / low)
    axis.set_minor_formatter(NullFormatter())
    if decades <= PART_OF_DECADE:
        axis.set_major_locator(MaxNLocator(5))
        axis.set_minor_locator(NullLocator())
    else:
        subs = (1.0, 2.0, 5.0) if decades <= FEW_DECADES else (1.0,)
        axis.set_major_locator(LogLocator(subs=subs, numticks=12))
        axis.set_minor_locator(LogLocator(subs=range(2, 10), numticks=99))
    axis.set_major_formatter(FuncFormatter(lambda value, _: _log_number(value)))


def _log_number(value: float) -> str:
    if value <= 0.0:  # beyond the end of the axis
        return ""
    if PLAIN[0] <= value <= PLAIN[1]:
        return f"{value:.6g}"
    exponent = math.floor(math.log10(value) + 1e-9)
    front = value / 10.0**exponent
    power = f"10^{{{exponent}}}"
    return f"${power}$" if abs(front - 1.0) < 1e-9 else f"${front:.6g} \\times {power}$"


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the file extension; equal data give identical bytes."""
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with rc_context(STYLE):
        figure.savefig(path, dpi=150, metadata=undated.get(path.suffix.lstrip(".").lower()))
