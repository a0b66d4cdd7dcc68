"""Calls of the library's procedures, with their interrupts, errors, warnings and results."""

from __future__ import annotations

import ctypes
import json
import sys
import warnings
from ctypes import byref, c_int, c_void_p
from typing import TYPE_CHECKING, Any

from evolvent.errors import CaseWarning
from evolvent.library.binding import Error, load
from evolvent.library.cases import Case, Settings, error_of, opened
from evolvent.library.waiting import call

if TYPE_CHECKING:
    from types import FrameType

    import xarray as xr

_DONE = 0


def dataset_of(case: Case, settings: Settings, procedure: str, *request: Any) -> xr.Dataset:
    """Call a procedure of the library for a case and return the recorded dataset."""
    with opened(case, settings) as handle:
        return recorded(case, procedure, handle, *request)


def recorded(case: Case, procedure: str, *arguments: Any) -> xr.Dataset:
    """Call a procedure of the library and return the recorded dataset."""
    library, error, record = load(), Error(), c_void_p()

    def work(stop: c_int) -> int:
        return int(
            getattr(library, procedure)(*arguments, byref(stop), byref(record), byref(error))
        )

    try:
        code = call(work)
    except BaseException:
        library.evolvent_record_free(record)
        raise
    result = None
    if record.value is not None:
        from evolvent.library.records import dataset

        result = dataset(record.value)
    if code != _DONE:
        refusal = error_of(error, case)
        refusal.history = result
        raise refusal
    assert result is not None
    _warn(result.attrs["warnings"].splitlines())
    return result


def _warn(texts: list[str]) -> None:
    """Issue warnings at the caller of the package's function."""
    for text in texts:
        warnings.warn(text, CaseWarning, stacklevel=_depth())


def _depth() -> int:
    """Stack level of the first frame outside this package, counted as for `warnings.warn`."""
    frame: FrameType | None = sys._getframe(1)
    depth = 1
    package = __name__.partition(".")[0]
    while frame is not None and frame.f_globals.get("__name__", "").partition(".")[0] == package:
        frame, depth = frame.f_back, depth + 1
    return depth


def json_result(case: Case, settings: Settings, procedure: str, *request: Any) -> dict[str, Any]:
    """Call a procedure of the library for a case, with interrupts, and return its JSON result."""
    if not request:
        return parsed(text_of(case, settings, procedure))
    library, error = load(), Error()
    with opened(case, settings) as handle:
        text = call(
            lambda stop: getattr(library, procedure)(handle, *request, byref(stop), byref(error))
        )
    return parsed(taken(text, case, error))


def text_of(case: Case, settings: Settings, procedure: str, *request: Any) -> str:
    """Call a procedure of the library for a case and return its text."""
    error = Error()
    with opened(case, settings) as handle:
        return taken(getattr(load(), procedure)(handle, *request, byref(error)), case, error)


def taken(text: int | None, case: Case, error: Error) -> str:
    """Copy a text of the library and release it."""
    if text is None:
        raise error_of(error, case)
    try:
        return ctypes.string_at(text).decode("utf-8", "replace")
    finally:
        load().evolvent_text_free(text)


def parsed(text: str) -> dict[str, Any]:
    """Parse a JSON object."""
    result: dict[str, Any] = json.loads(text)
    return result
