"""What the commands of evolvent-post share: arguments, exit codes, messages, files."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, NoReturn

import typer
import xarray as xr

from evolvent.commands.program import option
from evolvent.history import HISTORY, HistoryError, open_result, run_warning

BROKEN, USAGE, UNREADABLE, NOT_WRITTEN = 1, 2, HistoryError.code, 74

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Histories (.h5).")]
File = Annotated[Path, typer.Argument(metavar="FILE", help="History (.h5).")]
AsJson = Annotated[bool, option("--json", "Write JSON, for scripts.")]


def complain(message: str) -> None:
    """Write a message to stderr."""
    typer.echo(f"evolvent-post: {message}", err=True)


def fail_to_write(path: Path, error: OSError) -> NoReturn:
    """End the command: a file could not be written."""
    complain(f"{path}: cannot be written ({error.strerror or error})")
    raise typer.Exit(NOT_WRITTEN)


def refuse(message: str) -> NoReturn:
    """End the command: what was asked for cannot be."""
    complain(message)
    raise typer.Exit(USAGE)


def open_with_warning(path: Path, *kinds: str) -> xr.Dataset:
    """Open a history, or a file of one of these kinds; say if its run did not end well."""
    history = open_result(path, *(kinds or (HISTORY,)))
    warning = run_warning(history)
    if warning:
        complain(f"{path}: {warning}")
    return history
