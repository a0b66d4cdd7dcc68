"""Arguments, exit codes, messages and files common to the commands of evolvent-post."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from evolvent.commands.command_line import WrongUsageError, argument, option
from evolvent.commands.program import say
from evolvent.history import HISTORY, file_label, open_result, run_warning

if TYPE_CHECKING:
    import xarray as xr

BROKEN = 1

Files = Annotated[list[Path], argument("FILE", "Histories (.h5).")]
File = Annotated[Path, argument("FILE", "History (.h5).")]
AsJson = Annotated[bool, option("--json", "Write JSON, for scripts.")]


def complain(message: str) -> None:
    """Write a message to stderr."""
    say(f"evolvent-post: {message}", err=True)


def open_with_warning(path: Path, *kinds: str) -> xr.Dataset:
    """Open a history, or a file of one of these kinds; warn if its run did not end normally."""
    history = open_result(path, *(kinds or (HISTORY,)))
    warning = run_warning(history)
    if warning:
        complain(f"{path}: {warning}")
    return history


def labels(files: list[Path]) -> list[str]:
    """Label the files by the fewest trailing parts of their paths that make the labels unique."""
    for parts in range(1, 1 + max(len(path.parts) for path in files)):
        names = ["/".join([*p.parts[-parts:-1], file_label(p)]).lstrip("/") for p in files]
        if len(set(names)) == len(names):
            return names
    raise WrongUsageError("the same file is given twice", "FILE")
