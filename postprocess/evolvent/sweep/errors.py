"""The error of every part of evolvent-sweep."""

from __future__ import annotations

FAILED_CASES, USAGE, BAD_INPUT, NOT_WRITTEN, INTERRUPTED = 1, 2, 3, 74, 75


class SweepError(Exception):
    """What cannot be done; the message names the thing, the value, the place and the remedy.

    Parameters
    ----------
    message : one line.
    code : exit code of the command that meets it.
    """

    def __init__(self, message: str, code: int = BAD_INPUT) -> None:
        super().__init__(message)
        self.code = code

    def at(self, place: str) -> SweepError:
        """The same error with a place in front, unless it begins with that place."""
        message = str(self)
        return SweepError(
            message if message.startswith(place) else f"{place}: {message}", self.code
        )
