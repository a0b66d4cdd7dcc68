"""Cases as they are given from Python, as the texts that the library reads."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from ctypes import byref, c_char_p
from pathlib import Path
from typing import Any, TypeAlias

from evolvent.errors import USAGE, AnalysisError
from evolvent.library.binding import Error, load

Case: TypeAlias = str | Path | Mapping[str, Any]
Settings: TypeAlias = Mapping[str, Any] | Sequence[str] | None
NAME = "case"  # of a text in messages


def _plain(value: Any) -> Any:
    """What JSON does not know, such as a number or an array of numpy."""
    for method in ("tolist", "item"):
        if hasattr(value, method):
            return getattr(value, method)()
    raise TypeError(f"{value!r} is neither a number nor a text, list or mapping")


def value_text(value: Any) -> str:
    """A value as --set takes it."""
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _encoded(what: str, text: str | Path) -> bytes:
    encoded = os.fsencode(text)
    if b"\0" in encoded:
        raise AnalysisError(USAGE, what, "holds a character of code 0")
    return encoded


def encoded_or_none(what: str, value: Any) -> bytes | None:
    """A value of a request; None: it is not asked for."""
    return None if value is None else _encoded(what, value_text(value))


def _settings(given: Settings) -> list[bytes]:
    if isinstance(given, str):
        raise AnalysisError(
            USAGE, f"set={given!r}", 'must be {path: value} or a list of texts "PATH=VALUE"'
        )
    if isinstance(given, Mapping):
        given = [f"{path}={value_text(value)}" for path, value in given.items()]
    return [_encoded("set", option) for option in given or ()]


def error_of(error: Error, case: Case | None = None) -> AnalysisError:
    """What the library says."""
    place = error.place.decode(errors="replace")
    if isinstance(case, Mapping):  # it has no lines; the message names the key
        place = re.sub(rf"^{NAME}:\d+:\d+$", NAME, place)
    return AnalysisError(error.code, place, error.message.decode(errors="replace"))


@contextmanager
def opened(case: Case, settings: Settings) -> Iterator[Any]:
    """The library's handle of a case.

    Parameters
    ----------
    case : path, text of several lines, or the mapping that such a text stands for.

    Raises
    ------
    AnalysisError
        It is refused.
    """
    library, error = load(), Error()
    options = _settings(settings)
    texts = (c_char_p * len(options))(*options)
    if isinstance(case, Mapping) or (isinstance(case, str) and "\n" in case):
        text = _encoded(NAME, value_text(case))
        handle = library.evolvent_case_parse(NAME.encode(), text, len(options), texts, byref(error))
    else:
        path = _encoded(NAME, case)
        handle = library.evolvent_case_read(path, len(options), texts, byref(error))
    if handle is None:
        raise error_of(error, case)
    try:
        yield handle
    finally:
        library.evolvent_case_free(handle)
