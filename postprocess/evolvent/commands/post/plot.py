"""The command evolvent-post plot."""

from __future__ import annotations

import gc
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.post.common import complain, labels, open_with_warning
from evolvent.commands.post.plot_list import print_list
from evolvent.commands.post.plot_request import Over, Request
from evolvent.commands.post.signal_options import Times, dimension_and_name
from evolvent.commands.program import say
from evolvent.errors import USAGE, HistoryError, replacing, writing
from evolvent.figures.formats import Format
from evolvent.history import DRAWN, HISTORY, WHAT, open_events, result_kind, rows_between

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from evolvent.figures.table import Run

Names = list[str] | None


@dataclass(frozen=True, kw_only=True)
class Selection:
    """Options that select names by dimension, and the variable on the horizontal axis."""

    mesh: Annotated[Names, option("--mesh NAME", "Only this mesh; may be repeated.")] = None
    wheel: Annotated[Names, option("--wheel NAME", "Only this wheel; may be repeated.")] = None
    pair: Annotated[Names, option("--pair NAME", "Only this tooth pair slot, such as drive_0.")] = (
        None
    )
    axis: Annotated[Names, option("--axis NAME", "Only this axis: x, y, z.")] = None
    others: Annotated[
        Names, option("--select DIM=NAME", "Value of any other dimension, such as shaft=input.")
    ] = None
    over: Annotated[
        Over | None,
        option(
            "--over",
            "Horizontal axis: time, roll angle of the driving wheel since the start, or for tooth "
            "pairs the position on the path of contact.",
        ),
    ] = None

    def chosen(self) -> dict[str, list[str]]:
        """Collect names by dimension."""
        given = {"mesh": self.mesh, "wheel": self.wheel, "pair": self.pair, "axis": self.axis}
        chosen = {dim: list(names) for dim, names in given.items() if names}
        for text in self.others or ():
            dim, name = dimension_and_name(text)
            chosen.setdefault(dim, []).append(name)
        return chosen


@dataclass(frozen=True, kw_only=True)
class Part:
    """Options for the displayed part of a history."""

    times: Times
    last: Annotated[
        float | None,
        option(
            "--last-pitches N",
            "Plot the last N pitches of the mesh with the highest mesh frequency.",
            min=0.01,
        ),
    ] = None
    whole: Annotated[
        bool,
        option("--whole", "Plot the whole run, even if it has a time window (simulation.metrics)."),
    ] = False

    @property
    def is_chosen(self) -> bool:
        """Whether it is less than the whole run."""
        return self.times != Times() or self.last is not None


@dataclass(frozen=True, kw_only=True)
class Pairs:
    """Options of the figure of tooth pairs."""

    with_pairs: Annotated[
        bool,
        option(
            "--pairs",
            "The same as --quantity pairs; if no time range is given, for the last 6 pitches.",
        ),
    ] = False
    over_time: Annotated[bool, option("--over-time", "With --pairs: plot over time.")] = False


def plot(
    files: Annotated[list[Path] | None, argument("FILE", "Histories (.h5).")] = None,
    output: Annotated[Path, option("-o --output DIR", "Folder for the figures.")] = Path(),
    file_format: Annotated[Format, option("--format", "File format.")] = Format.PNG,
    quantities: Annotated[
        Names,
        option(
            "--quantity NAME[,NAME]",
            "Figure, or variable over time, to plot (see --list). Several names separated by "
            "commas share one figure. May be repeated; if not given, the default figures.",
        ),
    ] = None,
    *,
    selection: Selection,
    part: Part,
    with_pairs: Pairs,
    only_list: Annotated[
        bool, option("--list", "Only list the figures and all variables of the files.")
    ] = False,
) -> None:
    """Plot results over time, roll angle or path of contact.

    Static analyses are plotted over the mesh cycle and over the torque, responses over the
    parameter, up and down, with jumps. Orbits are plotted over the parameter: stable ones solid,
    unstable ones dashed.

    \b
    If a run has a time window for its metrics, only this window is plotted.
    Several histories with the same wheels share axes; others have separate panels.
    File names of figures begin with those of the histories, such as paper-penetration.png.
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
    if only_list:
        print_list(files or [])
        return
    if not files:
        raise WrongUsageError("missing", "FILE")
    if part.whole and part.is_chosen:
        raise WrongUsageError("shows all; omit --from, --to and --last-pitches", "--whole")
    requests = _requests(quantities, selection, with_pairs)
    drawn: dict[str, Figure] = {}
    with ExitStack() as opened:
        runs = [
            _open(file, label, part, opened)
            for file, label in zip(files, labels(files), strict=True)
        ]
        for request in requests:
            drawn |= request.draw(runs)
        if not requests:
            drawn = _draw_default(runs)
    _write(drawn, output, file_format)


def _requests(quantities: Names, selection: Selection, with_pairs: Pairs) -> list[Request]:
    """List the figures that the command line requests."""
    from evolvent.figures.table import pairs

    names = [[name.strip() for name in text.split(",")] for text in quantities or ()]
    if with_pairs.with_pairs and [pairs.name] not in names:
        names.append([pairs.name])
    if with_pairs.over_time and [pairs.name] not in names:
        raise WrongUsageError("requires --pairs", "--over-time")
    chosen = selection.chosen()
    over = Over.TIME if with_pairs.over_time else selection.over
    unused = Request([], chosen, over)
    if not names and not unused.is_plain:
        raise WrongUsageError(f"is needed by {unused.options()}", "--quantity")
    return [Request(each, chosen, over) for each in names]


def _draw_default(runs: Sequence[Run]) -> dict[str, Figure]:
    """Draw the default figures, each for the runs that it fits."""
    from evolvent.figures.table import FIGURES

    drawn: dict[str, Figure] = {}
    for row in FIGURES.values():
        shown = [run for run in runs if row.by_default and row.fits(run)]
        if shown:
            drawn |= Request([row.name]).draw(shown)
    return drawn


def _write(drawn: dict[str, Figure], output: Path, file_format: Format) -> None:
    """Write the figures, and release each as soon as it is written."""
    from evolvent.figures.style import save

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


def _open(file: Path, label: str, part: Part, opened: ExitStack) -> Run:
    """Open a file of any kind that has figures; restrict a history to the displayed part.

    Parameters
    ----------
    opened : stack that closes the file.
    """
    from evolvent.figures.table import Run

    result = opened.enter_context(open_with_warning(file, HISTORY, *DRAWN))
    kind = result_kind(result)
    if kind == HISTORY:
        shown = _displayed(file, result, part)
        return Run(shown, opened.enter_context(open_events(file)), label, not part.is_chosen)
    if part.is_chosen or part.whole:
        raise HistoryError(
            f"{file}: is {WHAT[kind]}, not a history; omit --from, --to, --last-pitches and "
            "--whole",
            USAGE,
        )
    return Run(result, label=label)


def _displayed(file: Path, history: xr.Dataset, part: Part) -> xr.Dataset:
    """Return the chosen part of a history, or its window for metrics."""
    from evolvent.figures.pairs import last_pitches
    from evolvent.physics.metrics import steady_window

    window = None if part.is_chosen or part.whole else steady_window(history)
    if window is not None:
        complain(
            f"{file}: shows the window of its numbers, {window[0]:.6g} to {window[1]:.6g} s; "
            "--whole shows all"
        )
    begin, end = window or (part.times.begin, part.times.end)
    shown = history.isel(time=rows_between(history, begin, end))
    if shown.sizes["time"] == 0:
        raise HistoryError(f"{file}: has no output between --from and --to", USAGE)
    return shown if part.last is None else last_pitches(shown, part.last)
