"""The command evolvent-post report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import option
from evolvent.commands.post.common import File, open_with_warning
from evolvent.commands.program import say
from evolvent.errors import replacing
from evolvent.history import file_label, open_events


def report(
    file: File,
    output: Annotated[
        Path | None,
        option(
            "-o --output HTML",
            "HTML file to write; if not given, the name of the history with .html.",
        ),
    ] = None,
    interactive: Annotated[
        bool,
        option(
            "--interactive",
            "Interactive figures of all quantities, with zoom and values. The page has 2 to 6 MB "
            "and requires no network access.",
        ),
    ] = False,
    begin: Annotated[float | None, option("--from TIME", "Start time of the figures [s].")] = None,
    end: Annotated[float | None, option("--to TIME", "End time of the figures [s].")] = None,
) -> None:
    """Write a report of a run as one HTML page.

    \b
    The report begins with the results: largest forces and pressures with time and position,
    transmission error, dynamic factor, losses, speeds, torques. Figures, all metrics, events,
    invariants, geometry, solver statistics, versions and the case follow.
    Example:
      evolvent-post report paper.h5 -o paper.html
      evolvent-post report paper.h5 --interactive -o paper-interactive.html
    """  # noqa: D301 - \b keeps click from filling the lines
    from evolvent.pages.report import report as make_report

    path = output if output is not None else Path(f"{file_label(file)}.html")
    with open_with_warning(file) as history, open_events(file) as events:
        page = make_report(history, events, interactive, (begin, end))
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8", errors="replace")
    say(path)
