"""The command evolvent-post plot."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.post.common import complain, labels, open_with_warning
from evolvent.commands.post.signal_options import WHOLE_TIME, OptionFrom, OptionTo
from evolvent.commands.program import new_console, say
from evolvent.errors import USAGE, HistoryError, replacing, writing
from evolvent.figures.formats import Format
from evolvent.history import DRAWN, HISTORY, WHAT, open_events, result_kind, rows_between
from evolvent.units import displayed

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from evolvent.figures.table import Drawing, Run

Names = list[str] | None
WIDE = 240  # characters per line of a list that a script reads


class Over(StrEnum):
    """Variable on the horizontal axis."""

    TIME = "time"
    ROLL_ANGLE = "roll-angle"
    PATH = "path"


@dataclass(frozen=True)
class Choice:
    """Selection of names by dimension, and the variable on the horizontal axis."""

    names: dict[str, list[str]]  # by dimension
    over: Over | None

    def __bool__(self) -> bool:
        return bool(self.names) or self.over is not None

    def options(self) -> str:
        """Return the options of the selection as typed on the command line."""
        given = [f"--{dim}" for dim in self.names] + (["--over"] if self.over is not None else [])
        return ", ".join(given)


def plot(
    files: Annotated[list[Path] | None, argument("FILE", "Histories (.h5).")] = None,
    output: Annotated[Path, option("-o --output DIR", "Folder for the figures.")] = Path(),
    file_format: Annotated[Format, option("--format", "File format.")] = Format.PNG,
    quantities: Annotated[
        Names,
        option(
            "--quantity NAME[,NAME]",
            "Figure or variable over time to draw (see --list), several in one figure separated "
            "by commas; may be repeated. The default figures if not given.",
        ),
    ] = None,
    mesh: Annotated[Names, option("--mesh NAME", "Only this mesh; may be repeated.")] = None,
    wheel: Annotated[Names, option("--wheel NAME", "Only this wheel; may be repeated.")] = None,
    pair: Annotated[
        Names, option("--pair NAME", "Only this slot of tooth pairs, as drive_0.")
    ] = None,
    axis: Annotated[Names, option("--axis NAME", "Only this axis: x, y, z.")] = None,
    others: Annotated[
        Names, option("--select DIM=NAME", "Any other dimension, such as shaft=input.")
    ] = None,
    over: Annotated[
        Over | None,
        option(
            "--over",
            "Draw over time, over the roll angle of the driving wheel since the start, or, of "
            "tooth pairs, along the path of contact from its start to its end.",
        ),
    ] = None,
    begin: OptionFrom = WHOLE_TIME[0],
    end: OptionTo = WHOLE_TIME[1],
    last: Annotated[
        float | None,
        option("--last-pitches N", "Draw the last N pitches of the fastest teeth.", min=0.01),
    ] = None,
    whole: Annotated[
        bool,
        option("--whole", "Draw the whole run, though it has a window (simulation.metrics)."),
    ] = False,
    with_pairs: Annotated[
        bool,
        option(
            "--pairs", "The same as --quantity pairs: of the last 6 pitches if none are chosen."
        ),
    ] = False,
    over_time: Annotated[bool, option("--over-time", "With --pairs: over time.")] = False,
    only_list: Annotated[
        bool, option("--list", "List pictures, and all variables of the files, instead.")
    ] = False,
) -> None:
    """Draw quantities over time, the roll angle or the path of contact, also of several histories.

    Static analyses: over the mesh cycle and over the torque. Responses: over the parameter,
    up and down, with jumps. Orbits: over the parameter, stable ones solid, unstable ones dashed.

    \b
    A run with a window for its metrics shows that window only.
    Histories with the same wheels share axes, others have separate panels.
    The figures are named after the histories, as in paper-penetration.png.
    Example:
      evolvent-post plot paper.h5 -o figures
      evolvent-post plot paper.h5 --list
      evolvent-post plot paper.h5 paper-friction.h5 --quantity transmission_error --format pdf
      evolvent-post plot paper.h5 --from 2.5 --to 2.7 --quantity friction_force,normal_force
      evolvent-post plot two-stage-gears.h5 --quantity bearing_force --wheel gear-1 --axis x
      evolvent-post plot spur-pair.h5 --quantity path --quantity pairs
      evolvent-post plot spur-pair.h5 --quantity pair_sliding_velocity --over path
      evolvent-post plot spur-pair-static.h5
      evolvent-post plot compliant-pair-respond.h5
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.figures.style import save
    from evolvent.figures.table import FIGURES, pairs

    if only_list:
        _list(files or [])
        return
    if not files:
        raise WrongUsageError("missing", "FILE")
    if whole and (begin, end, last) != (*WHOLE_TIME, None):
        raise WrongUsageError("shows all; omit --from, --to and --last-pitches", "--whole")
    requests = [[name.strip() for name in text.split(",")] for text in quantities or ()]
    requests += [[pairs.name]] if with_pairs and [pairs.name] not in requests else []
    if over_time and [pairs.name] not in requests:
        raise WrongUsageError("requires --pairs", "--over-time")
    choice = Choice(
        _chosen({"mesh": mesh, "wheel": wheel, "pair": pair, "axis": axis}, others),
        Over.TIME if over_time else over,
    )
    if choice and not requests:
        raise WrongUsageError(f"is needed by {choice.options()}", "--quantity")
    drawn: dict[str, Figure] = {}
    usual = [[row.name] for row in FIGURES.values() if row.by_default]
    with ExitStack() as opened:
        runs = [
            _open(file, label, (begin, end), last, whole, opened)
            for file, label in zip(files, labels(files), strict=True)
        ]
        for names in requests or usual:
            shown = runs if requests else [run for run in runs if FIGURES[names[0]].fits(run)]
            if shown:
                drawn |= _draw(names, shown, choice)
    while drawn:
        name = next(iter(drawn))
        figure = drawn.pop(name)
        target = output / f"{name.replace('/', '-')}.{file_format}"
        with writing(output):
            output.mkdir(parents=True, exist_ok=True)
        with replacing(target) as temporary:
            save(figure, temporary)
        say(target)
        del figure  # a figure is large and contains reference cycles
        gc.collect()


def _draw(names: list[str], runs: list[Run], choice: Choice) -> dict[str, Figure]:
    """Draw one figure for all runs, or one for each; return figures by file name."""
    from evolvent.figures.table import FIGURES

    row = FIGURES.get(names[0]) if len(names) == 1 else None
    name = "-".join(names)
    if row is None:
        name += "" if choice.over in (None, Over.TIME) else f"-over-{choice.over}"
        figure = _draw_variables(_expanded(names), runs, choice)
    elif row.together and len(runs) > 1:
        figure = _draw_row(row, runs, choice)
    else:
        return {f"{run.label}-{name}": _draw_row(row, [run], choice) for run in runs}
    return {name if len(runs) > 1 else f"{runs[0].label}-{name}": figure}


def _draw_row(row: Drawing, runs: list[Run], choice: Choice) -> Figure:
    """Draw a figure of the table with the selection that it supports."""
    from evolvent.figures.quantities import X
    from evolvent.figures.table import pairs, path

    if not choice:
        return row(*runs)
    if row is pairs and not choice.names and choice.over is not Over.PATH:
        return row(*runs, over_time=choice.over is Over.TIME)
    if row is path and set(choice.names) <= {"mesh"} and choice.over in (None, Over.PATH):
        return row(*runs, meshes=choice.names.get("mesh", ()))
    if not row.chooses:
        raise HistoryError(
            f"{choice.options()} cannot be used with {row.name}; draw its variables instead: "
            f"--quantity {','.join(row.needs)}",
            USAGE,
        )
    if choice.over is Over.PATH:
        return _draw_variables(row.needs, runs, choice)
    return row(*runs, chosen=choice.names, over=X(choice.over or X.TIME))


def _draw_variables(names: Sequence[str], runs: list[Run], choice: Choice) -> Figure:
    """Draw any variables of histories."""
    from evolvent.figures.quantities import X, draw_quantities
    from evolvent.figures.table import FIGURES, along_path
    from evolvent.signals.selection import over_time as variables_over_time
    from evolvent.signals.selection import unknown

    for run in runs:
        for name in names:
            if result_kind(run.history) != HISTORY:
                known = [row.name for row in FIGURES.values() if row.fits(run)]
                raise HistoryError(
                    f"{run.label}: is {WHAT[result_kind(run.history)]}; --quantity accepts "
                    f"{', '.join(known)}, not {name}",
                    USAGE,
                )
            if name in FIGURES and name not in run.history:
                raise HistoryError(
                    f"{name} is a separate figure; give it its own --quantity", USAGE
                )
            if name not in variables_over_time(run.history):
                pictures = [row.name for row in FIGURES.values() if row.of == HISTORY]
                raise HistoryError(f"{run.label}.h5: {unknown(run.history, name, pictures)}", USAGE)
    if choice.over is not Over.PATH:
        return draw_quantities(runs, names, choice.names, X(choice.over or X.TIME))
    if set(choice.names) - {"mesh"}:
        raise HistoryError("--over path takes --mesh only: it shows all tooth pairs", USAGE)
    return along_path(runs, names, choice.names.get("mesh", ()))


def _expanded(names: Sequence[str]) -> list[str]:
    """Replace figure names among variables by their variables: speeds by angular_velocity."""
    from evolvent.figures.table import FIGURES

    found: list[str] = []
    for name in names:
        row = FIGURES.get(name)
        found += row.needs if row is not None and row.chooses else [name]
    return list(dict.fromkeys(found))


def _chosen(given: dict[str, Names], others: Names) -> dict[str, list[str]]:
    """Collect names by dimension from the options."""
    chosen = {dim: list(names) for dim, names in given.items() if names}
    for text in others or ():
        dim, equals, name = text.partition("=")
        if not (dim and equals and name):
            raise WrongUsageError(f"{text} is not DIM=NAME", "--select")
        chosen.setdefault(dim, []).append(name)
    return chosen


def _open(
    file: Path,
    label: str,
    times: tuple[float, float],
    last: float | None,
    whole: bool,
    opened: ExitStack,
) -> Run:
    """Open a file of any kind that has figures; restrict a history to the displayed part.

    Parameters
    ----------
    opened : stack that closes the file.
    """
    from evolvent.figures.pairs import last_pitches
    from evolvent.figures.table import Run
    from evolvent.physics.metrics import steady_window

    result = opened.enter_context(open_with_warning(file, HISTORY, *DRAWN))
    is_chosen = times != WHOLE_TIME or last is not None
    kind = result_kind(result)
    if kind != HISTORY:
        if is_chosen or whole:
            raise HistoryError(
                f"{file}: is {WHAT[kind]}, not a history; omit --from, --to, --last-pitches and "
                "--whole",
                USAGE,
            )
        return Run(result, label=label)
    window = None if is_chosen or whole else steady_window(result)
    if window is not None:
        complain(
            f"{file}: shows the window of its numbers, {window[0]:.6g} to {window[1]:.6g} s; "
            "--whole shows all"
        )
    part = _between(result, *(window or times))
    if part.sizes["time"] == 0:
        raise HistoryError(f"{file}: has no output between --from and --to", USAGE)
    part = part if last is None else last_pitches(part, last)
    return Run(part, opened.enter_context(open_events(file)), label, not is_chosen)


def _between(history: xr.Dataset, begin: float, end: float) -> xr.Dataset:
    return history.isel(time=rows_between(history, begin, end))


def _list(files: Sequence[Path]) -> None:
    """Print the table of the figures, and of all variables of the files."""
    from evolvent.figures.table import Run

    with ExitStack() as opened:
        results = (open_with_warning(file, HISTORY, *DRAWN) for file in files)
        _print_list(files, [Run(opened.enter_context(result)) for result in results])


def _print_list(files: Sequence[Path], runs: Sequence[Run]) -> None:
    from rich.markup import escape
    from rich.table import Table

    from evolvent.figures.table import FIGURES
    from evolvent.signals.selection import over_time as variables_over_time

    console = new_console()
    if not console.is_terminal:
        console.width = WIDE
    rows = [row for row in FIGURES.values() if not runs or any(row.fits(run) for run in runs)]
    table = Table("figure", "content", "variables", box=None)
    for row in rows:
        name = row.name if row.by_default else f"{row.name} (on request)"
        table.add_row(name, row.text, ", ".join(row.needs))
    console.print(table)
    for file, run in zip(files, runs, strict=True):
        if result_kind(run.history) != HISTORY:
            continue
        variables = Table("variable", "of each", "unit", "meaning", box=None)
        for name in variables_over_time(run.history):
            values: Any = run.history[name]
            variables.add_row(
                name,
                ", ".join(str(dim) for dim in values.dims if dim != "time"),
                displayed(str(values.attrs.get("units", "1"))),
                escape(str(values.attrs.get("long_name", ""))),
            )
        console.print(f"\n{file}: variables over time", highlight=False, markup=False)
        console.print(variables)
