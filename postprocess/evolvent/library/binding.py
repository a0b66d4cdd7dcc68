"""Binding of the C library, as declared in driver/library/include/evolvent/evolvent.h."""

from __future__ import annotations

import ctypes
import os
import shutil
import sysconfig
from collections.abc import Iterator
from ctypes import POINTER, c_char, c_char_p, c_double, c_int, c_longlong, c_size_t, c_void_p
from functools import cache
from pathlib import Path
from typing import Any, ClassVar

from evolvent.errors import USAGE, AnalysisError
from evolvent.version import __version__

VARIABLE = "EVOLVENT_LIBRARY"
NAME = "libevolvent.so.0"
MOST_DIMENSIONS = 5
ROOT_ARCS = 13
REAL, INTEGER, TEXT = range(3)


class Error(ctypes.Structure):
    """evolvent_error."""

    _fields_: ClassVar = [("code", c_int), ("place", c_char * 1280), ("message", c_char * 1024)]


class StaticRequest(ctypes.Structure):
    """evolvent_static_request."""

    _fields_: ClassVar = [
        ("mesh", c_char_p),
        ("torque", c_char_p),
        ("speed", c_char_p),
        ("points", c_char_p),
    ]


class RespondRequest(ctypes.Structure):
    """evolvent_respond_request."""

    _fields_: ClassVar = [("over", c_char_p), ("direction", c_char_p), ("periods", c_char_p)]


class ModesRequest(ctypes.Structure):
    """evolvent_modes_request."""

    _fields_: ClassVar = [("at", c_char_p), ("mesh_position", c_char_p), ("mean", c_int)]


class Variable(ctypes.Structure):
    """evolvent_variable."""

    _fields_: ClassVar = [
        ("name", c_char_p),
        ("units", c_char_p),
        ("long_name", c_char_p),
        ("symbol", c_char_p),
        ("rates", c_char_p),
        ("type", c_int),
        ("is_of_events", c_int),
        ("rank", c_int),
        ("dimensions", c_char_p * MOST_DIMENSIONS),
        ("lengths", c_size_t * MOST_DIMENSIONS),
        ("values", c_void_p),
        ("n_flags", c_int),
        ("flag_meanings", c_char_p),
    ]


class Attribute(ctypes.Structure):
    """evolvent_attribute."""

    _fields_: ClassVar = [
        ("name", c_char_p),
        ("type", c_int),
        ("text", c_char_p),
        ("real", c_double),
        ("integer", c_longlong),
    ]


_TEXTS = POINTER(c_char_p)
_INTS, _REALS = POINTER(c_int), POINTER(c_double)
_STOP, _ERROR, _RECORD = POINTER(c_int), POINTER(Error), POINTER(c_void_p)
# Result type and argument types of each procedure.
PROCEDURES: dict[str, tuple[Any, tuple[Any, ...]]] = {
    "evolvent_version": (c_char_p, ()),
    "evolvent_case_read": (c_void_p, (c_char_p, c_int, _TEXTS, _ERROR)),
    "evolvent_case_parse": (c_void_p, (c_char_p, c_char_p, c_int, _TEXTS, _ERROR)),
    "evolvent_case_free": (None, (c_void_p,)),
    "evolvent_run": (c_int, (c_void_p, _STOP, _RECORD, _ERROR)),
    "evolvent_static": (c_int, (c_void_p, POINTER(StaticRequest), _STOP, _RECORD, _ERROR)),
    "evolvent_root_influence": (
        c_int,
        (c_void_p, c_int, c_int, _INTS, _REALS, _INTS, _REALS, _REALS, _ERROR),
    ),
    "evolvent_respond": (
        c_int,
        (c_char_p, c_char_p, c_int, _TEXTS, POINTER(RespondRequest), _STOP, _RECORD, _ERROR),
    ),
    "evolvent_modes": (c_void_p, (c_void_p, POINTER(ModesRequest), _STOP, _ERROR)),
    "evolvent_show": (c_void_p, (c_void_p, _ERROR)),
    "evolvent_parameters": (c_void_p, (c_void_p, _ERROR)),
    "evolvent_datasheet": (c_void_p, (c_void_p, c_char_p, c_int, _ERROR)),
    "evolvent_text_free": (None, (c_void_p,)),
    "evolvent_record_variables": (POINTER(Variable), (c_void_p, POINTER(c_int))),
    "evolvent_record_attributes": (POINTER(Attribute), (c_void_p, POINTER(c_int))),
    "evolvent_record_layout": (c_void_p, (c_void_p, POINTER(c_size_t))),
    "evolvent_record_find": (POINTER(Variable), (c_void_p, c_char_p)),
    "evolvent_record_free": (None, (c_void_p,)),
}


def _candidates() -> Iterator[Path]:
    """Candidate paths of the library: beside the program, or in an installation."""
    beside = str(Path(sysconfig.get_path("scripts"), "evolvent"))
    for program in (os.environ.get("EVOLVENT_EXECUTABLE"), beside, shutil.which("evolvent")):
        if not program:
            continue
        folder = Path(program).resolve().parent
        yield folder / NAME
        for library in ("libexec/evolvent", "lib", "lib64", "lib/x86_64-linux-gnu"):
            yield folder.parent / library / NAME


@cache
def load() -> ctypes.CDLL:
    """Load the library: named by EVOLVENT_LIBRARY, near the program, or found by the loader.

    Raises
    ------
    AnalysisError
        It cannot be loaded, or is of another version than this package.
    """
    named = os.environ.get(VARIABLE)
    path = named or next(
        (str(candidate) for candidate in _candidates() if candidate.is_file()), NAME
    )
    try:
        library = ctypes.CDLL(path)
    except OSError as error:
        raise AnalysisError(
            USAGE, "", f"the library cannot be loaded ({error}); set {VARIABLE} to its path"
        ) from error
    for name, (result, arguments) in PROCEDURES.items():
        procedure = getattr(library, name)
        procedure.restype, procedure.argtypes = result, list(arguments)
    version = library.evolvent_version().decode()
    if __version__ not in ("unknown", version):
        raise AnalysisError(
            USAGE,
            path,
            f"is of version {version}, this package of {__version__}: use matching versions",
        )
    return library
