"""What the commands of evolvent-post share: arguments, exit codes, messages, files, tables."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Annotated, NoReturn

import typer
import xarray as xr
from rich.console import Console

from evolvent.history import open_history, run_warning

BROKEN, USAGE, UNREADABLE, NOT_WRITTEN = 1, 2, 3, 74

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Histories (.h5).")]
File = Annotated[Path, typer.Argument(metavar="FILE", help="History (.h5).")]
AsJson = Annotated[bool, typer.Option("--json", help="Write JSON, for scripts.")]


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


def open_with_warning(path: Path) -> xr.Dataset:
    """Open a history; say if its run did not end well."""
    history = open_history(path)
    warning = run_warning(history)
    if warning:
        complain(f"{path}: {warning}")
    return history


def new_console() -> Console:
    """Console for tables; into a file or pipe lines are not broken: scripts read them."""
    return Console() if sys.stdout.isatty() else Console(width=160)


def json_number(value: float | None) -> float | str | None:
    """JSON has no infinity and no NaN: they become text."""
    if value is None:
        return None
    return float(value) if math.isfinite(value) else str(float(value))
