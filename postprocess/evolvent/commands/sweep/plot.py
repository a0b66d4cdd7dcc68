"""The command evolvent-sweep plot."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.program import say
from evolvent.commands.sweep import console
from evolvent.errors import SweepError, replacing


def plot(
    file: Annotated[Path, argument("SUMMARY", "Summary (.h5).")],
    response: Annotated[
        str | None, option("-r --response NAME", "Result to plot; if not given, the first result.")
    ] = None,
    against: Annotated[
        list[str] | None,
        option("-a --against NAME", "Parameter of the axis; give it twice for a map."),
    ] = None,
    indices: Annotated[bool, option("--indices", "Plot Sobol indices instead.")] = False,
    output: Annotated[
        Path | None, option("-o --output FILE", "Figure to write (.png, .svg, .pdf).")
    ] = None,
) -> None:
    """Plot a result over one or two parameters. Cases that did not finish are marked.

    \b
    Without -o the name of the figure contains the names of the summary and the result.
    Example:
      evolvent-sweep plot torque-summary.h5 --response penetration_max --against torque
      evolvent-sweep plot torque-summary.h5 -a torque -a friction -o map.png
    """  # noqa: D301
    from evolvent.figures.formats import Format
    from evolvent.figures.style import save
    from evolvent.sweep import figures
    from evolvent.sweep.collect import open_summary
    from evolvent.sweep.sensitivity import sobol_indices

    if indices and against:
        raise WrongUsageError("has no meaning with --indices", "--against")
    with open_summary(file) as summary:
        known = figures.with_role(summary, "result")
        if not known:
            raise SweepError(f"{file}: has no results; no case is recorded")
        name = response or known[0]
        if indices:
            found = sobol_indices(summary, name)
            console.show_indices(found)
            figure = figures.figure_indices(found)
        else:
            figure = figures.figure_response(summary, name, against or ())
    path = output or Path(f"{file.stem}-{name}{'-indices' if indices else ''}.png")
    if path.suffix.lstrip(".").lower() not in list(Format):
        raise WrongUsageError(f"{path} must end in .png, .svg or .pdf", "--output")
    with replacing(path) as temporary:
        save(figure, temporary)
    say(path)
