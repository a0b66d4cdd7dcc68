"""Arguments common to the commands of evolvent-sweep, and the report at the end of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from evolvent.commands.command_line import argument, option
from evolvent.commands.sweep import console
from evolvent.errors import FAILED_CASES

DesignFile = Annotated[Path, argument("DESIGN", "Design (.h5), from `plan`.")]
Folder = Annotated[Path, argument("DIR", "Folder with the results.")]
Into = Annotated[Path, option("-o --output DIR", "Folder for the results.")]
OtherDesign = Annotated[Path | None, option("--design DESIGN", "Design, if DIR has no design.h5.")]
Jobs = Annotated[
    int | None, option("--jobs J", "Number of worker processes; if not given, one per core.", min=1)
]


def report_result(directory: Path, code: int) -> int:
    """Print the result of a run; return its exit code."""
    from evolvent.sweep import folder
    from evolvent.sweep.status import read_status

    found = read_status(directory, folder.design_of(directory))
    console.show_counts(directory, found)
    return FAILED_CASES if code == 0 and found.counts.unfinished else code
