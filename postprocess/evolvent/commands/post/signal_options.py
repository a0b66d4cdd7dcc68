"""Options, selection of a record and output files common to the commands for spectra."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import WrongUsageError, option
from evolvent.commands.post.common import open_with_warning
from evolvent.errors import USAGE, EvolventError, replacing
from evolvent.figures.formats import Format
from evolvent.history import HISTORY
from evolvent.signals.window_names import WINDOWS

if TYPE_CHECKING:
    import xarray as xr

Window = StrEnum("Window", list(WINDOWS))  # type: ignore[misc]  # its members are a table
DATA = "h5"
RPM = 30.0 / math.pi  # rev/min per rad/s

OptionQuantity = Annotated[str, option("--quantity NAME", "Variable of the history.")]
OptionMesh = Annotated[
    str | None, option("--mesh NAME", "Mesh of the variable, if there are several.")
]
OptionWheel = Annotated[str | None, option("--wheel NAME", "Wheel of the variable.")]
OptionPair = Annotated[
    str | None, option("--pair NAME", "Tooth pair slot of the variable, such as drive_0.")
]
OptionAxis = Annotated[str | None, option("--axis NAME", "Axis of the variable: x, y, z.")]
OptionSelect = Annotated[
    list[str] | None,
    option(
        "--select DIM=NAME", "Value of any other dimension, such as shaft=input; may be repeated."
    ),
]
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "µs": 1e-6, "min": 60.0}


def seconds(text: str | float) -> float:
    """Parse a time [s]: "0.025", "25 ms"; axes of short runs are in ms."""
    match = re.fullmatch(r"\s*(\S*?[0-9.])\s*([^\W\d]*)\s*", str(text))
    try:
        return float(match[1]) * TIMES[match[2] or "s"] if match else float(text)
    except (KeyError, ValueError):
        raise WrongUsageError(
            f"{text} is not a time, such as 0.025 or 25ms; units are {', '.join(TIMES)}"
        ) from None


OptionFrom = Annotated[
    float,
    option(
        "--from TIME",
        "Start time, in s or with a unit such as 25ms; if not given, the start of the history.",
        show_default=False, parser=seconds,
    ),
]  # fmt: skip
OptionTo = Annotated[
    float,
    option(
        "--to TIME",
        "End time, in s or with a unit such as 25ms; if not given, the end of the history.",
        show_default=False, parser=seconds,
    ),
]  # fmt: skip
OptionWindow = Annotated[
    Window | None,
    option(
        "--window", "Window function; if not given, rectangular over whole periods, otherwise hann."
    ),
]
OptionOutput = Annotated[
    list[Path] | None,
    option(
        "-o --output FILE",
        "Data file (.h5) or figure (.png, .svg, .pdf); may be repeated.",
    ),
]
WHOLE_TIME = (-math.inf, math.inf)


@dataclass(frozen=True, kw_only=True)
class Times:
    """Part of a history."""

    begin: OptionFrom = WHOLE_TIME[0]
    end: OptionTo = WHOLE_TIME[1]


@dataclass(frozen=True, kw_only=True)
class Columns:
    """Names by dimension, except that of a mesh."""

    wheel: OptionWheel = None
    pair: OptionPair = None
    axis: OptionAxis = None
    others: OptionSelect = None

    def chosen(self, mesh: str | None = None) -> dict[str, str]:
        """Collect the given names by dimension."""
        chosen = {"mesh": mesh, "wheel": self.wheel, "pair": self.pair, "axis": self.axis}
        chosen |= dict(dimension_and_name(text) for text in self.others or ())
        return {dim: name for dim, name in chosen.items() if name is not None}


@dataclass(frozen=True, kw_only=True)
class Signal:
    """One variable of a history over time."""

    name: OptionQuantity = "transmission_error"
    mesh: OptionMesh = None
    columns: Columns
    times: Times


def open_signal(
    path: Path, quantity: str, chosen: dict[str, str], times: Times
) -> tuple[xr.Dataset, xr.DataArray]:
    """Open a history between two times, and select one of its variables."""
    from evolvent.signals.sampling import between
    from evolvent.signals.selection import select

    history = open_with_warning(path, HISTORY)
    part = between(history, times.begin, times.end)
    return part, select(part, quantity, chosen)


def dimension_and_name(text: str) -> tuple[str, str]:
    """Split the value of --select."""
    dim, equals, name = text.partition("=")
    if not (dim and equals and name):
        raise WrongUsageError(f"{text} is not DIM=NAME", "--select")
    return dim, name


def check_outputs(outputs: Sequence[Path] | None, results: int, *more: str) -> None:
    """Reject unknown file types, and several results in one data file, before any computation.

    Parameters
    ----------
    more : further file extensions that the command writes.
    """
    endings = [DATA, *more, *Format]
    for path in outputs or ():
        ending = path.suffix.lstrip(".").lower()
        if ending not in endings:
            known = ", ".join(f".{known}" for known in endings[:-1])
            raise WrongUsageError(f"{path} must end in {known} or .{endings[-1]}", "--output")
        if ending == DATA and results > 1:
            raise EvolventError(
                f"{path}: holds one result, and there are {results} histories; write the numbers "
                "of each separately",
                USAGE,
            )


def write_outputs(
    outputs: Sequence[Path] | None, results: Sequence[tuple[str, xr.Dataset]], row: str,
    **options: Any,
) -> list[Path]:  # fmt: skip
    """Write the requested data files and figures.

    Parameters
    ----------
    results : labels and datasets.
    row : name of the figure in the table.
    options : options of the figure.

    Returns
    -------
    Paths of the written files.
    """
    for path in outputs or ():
        if path.suffix.lower() == f".{DATA}":
            with replacing(path) as temporary:
                results[0][1].to_netcdf(temporary, engine="h5netcdf")
            continue
        from evolvent.figures.style import save
        from evolvent.figures.table import FIGURES, Run

        figure = FIGURES[row](*(Run(result, label=label) for label, result in results), **options)
        with replacing(path) as temporary:
            save(figure, temporary)
    return list(outputs or ())
