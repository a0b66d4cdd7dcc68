"""The command evolvent-post plot."""

from __future__ import annotations

import math
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer
from matplotlib.figure import Figure

from evolvent.commands.post.common import Files, fail_to_write, open_with_warning, refuse
from evolvent.figures.style import Format, save
from evolvent.figures.table import DRAWINGS
from evolvent.history import HistoryError, file_label, open_events
from evolvent.pages.pair_figure import figure_pairs, last_pitches

DRAWN = {drawing.name: drawing for drawing in DRAWINGS}
Quantity = StrEnum("Quantity", list(DRAWN))  # type: ignore[misc]  # its members are a table


def plot(
    files: Files,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for the figures.")
    ] = Path(),
    file_format: Annotated[Format, typer.Option("--format", help="File format.")] = Format.PNG,
    quantities: Annotated[
        list[Quantity] | None,
        typer.Option("--quantity", help="What to draw; may be repeated. All if not given."),
    ] = None,
    begin: Annotated[
        float,
        typer.Option(
            "--from",
            metavar="TIME",
            show_default=False,
            help="First time drawn [s]; else the first.",
        ),
    ] = -math.inf,
    end: Annotated[
        float,
        typer.Option(
            "--to", metavar="TIME", show_default=False, help="Last time drawn [s]; else the last."
        ),
    ] = math.inf,
    pairs: Annotated[
        bool,
        typer.Option(
            "--pairs",
            help="Draw the load of each tooth pair over the roll angle of the driving wheel: of "
            "the last 6 pitches, unless --from or --to is given.",
        ),
    ] = False,
    over_time: Annotated[
        bool, typer.Option("--over-time", help="With --pairs: over time.")
    ] = False,
) -> None:
    """Draw quantities over time; the transmission errors of all files come in one figure.

    \b
    The figures are named after the histories, as in paper-penetration.png.
    Example:
      evolvent-post plot paper.h5 -o figures
      evolvent-post plot paper.h5 paper-friction.h5 --quantity transmission_error --format pdf
      evolvent-post plot paper.h5 --from 2.5 --to 2.7
      evolvent-post plot spur-pair.h5 --pairs
    """  # noqa: D301 - \b keeps click from filling the lines
    if over_time and not pairs:
        raise typer.BadParameter("is for --pairs", param_hint="--over-time")
    wanted = quantities or ([] if pairs else list(Quantity))
    labels = _labels(files)
    histories, events = [], []
    for path in files:
        history = open_with_warning(path)
        part = history.sel(time=(history["time"] >= begin) & (history["time"] <= end))
        if part.sizes["time"] == 0:
            refuse(f"{path}: has no output between --from and --to")
        histories.append(part)
        events.append(open_events(path))
    drawn: dict[str, Figure] = {}
    for quantity in wanted:
        drawing = DRAWN[quantity]
        if drawing.together is not None:
            if len({history.sizes["mesh"] for history in histories}) > 1:
                raise HistoryError(
                    "the histories have different numbers of meshes; draw each alone"
                )
            name = f"{labels[0]}-{quantity}" if len(files) == 1 else str(quantity)
            marks = events[0] if len(files) == 1 else None
            drawn[name] = drawing.together(histories, labels, marks)
        if drawing.one is not None:
            for history, marked, label in zip(histories, events, labels, strict=True):
                drawn[f"{label}-{quantity}"] = drawing.one(history, marked)
    for history, marked, label in zip(histories, events, labels, strict=True) if pairs else []:
        whole = begin == -math.inf and end == math.inf
        part = last_pitches(history) if whole else history
        drawn[f"{label}-pairs"] = figure_pairs(part, marked, over_time)
    for name, figure in drawn.items():
        path = output / f"{name.replace('/', '-')}.{file_format}"
        try:
            output.mkdir(parents=True, exist_ok=True)
            save(figure, path)
        except OSError as error:
            fail_to_write(path, error)
        typer.echo(path)


def _labels(files: list[Path]) -> list[str]:
    """Name the files by the fewest trailing parts of their paths that tell them apart."""
    for parts in range(1, 1 + max(len(path.parts) for path in files)):
        labels = ["/".join([*p.parts[-parts:-1], file_label(p)]).lstrip("/") for p in files]
        if len(set(labels)) == len(labels):
            return labels
    raise typer.BadParameter("the same file is given twice", param_hint="FILE")
