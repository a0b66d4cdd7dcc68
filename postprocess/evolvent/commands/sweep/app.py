"""The command evolvent-sweep: its commands, and how it starts."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from evolvent.commands.sweep.collect import collect
from evolvent.commands.sweep.plan import plan
from evolvent.commands.sweep.plot import plot
from evolvent.commands.sweep.retry import retry
from evolvent.commands.sweep.run import run
from evolvent.commands.sweep.slurm import slurm
from evolvent.commands.sweep.status import status
from evolvent.sweep import console
from evolvent.sweep.errors import SweepError
from evolvent.version import __version__

COMMANDS = (plan, run, slurm, collect, status, retry, plot)

app = typer.Typer(
    no_args_is_help=True,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
    help="""Parameter sweeps: many cases of one gearbox, here or on a Slurm cluster.

    \b
    Exit codes:
       0  done
       1  done, but some cases failed or were refused, or would be
       2  wrong usage of the command line
       3  bad plan, design, folder or summary
      74  output could not be written
      75  interrupted; the same command goes on
    """,
)

for command in COMMANDS:
    app.command()(command)


def main() -> None:
    """Run the command line; an error is one line on stderr."""
    try:
        app(prog_name="evolvent-sweep")
    except SweepError as error:
        console.complain(str(error))
        sys.exit(error.code)


@app.callback(invoke_without_command=True)
def _options(
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        typer.echo(f"evolvent-sweep {__version__}")
        raise typer.Exit
