"""The command evolvent-post: its commands, and how it starts."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from evolvent.commands.post.animate import animate
from evolvent.commands.post.check import check
from evolvent.commands.post.common import UNREADABLE, complain
from evolvent.commands.post.compare import compare
from evolvent.commands.post.plot import plot
from evolvent.commands.post.report import report
from evolvent.history import HistoryError
from evolvent.version import __version__

COMMANDS = (animate, check, plot, report, compare)

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    help="""Check, draw and compare the histories that `evolvent run` writes.

    \b
    Exit codes:
       0  done
       1  an invariant is broken, or a difference is beyond the tolerance
       2  wrong usage of the command line
       3  a file is no readable history
      74  output could not be written
    """,
)

for command in COMMANDS:
    app.command()(command)


def main() -> None:
    """Run the command line; an error is one line on stderr."""
    try:
        app(prog_name="evolvent-post")
    except HistoryError as error:
        complain(str(error))
        sys.exit(UNREADABLE)


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(f"evolvent-post {__version__}")
        raise typer.Exit
