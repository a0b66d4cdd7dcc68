"""What cannot be done, and files that are written whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

FAILED_CASES, USAGE, BAD_INPUT, NOT_WRITTEN, INTERRUPTED = 1, 2, 3, 74, 75


class EvolventError(Exception):
    """What cannot be done; the message names the thing, the value, the place and the remedy.

    Parameters
    ----------
    message : one line.
    code : exit code of the program that meets it.
    """

    def __init__(self, message: str, code: int = BAD_INPUT) -> None:
        super().__init__(message)
        self.code = code


class HistoryError(EvolventError):
    """A file that cannot be used as a history; the message names it and says why."""


class SweepError(EvolventError):
    """What evolvent-sweep cannot do."""

    def at(self, place: str) -> SweepError:
        """The same error with a place in front, unless it begins with that place."""
        message = str(self)
        return SweepError(
            message if message.startswith(place) else f"{place}: {message}", self.code
        )


def reason_of(error: Exception) -> str:
    """What an error of the system or a library says, in one line."""
    return getattr(error, "strerror", None) or " ".join(str(error).split())


@contextmanager
def needing(extra: str, what: str, code: int = BAD_INPUT) -> Iterator[None]:
    """Say what needs a library that is not there, and how to get it.

    Raises
    ------
    SweepError
        It could not be imported.
    """
    try:
        yield
    except ImportError as error:
        raise SweepError(
            f"{what}; install it with: pip install 'evolvent[{extra}]'", code
        ) from error


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Say which file or folder it is that cannot be written.

    Raises
    ------
    EvolventError
        It cannot be written.
    """
    try:
        yield
    except OSError as error:
        raise EvolventError(
            f"{path}: cannot be written ({reason_of(error)})", NOT_WRITTEN
        ) from error


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Give the name of a file that replaces an older one when it is whole.

    Raises
    ------
    EvolventError
        It cannot be written.
    """
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        with writing(path):
            yield temporary
            temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
