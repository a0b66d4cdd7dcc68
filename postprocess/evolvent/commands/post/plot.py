"""The command evolvent-post plot."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from matplotlib.figure import Figure
from rich.table import Table

from evolvent.commands.post.common import Files, labels, open_with_warning
from evolvent.commands.program import new_console, option
from evolvent.errors import USAGE, HistoryError, writing
from evolvent.figures.style import Format, save
from evolvent.figures.table import FIGURES, Run, pairs
from evolvent.history import DRAWN, HISTORY, WHAT, open_events, result_kind

Quantity = StrEnum("Quantity", list(FIGURES))  # type: ignore[misc]  # its members are a table


def _list(wanted: bool) -> None:
    """Print the table of the figures instead of drawing."""
    if not wanted:
        return
    table = Table("quantity", "what is drawn", "of the variables", box=None)
    for row in FIGURES.values():
        name = row.name if row.by_default else f"{row.name} (if asked for)"
        table.add_row(name, row.text, ", ".join(row.needs))
    new_console().print(table)
    raise typer.Exit


def plot(
    files: Files,
    output: Annotated[Path, option("-o --output DIR", "Folder for the figures.")] = Path(),
    file_format: Annotated[Format, option("--format", "File format.")] = Format.PNG,
    quantities: Annotated[
        list[Quantity] | None,
        option(
            "--quantity",
            "What to draw; may be repeated. All that fit the file, but pairs, if not given.",
        ),
    ] = None,
    begin: Annotated[
        float, option("--from TIME", "First time drawn [s]; else the first.", show_default=False)
    ] = -math.inf,
    end: Annotated[
        float, option("--to TIME", "Last time drawn [s]; else the last.", show_default=False)
    ] = math.inf,
    with_pairs: Annotated[
        bool,
        option(
            "--pairs",
            "Draw the load of each tooth pair over the roll angle of the driving wheel: of "
            "the last 6 pitches, unless --from or --to is given.",
        ),
    ] = False,
    over_time: Annotated[bool, option("--over-time", "With --pairs: over time.")] = False,
    _: Annotated[
        bool, option("--list", "List the figures instead.", callback=_list, is_eager=True)
    ] = False,
) -> None:
    """Draw quantities over time; the transmission errors of all files come in one figure.

    Of a static analysis: over the mesh cycle and over the torque.

    \b
    The figures are named after the histories, as in paper-penetration.png.
    Example:
      evolvent-post plot paper.h5 -o figures
      evolvent-post plot paper.h5 paper-friction.h5 --quantity transmission_error --format pdf
      evolvent-post plot paper.h5 --from 2.5 --to 2.7
      evolvent-post plot spur-pair.h5 --pairs
      evolvent-post plot spur-pair-static.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    asked = [str(q) for q in quantities or ()]
    asked += [pairs.name] if with_pairs and pairs.name not in asked else []
    if over_time and pairs.name not in asked:
        raise typer.BadParameter("is for --pairs", param_hint="--over-time")
    runs = [
        _open(path, label, begin, end) for path, label in zip(files, labels(files), strict=True)
    ]
    drawn: dict[str, Figure] = {}
    for name in asked or [row.name for row in FIGURES.values() if row.by_default]:
        row = FIGURES[name]
        shown = runs if asked else [run for run in runs if row.fits(run)]
        if not shown:
            continue
        if row.together and len(shown) > 1:
            drawn[row.name] = row(*shown)
            continue
        options = {"over_time": True} if row is pairs and over_time else {}
        drawn |= {f"{run.label}-{row.name}": row(run, **options) for run in shown}
    for name, figure in drawn.items():
        path = output / f"{name.replace('/', '-')}.{file_format}"
        with writing(path):
            output.mkdir(parents=True, exist_ok=True)
            save(figure, path)
        typer.echo(path)


def _open(path: Path, label: str, begin: float, end: float) -> Run:
    """Open a file of any kind that has figures; of a history what lies between two times."""
    result = open_with_warning(path, HISTORY, *DRAWN)
    is_whole = begin == -math.inf and end == math.inf
    kind = result_kind(result)
    if kind != HISTORY:
        if not is_whole:
            raise HistoryError(
                f"{path}: is {WHAT[kind]}, not a history: leave out --from and --to", USAGE
            )
        return Run(result, label=label)
    part = result.sel(time=(result["time"] >= begin) & (result["time"] <= end))
    if part.sizes["time"] == 0:
        raise HistoryError(f"{path}: has no output between --from and --to", USAGE)
    return Run(part, open_events(path), label, is_whole)
