"""C interface of the libraries under test, from the declarations in their sources.

The layout of a struct is read from the headers (`evl_...`) or from the `bind(c)` Fortran type; the
result type of a call from its declaration.
"""

from __future__ import annotations

import ctypes
import itertools
import re
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
TYPES: dict[str, Any] = {
    "int": ctypes.c_int,
    "double": ctypes.c_double,
    "bool": ctypes.c_bool,
    "char": ctypes.c_char,
}
POINTERS: dict[str, Any] = {
    "double": ctypes.POINTER(ctypes.c_double),
    "int": ctypes.POINTER(ctypes.c_int),
    "char": ctypes.c_char_p,
}


class Handle(ctypes.c_void_p):
    """Object created by a call; false if it is NULL."""


@cache
def _headers() -> str:
    texts = (path.read_text() for path in (ROOT / "src/include/evolvent").glob("*.h"))
    return re.sub(r"/\*.*?\*/", "", "".join(texts), flags=re.DOTALL)


@cache
def _fortran() -> str:
    paths = [path for folder in ("src", "tests") for path in (ROOT / folder).rglob("*.f90")]
    text = "".join(path.read_text() for path in paths)
    return re.sub(r"!.*", "", text).replace("&\n", "")


@cache
def _prototype(name: str) -> tuple[Any, list[str] | None]:
    """Result type of a call, and the kind of each argument passed by value, "" by address.

    None for C calls that only tests declare: their arguments are converted by ctypes.
    """
    header = re.search(rf"EVL_API (\w+) (\*?){name}\(([^;]*)\);", _headers())
    if header:
        given = [re.sub(r"^const ", "", one.strip()) for one in header[3].split(",")]
        values = ["" if re.search(r"[*[]", one) else one.split()[0] for one in given]
        return Handle if header[2] else TYPES.get(header[1], ctypes.c_int), values
    form = rf"(?:\(c_(\w+)\) function|subroutine) {name}\(([^)]*)\)(.*?)\n *end "
    found = re.search(form, _fortran(), re.DOTALL)
    if not found:
        return ctypes.c_int, None
    kinds = {
        key: kind
        for kind, keys in re.findall(r"\(c_(\w+)\), (?:intent\(in\), )?value :: (.*)", found[3])
        for key in re.split(r"[\s,]+", keys)
    }
    values = [kinds.get(key, "") for key in re.findall(r"\w+", found[2])]
    return TYPES.get(found[1] or "int", Handle), values


def fields(name: str, **sizes: int) -> list[tuple[str, Any]]:
    """Fields of a struct or type; `sizes` are the values of named array lengths."""
    if name.startswith("evl_"):
        (body,) = re.findall(rf"typedef struct {{([^}}]*)}} {name};", _headers())
        sizes |= {key: int(n) for key, n in re.findall(r"(EVL_\w+) = (\d+)", _headers())}
        declared = re.findall(r"(?:const\s+)?(\w+)()\s+([^;]*);", body)
    else:
        (body,) = re.findall(rf"type, bind\(c\) :: {name}\n(.*?)end type", _fortran(), re.DOTALL)
        declared = re.findall(r"\(c_(\w+)\)(?:, dimension\((\d+)\))? :: (.*)", body)
    result = []
    for kind, every, parts in declared:
        for star, key, extent in re.findall(r"(\*?)(\w+)\s*(?:[\[(]([^])]*)[\])])?[^,]*", parts):
            of_field = POINTERS.get(kind, ctypes.c_void_p) if star else TYPES[kind]
            for size in filter(None, (extent or every).split(",")):
                of_field *= eval(size, {}, sizes)  # the project's own sources
            result.append((key, of_field))
    return result


def _argument(kind: str, value: Any) -> Any:
    """Pass a number by value if so declared; arrays and structs by address."""
    if isinstance(value, np.ndarray):
        assert not kind
        assert value.flags.forc
        return ctypes.c_void_p(value.ctypes.data)
    if isinstance(value, ctypes.Structure):
        return ctypes.byref(value)
    is_plain = kind in TYPES and not isinstance(value, TYPES[kind])
    return TYPES[kind](value) if is_plain else value


class Library(ctypes.CDLL):
    """A library whose calls accept arrays, structs and numbers directly."""

    def __init__(self, path: str | Path) -> None:
        super().__init__(str(path))
        plain: Any = self._FuncPtr

        class Call(plain):  # type: ignore[misc]
            _flags_ = plain._flags_
            _restype_ = plain._restype_

            def __call__(self, *given: Any) -> Any:
                if self.kinds is not None:
                    pairs = zip(self.kinds, given, strict=True)
                    given = tuple(itertools.starmap(_argument, pairs))
                return super().__call__(*given)

            def __setattr__(self, name: str, value: Any) -> None:
                assert name == "kinds" or not hasattr(self, "kinds"), "all tests share it"
                super().__setattr__(name, value)

        self._FuncPtr: Any = Call

    def __getitem__(self, name: Any) -> Any:
        """Return a call by its name."""
        call: Any = super().__getitem__(name)
        call.restype, kinds = _prototype(name)
        call.kinds = kinds
        return call
