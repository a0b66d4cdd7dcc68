"""How every figure looks, and how it is written."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

# Told apart by lightness and by dashes, so that they survive a grey printer.
LINES: tuple[dict[str, Any], ...] = (
    {"color": "#10243e", "linestyle": "-"},
    {"color": "#d1681c", "linestyle": (0, (5, 2))},
    {"color": "#3f8fc4", "linestyle": (0, (1.2, 1.2))},
    {"color": "#7a9a2b", "linestyle": (0, (6, 1.5, 1.2, 1.5))},
    {"color": "#b78bc0", "linestyle": (0, (3, 1, 1, 1, 1, 1))},
)
STYLE: dict[Any, Any] = {
    "font.size": 12,
    "axes.labelsize": 12,
    "legend.fontsize": 11,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.3,
    "legend.frameon": False,
    "svg.hashsalt": "evolvent",  # the same figure gives the same file
}
# matplotlib's type hints do not know these places.
ABOVE: Any = "outside upper left"
BELOW: Any = "outside lower left"
MAX_MARKS = 40  # of one kind of event; more would run into each other and hide the curves


class Format(StrEnum):
    """Formats of a figure."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the file's ending; the same data give the same bytes."""
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with rc_context(STYLE):
        figure.savefig(path, dpi=150, metadata=undated.get(path.suffix.lstrip(".").lower()))
