"""What the commands of evolvent-post share: arguments, exit codes, messages, files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
import xarray as xr

from evolvent.commands.program import option
from evolvent.history import HISTORY, open_result, run_warning

BROKEN = 1

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Histories (.h5).")]
File = Annotated[Path, typer.Argument(metavar="FILE", help="History (.h5).")]
AsJson = Annotated[bool, option("--json", "Write JSON, for scripts.")]


def complain(message: str) -> None:
    """Write a message to stderr."""
    typer.echo(f"evolvent-post: {message}", err=True)


def open_with_warning(path: Path, *kinds: str) -> xr.Dataset:
    """Open a history, or a file of one of these kinds; say if its run did not end well."""
    history = open_result(path, *(kinds or (HISTORY,)))
    warning = run_warning(history)
    if warning:
        complain(f"{path}: {warning}")
    return history
