"""The command evolvent-post: a thin layer over the library."""

from __future__ import annotations

import json
import math
import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated, Any

import typer
import xarray as xr
from matplotlib.figure import Figure
from rich.console import Console
from rich.markup import escape
from rich.table import Table

import evolvent
from evolvent.commands.post.animate import animate
from evolvent.commands.post.common import (
    BROKEN,
    UNREADABLE,
    complain,
    fail_to_write,
    open_with_warning,
    refuse,
)
from evolvent.figures import over_time as figures
from evolvent.history import HistoryError, file_label, open_events, open_history, run_warning
from evolvent.pages import pair_figure
from evolvent.physics.invariants import Verdict, check_history
from evolvent.units import displayed

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    help="""Check, draw and compare the histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is broken, or a difference is beyond the tolerance
       2  wrong usage of the command line
       3  a file is no readable history
      74  output could not be written
    """,
)

app.command()(animate)

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Histories (.h5).")]
File = Annotated[Path, typer.Argument(metavar="FILE", help="History (.h5).")]
AsJson = Annotated[bool, typer.Option("--json", help="Write JSON, for scripts.")]


class Format(StrEnum):
    """Formats of a figure."""

    PNG = "png"
    SVG = "svg"
    PDF = "pdf"


class Quantity(StrEnum):
    """What can be drawn."""

    PENETRATION = "penetration"
    TRANSMISSION_ERROR = "transmission_error"
    NORMAL_FORCE = "normal_force"
    SPEEDS = "speeds"


DRAWN_ALONE = {
    Quantity.PENETRATION: figures.figure_penetration,
    Quantity.NORMAL_FORCE: figures.figure_normal_force,
    Quantity.SPEEDS: figures.figure_speeds,
}


def main() -> None:
    """Run the command line; an error is one line on stderr."""
    try:
        app(prog_name="evolvent-post")
    except HistoryError as error:
        complain(str(error))
        sys.exit(UNREADABLE)


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(f"evolvent-post {evolvent.__version__}")
        raise typer.Exit


@app.command()
def check(files: Files, as_json: AsJson = False) -> None:
    """Check the invariants of runs: what must hold whatever the case.

    \b
    Exit code 1 if one is broken, 3 if a file cannot be read.
    Example:
      evolvent-post check paper.h5 paper-friction.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    checked: list[tuple[Path, str | None, list[Verdict]]] = []
    unreadable = False
    for path in files:
        try:
            with open_history(path) as history:
                checked.append((path, run_warning(history), check_history(history)))
        except HistoryError as error:
            complain(str(error))
            unreadable = True
    if as_json:
        typer.echo(json.dumps([_verdicts_as_json(*one) for one in checked], indent=2))
    else:
        for path, warning, verdicts in checked:
            if warning:
                complain(f"{path}: {warning}")
            _print_verdicts(path, verdicts)
    if unreadable:
        raise typer.Exit(UNREADABLE)
    if any(verdict.failed for _, _, verdicts in checked for verdict in verdicts):
        raise typer.Exit(BROKEN)


@app.command()
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
        if quantity is Quantity.TRANSMISSION_ERROR:
            if len({history.sizes["mesh"] for history in histories}) > 1:
                raise HistoryError(
                    "the histories have different numbers of meshes; draw each alone"
                )
            name = f"{labels[0]}-{quantity}" if len(files) == 1 else str(quantity)
            marks = events[0] if len(files) == 1 else None
            drawn[name] = figures.figure_transmission_error(histories, labels, marks)
        else:
            for history, marked, label in zip(histories, events, labels, strict=True):
                drawn[f"{label}-{quantity}"] = DRAWN_ALONE[quantity](history, marked)
    for history, marked, label in zip(histories, events, labels, strict=True) if pairs else []:
        whole = begin == -math.inf and end == math.inf
        part = pair_figure.last_pitches(history) if whole else history
        drawn[f"{label}-pairs"] = pair_figure.figure_pairs(part, marked, over_time)
    for name, figure in drawn.items():
        path = output / f"{name.replace('/', '-')}.{file_format}"
        try:
            output.mkdir(parents=True, exist_ok=True)
            figures.save(figure, path)
        except OSError as error:
            fail_to_write(path, error)
        typer.echo(path)


@app.command()
def report(
    file: File,
    output: Annotated[
        Path | None,
        typer.Option(
            "-o", "--output", metavar="HTML", help="Page; the history's name if not given."
        ),
    ] = None,
) -> None:
    """Write one self-contained HTML page about a run.

    \b
    The case, its geometry, invariants, figures, events, solver counts and versions.
    Example:
      evolvent-post report paper.h5 -o paper.html
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.pages.report import report as make_report

    path = output if output is not None else Path(f"{file_label(file)}.html")
    with open_with_warning(file) as history, open_events(file) as events:
        page = make_report(history, events)
    try:
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        fail_to_write(path, error)
    typer.echo(path)


@app.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="A", help="History (.h5).")],
    second: Annotated[Path, typer.Argument(metavar="B", help="History (.h5) of a like run.")],
    tolerance: Annotated[
        float | None,
        typer.Option(metavar="X", min=0.0, help="Largest relative difference accepted."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show the largest difference of every variable of two runs.

    \b
    Relative differences refer to the variable's largest absolute value in both runs.
    Exit code 1 if one is beyond the tolerance.
    Example:
      evolvent-post compare closed_form.h5 differential.h5 --tolerance 1e-6
    """  # noqa: D301 - \b keeps click from filling the lines
    with open_with_warning(first) as one, open_with_warning(second) as two:
        result = evolvent.compare_histories(one, two)
    relative = result["relative"].values
    beyond = relative > tolerance if tolerance is not None else relative < 0.0
    if as_json:
        typer.echo(json.dumps(_differences_as_json(result), indent=2))
    else:
        _print_differences(result, beyond.tolist())
    if beyond.any():
        worst = result.isel(variable=int(relative.argmax()))
        complain(
            f"{int(beyond.sum())} variables differ by more than {tolerance:g}, most of all "
            f"{worst['variable'].item()} by {worst['relative'].item():.3g} of its largest value"
        )
        raise typer.Exit(BROKEN)


def _labels(files: list[Path]) -> list[str]:
    """Name the files by the fewest trailing parts of their paths that tell them apart."""
    for parts in range(1, 1 + max(len(path.parts) for path in files)):
        labels = ["/".join([*p.parts[-parts:-1], file_label(p)]).lstrip("/") for p in files]
        if len(set(labels)) == len(labels):
            return labels
    raise typer.BadParameter("the same file is given twice", param_hint="FILE")


def _console() -> Console:
    # Into a file or pipe lines are not broken: scripts read them.
    return Console() if sys.stdout.isatty() else Console(width=160)


def _print_verdicts(path: Path, verdicts: list[Verdict]) -> None:
    table = Table(title=escape(str(path)), title_justify="left", title_style="bold", box=None)
    for column in ("invariant", "worst", "bound", "relative to", "where", "verdict"):
        table.add_column(column, justify="right" if column in ("worst", "bound") else "left")
    styles = {"pass": "green", "fail": "bold red", "not applicable": "dim"}
    for v in verdicts:
        table.add_row(
            v.invariant.name,
            "" if v.worst is None else f"{v.worst:.2e}",
            f"{v.bound:g}",
            v.invariant.relative_to,
            escape(v.reason or (", ".join(v.where.values()) if v.worst else "")),
            f"[{styles[v.verdict]}]{v.verdict}[/]",
        )
    _console().print(table)


def _verdicts_as_json(path: Path, warning: str | None, verdicts: list[Verdict]) -> dict[str, Any]:
    return {
        "file": str(path),
        "warning": warning,
        "invariants": [
            {
                "name": v.invariant.name,
                "formula": v.invariant.formula,
                "relative_to": v.invariant.relative_to,
                "bound": v.bound,
                "worst": _number(v.worst),
                "where": v.where,
                "verdict": v.verdict,
                "reason": v.reason,
            }
            for v in verdicts
        ],
    }


def _print_differences(result: xr.Dataset, beyond: list[bool]) -> None:
    table = Table(box=None)
    for column in ("variable", "largest difference", "relative", "where"):
        is_number = column in ("largest difference", "relative")
        table.add_column(column, justify="right" if is_number else "left")
    same = 0
    for number, name in enumerate(result["variable"].values):
        row = result.isel(variable=number)
        if row["absolute"].item() == 0.0:
            same += 1
            continue
        style = "bold red" if beyond[number] else None
        units = row["units"].item()
        table.add_row(
            escape(str(name)),
            f"{row['absolute'].item():.3e} {displayed(units)}".rstrip(),
            f"{row['relative'].item():.2e}",
            escape(row["where"].item()),
            style=style,
        )
    console = _console()
    console.print(f"Compared on {result.attrs['times']}.", highlight=False)
    if table.row_count:
        console.print(table)
    console.print(f"{same} variables are the same to the bit.", highlight=False)
    for side, names in (("first", "only_in_first"), ("second", "only_in_second")):
        if result.attrs[names]:
            console.print(
                f"Only in the {side}: {result.attrs[names]}", highlight=False, markup=False
            )


def _differences_as_json(result: xr.Dataset) -> dict[str, Any]:
    variables = {
        str(name): {
            "absolute": _number(result["absolute"].values[i]),
            "relative": _number(result["relative"].values[i]),
            "largest": _number(result["largest"].values[i]),
            "units": str(result["units"].values[i]),
            "where": str(result["where"].values[i]),
        }
        for i, name in enumerate(result["variable"].values)
    }
    return {**result.attrs, "variables": variables}


def _number(value: float | None) -> float | str | None:
    """JSON has no infinity and no NaN: they become text."""
    if value is None:
        return None
    return float(value) if math.isfinite(value) else str(float(value))
