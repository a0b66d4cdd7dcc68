"""Table of the figures and variables that evolvent-post plot can draw."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from evolvent.commands.post.common import open_with_warning
from evolvent.commands.program import new_console
from evolvent.history import DRAWN, HISTORY, result_kind
from evolvent.units import displayed

if TYPE_CHECKING:
    from rich.table import Table

    from evolvent.figures.table import Run

WIDE = 240  # characters per line of a list that a script reads


def print_list(files: Sequence[Path]) -> None:
    """Print the table of the figures, and of all variables of the files."""
    from evolvent.figures.table import Run

    with ExitStack() as opened:
        results = (open_with_warning(file, HISTORY, *DRAWN) for file in files)
        runs = [Run(opened.enter_context(result)) for result in results]
        console = new_console()
        if not console.is_terminal:
            console.width = WIDE
        console.print(_figures(runs))
        for file, run in zip(files, runs, strict=True):
            if result_kind(run.history) == HISTORY:
                console.print(f"\n{file}: variables over time", highlight=False, markup=False)
                console.print(_variables(run))


def _figures(runs: Sequence[Run]) -> Table:
    """Table of the figures that fit any of the runs, or of all without runs."""
    from rich.table import Table

    from evolvent.figures.table import FIGURES

    table = Table("figure", "content", "variables", box=None)
    for row in FIGURES.values():
        if not runs or any(row.fits(run) for run in runs):
            name = row.name if row.by_default else f"{row.name} (on request)"
            table.add_row(name, row.text, ", ".join(row.needs))
    return table


def _variables(run: Run) -> Table:
    from rich.markup import escape
    from rich.table import Table

    from evolvent.signals.selection import over_time

    table = Table("variable", "of each", "unit", "meaning", box=None)
    for name in over_time(run.history):
        values: Any = run.history[name]
        table.add_row(
            name,
            ", ".join(str(dim) for dim in values.dims if dim != "time"),
            displayed(str(values.attrs.get("units", "1"))),
            escape(str(values.attrs.get("long_name", ""))),
        )
    return table
