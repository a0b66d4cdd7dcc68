"""Start-up, exit, error messages and printing common to evolvent-post and evolvent-sweep.

Start-up dominates the run time of a short command. A program therefore imports only the requested
command; its own help needs no command, and commands import libraries where they use them.
tests/commands/test_python_start.py lists the permitted imports.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

from evolvent.commands.command_line import (
    UnclearError,
    WrongUsageError,
    for_typer,
    grouped,
    option,
    read,
)
from evolvent.errors import (
    BAD_INPUT,
    HALF_WRITTEN,
    USAGE,
    EvolventError,
    file_of,
    is_hdf5_broken,
    is_of_system,
    reason_of,
)

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Column

HELP = ("-h", "--help")
OPTIONS = {
    "--version": "Show the version.",
    "--install-completion": "Install completion for the current shell.",
    "--show-completion": "Show completion for the current shell, to copy it or customize the "
    "installation.",
    ", ".join(HELP): "Show this message and exit.",
}
WIDTHS = (50, 78)  # of help, independent of the terminal


def make_program(
    name: str, package: str, commands: Mapping[str, str], text: str, unused: Sequence[str] = ()
) -> Callable[[], None]:
    """Build a program from its commands: each is the function of its name in the file of its name.

    Parameters
    ----------
    commands : description of each command, the first sentence of its help.
    text : help, with the exit codes. An `EvolventError` is one line on stderr and an exit code.
    unused : modules that no command uses.
    """

    def main() -> None:
        """Run the command line."""
        words = sys.argv[1:]
        completes = f"_{name.replace('-', '_')}_COMPLETE".upper() in os.environ
        if completes:
            words = []
        elif not words or words[0] in HELP:
            arguments = {"text": _help(name, text, commands), "err": not words}
            sys.exit(_run(say, arguments) or (0 if words else USAGE))
        elif words == ["--version"]:
            sys.exit(_run(say, {"text": _version(name)}))
        # Without a valid command name all are imported: for completion and for suggestions.
        named = words[:1] if words and words[0] in commands else list(commands)
        functions = [getattr(import_module(f"{package}.{one}"), one) for one in named]
        try:
            if len(functions) == 1:
                with suppress(UnclearError), _without(unused):
                    values = grouped(functions[0], read(functions[0], words[1:]))
                    sys.exit(_run(functions[0], values))
            _with_typer(name, functions, text)
        except WrongUsageError as error:
            _with_typer(name, functions, text, error)
        except EvolventError as error:
            complain(name, str(error))
            _end(error.code, error)
        except Exception as error:
            if not is_of_system(error):
                raise
            complain(name, f"{file_of(error)}cannot be read ({reason_of(error)})")
            _end(BAD_INPUT, error)

    return main


def _end(code: int, error: Exception) -> NoReturn:
    """Exit the program; at once if HDF5 would crash while closing its files."""
    if HALF_WRITTEN or is_hdf5_broken(error):
        sys.stdout.flush()
        os._exit(code)
    sys.exit(code)


@contextmanager
def _without(unused: Sequence[str]) -> Iterator[None]:
    """Hide modules that other libraries import only to test for their types.

    To test whether an array is a dask array, xarray imports dask; pandas uses pyarrow if installed:
    together 50 MB and a third of a second. If pandas or xarray is loaded already, nothing changes.
    """
    is_asked = {"pandas", "xarray", *unused} & set(sys.modules)
    absent: dict[str, Any] = {} if is_asked else dict.fromkeys(unused)
    sys.modules.update(absent)
    try:
        yield
    finally:
        for name in absent:
            sys.modules.pop(name, None)


def _run(function: Callable[..., None], values: Mapping[str, Any]) -> int:
    """Run a command; return the exit code."""
    try:
        function(**values)
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # the reader has closed the pipe
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    return 0


def _with_typer(
    name: str,
    functions: Sequence[Callable[..., None]],
    text: str,
    error: WrongUsageError | None = None,
) -> None:
    """Run typer for help, completion and error messages.

    Parameters
    ----------
    error : error raised by a command line that was parsed successfully.
    """
    import typer

    app = typer.Typer(
        no_args_is_help=True,
        rich_markup_mode=None,
        pretty_exceptions_enable=False,
        context_settings={"help_option_names": list(HELP)},  # of its commands, too
        help=text,
    )
    for function in functions:
        app.command()(for_typer(function, error))

    def options(
        version: Annotated[bool, option("--version", OPTIONS["--version"])] = False,
    ) -> None:
        if version:
            say(_version(name))
            raise typer.Exit

    app.callback(invoke_without_command=True)(for_typer(options))
    app(prog_name=name)


def _version(name: str) -> str:
    from evolvent.version import __version__

    return f"{name} {__version__}"


def _help(name: str, text: str, commands: Mapping[str, str]) -> str:
    """Return the help text of a program."""
    from textwrap import dedent, fill

    try:
        columns = int(os.environ.get("COLUMNS", 0)) or os.get_terminal_size().columns
    except (OSError, ValueError):  # no terminal
        columns = WIDTHS[1] + 2
    width = min(max(columns - 2, WIDTHS[0]), WIDTHS[1])
    first, _, rest = text.partition("\n\n")
    as_it_is = dedent(rest).replace("\b\n", "").rstrip()

    def listed(rows: Mapping[str, str]) -> str:
        column = 4 + max(map(len, rows))
        return "\n".join(
            fill(
                row, width,
                initial_indent=f"  {label}".ljust(column), subsequent_indent=" " * column,
                break_on_hyphens=False,
            )
            for label, row in rows.items()
        )  # fmt: skip

    return "\n\n".join(
        (
            f"Usage: {name} [OPTIONS] COMMAND [ARGS]...",
            fill(first, width, initial_indent="  ", subsequent_indent="  "),
            "\n".join(f"  {line}".rstrip() for line in as_it_is.splitlines()),
            f"Options:\n{listed(OPTIONS)}",
            f"Commands:\n{listed(commands)}",
        )
    )


def complain(name: str, message: str) -> None:
    """Write a message of a program to stderr."""
    say(f"{name}: {message}", err=True)


def say(text: object, err: bool = False) -> None:
    """Print and flush; to stderr as a single line, without unprintable characters."""
    shown = str(text).encode(errors="backslashreplace").decode()  # names may be invalid UTF-8
    if err:
        shown = "".join(c if c.isprintable() else " " for c in shown)
    print(shown, file=sys.stderr if err else sys.stdout, flush=True)


def new_console() -> Console:
    """Console for tables; in a file or pipe lines are not wrapped, for scripts."""
    from rich.console import Console

    return Console() if sys.stdout.isatty() else Console(width=160)


def right(header: str) -> Column:
    """Right-aligned column of a table, for numbers."""
    from rich.table import Column

    return Column(header, justify="right")


def json_number(value: float | None) -> float | str | None:
    """Value for JSON, which has no infinity and no NaN: they become text."""
    from math import isfinite

    if value is None:
        return None
    return float(value) if isfinite(value) else str(float(value))
