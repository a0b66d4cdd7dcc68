"""What evolvent-post and evolvent-sweep share: how they start, end, complain and print."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Column

from evolvent.errors import EvolventError
from evolvent.version import __version__


def make_program(name: str, package: str, commands: Sequence[str], text: str) -> Callable[[], None]:
    """Make a program of its commands: each is the function of its name, in the file of its name.

    Parameters
    ----------
    text : help, with the exit codes. An `EvolventError` is one line on stderr and an exit code.
    """
    app = typer.Typer(
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": ["-h", "--help"]},  # of its commands, too
        help=text,
    )
    for command in commands:
        app.command()(getattr(import_module(f"{package}.{command}"), command))

    @app.callback(invoke_without_command=True)
    def _options(
        version: Annotated[bool, option("--version", "Show the version.")] = False,
    ) -> None:
        if version:
            typer.echo(f"{name} {__version__}")
            raise typer.Exit

    def main() -> None:
        """Run the command line."""
        try:
            app(prog_name=name)
        except EvolventError as error:
            typer.echo(f"{name}: {error}", err=True)
            sys.exit(error.code)

    return main


def option(shown: str, text: str, **more: Any) -> Any:
    """Describe an option as its help shows it: option("-o --output DIR", "Folder of the results.").

    Parameters
    ----------
    more : what else `typer.Option` takes.
    """
    *names, last = shown.split()
    if last.startswith("-"):
        return typer.Option(*names, last, help=text, **more)
    return typer.Option(*names, metavar=last, help=text, **more)


def new_console() -> Console:
    """Console for tables; into a file or pipe lines are not broken: scripts read them."""
    return Console() if sys.stdout.isatty() else Console(width=160)


def right(header: str) -> Column:
    """Column of a table whose texts stand at the right, as numbers do."""
    return Column(header, justify="right")


def json_number(value: float | None) -> float | str | None:
    """JSON has no infinity and no NaN: they become text."""
    if value is None:
        return None
    return float(value) if math.isfinite(value) else str(float(value))
