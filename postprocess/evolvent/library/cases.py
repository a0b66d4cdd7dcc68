"""Conversion of cases and settings from Python objects to the texts that the library reads."""

from __future__ import annotations

import ctypes
import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from ctypes import byref, c_char_p
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from evolvent.errors import USAGE, AnalysisError
from evolvent.library.binding import Error, load

Case: TypeAlias = str | Path | Mapping[str, Any]
Settings: TypeAlias = Mapping[str, Any] | Sequence[str] | None
NAME = "case"  # of a text in messages


def _plain(value: Any) -> Any:
    """Convert objects that JSON does not support, such as a number or an array of numpy."""
    for method in ("tolist", "item"):
        if hasattr(value, method):
            return getattr(value, method)()
    raise TypeError(f"{value!r} is neither a number nor a text, list or mapping")


def value_text(value: Any, what: str = "") -> str:
    """Convert a value to text as --set takes it; `what` names it in messages.

    Raises
    ------
    AnalysisError
        It is, or contains, an object that has no meaning in a case.
    """
    try:
        return value if isinstance(value, str) else json.dumps(value, default=_plain)
    except (TypeError, ValueError) as error:
        raise AnalysisError(USAGE, what, str(error)) from error


def _encoded(what: str, text: str | os.PathLike[str]) -> bytes:
    try:
        encoded = os.fsencode(text)
    except UnicodeEncodeError as error:
        code = f"U+{ord(error.object[error.start]):04X}"
        raise AnalysisError(
            USAGE, what, f"holds the lone surrogate {code}, which is not a character; remove it"
        ) from error
    if b"\0" in encoded:
        raise AnalysisError(USAGE, what, "holds a character of code 0")
    return encoded


def encoded_or_none(what: str, value: Any) -> bytes | None:
    """Encode a value of a request; None means not requested."""
    return None if value is None else _encoded(what, value_text(value, what))


def _settings(given: Settings) -> list[bytes]:
    if isinstance(given, Mapping):
        given = [f"{path}={value_text(value, str(path))}" for path, value in given.items()]
    texts = list(given or ()) if isinstance(given, Iterable | None) else [given]
    if isinstance(given, str) or not all(isinstance(text, str) for text in texts):
        raise AnalysisError(
            USAGE, f"set={given!r}", 'must be {path: value} or a list of texts "PATH=VALUE"'
        )
    return [_encoded("set", text) for text in texts]


def error_of(error: Error, case: Case | None = None) -> AnalysisError:
    """Convert an error of the library to an exception."""
    place = error.place.decode(errors="replace")
    if isinstance(case, Mapping):  # it has no lines; the message names the key
        place = re.sub(rf"^{NAME}:\d+:\d+$", NAME, place)
    return AnalysisError(error.code, place, error.message.decode(errors="replace"))


@dataclass(frozen=True)
class Source:
    """Source of a case for the library."""

    name: bytes  # path, or name of the text in messages
    text: bytes | None  # None: read the file
    options: ctypes.Array[c_char_p]  # as after --set


def source_of(case: Case, settings: Settings, name: str = NAME) -> Source:
    """Convert the arguments of a caller.

    Parameters
    ----------
    case : path, text of several lines, or the equivalent mapping.
    name : of a text, in messages.

    Raises
    ------
    AnalysisError
        It cannot be a case.
    """
    given = _settings(settings)
    options = (c_char_p * len(given))(*given)
    if isinstance(case, Mapping) or (isinstance(case, str) and "\n" in case):
        return Source(_encoded(NAME, name), _encoded(NAME, value_text(case, NAME)), options)
    if not isinstance(case, str | os.PathLike):
        raise AnalysisError(
            USAGE,
            f"{NAME}={case!r}",
            "must be the path of a case file, its text, or the equivalent mapping",
        )
    return Source(_encoded(NAME, case), None, options)


@contextmanager
def opened(case: Case, settings: Settings, name: str = NAME) -> Iterator[Any]:
    """Open a case, as for `source_of`, and yield the library's handle.

    Raises
    ------
    AnalysisError
        The case is rejected.
    """
    library, error = load(), Error()
    source = source_of(case, settings, name)
    set_options = len(source.options), source.options
    if source.text is None:
        handle = library.evolvent_case_read(source.name, *set_options, byref(error))
    else:
        handle = library.evolvent_case_parse(source.name, source.text, *set_options, byref(error))
    if handle is None:
        raise error_of(error, case)
    try:
        yield handle
    finally:
        library.evolvent_case_free(handle)
