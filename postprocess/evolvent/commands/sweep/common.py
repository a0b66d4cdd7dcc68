"""What the commands of evolvent-sweep share: arguments, and how a run ended."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from evolvent.commands.sweep import console
from evolvent.sweep import folder
from evolvent.sweep.errors import FAILED_CASES

DesignFile = Annotated[Path, typer.Argument(metavar="DESIGN", help="Design (.h5), from `plan`.")]
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of the results.")]
Into = Annotated[
    Path, typer.Option("-o", "--output", metavar="DIR", help="Folder for the results.")
]
OtherDesign = Annotated[
    Path | None,
    typer.Option("--design", metavar="DESIGN", help="Design, if DIR has no design.h5."),
]
Jobs = Annotated[
    int | None,
    typer.Option("--jobs", metavar="J", min=1, help="Worker processes; all cores if not given."),
]


def told(directory: Path, code: int) -> int:
    """Say how a run ended; return its exit code."""
    from evolvent.sweep.status import read_status

    found = read_status(directory, folder.design_of(directory))
    console.show_counts(directory, found)
    return FAILED_CASES if code == 0 and found.counts.unfinished else code
