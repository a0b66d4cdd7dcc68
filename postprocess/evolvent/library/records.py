"""Results of the library as datasets of xarray: without a copy, and without a file."""

from __future__ import annotations

import ctypes
from collections.abc import Hashable
from ctypes import byref, c_char_p, c_int
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.library.binding import INTEGER, REAL, TEXT, Attribute, Variable, load

if TYPE_CHECKING:
    import xarray as xr

TYPES: dict[int, np.dtype[Any]] = {REAL: np.dtype("f8"), INTEGER: np.dtype("i4")}


class Record:
    """A record of the library, which goes when nobody has one of its arrays any more."""

    def __init__(self, handle: int) -> None:
        self.handle = handle
        self._free = load().evolvent_record_free

    def __del__(self) -> None:
        self._free(self.handle)


class _Values:
    """Numbers where the library has them."""

    def __init__(self, record: Record, address: int, shape: tuple[int, ...], kind: str) -> None:
        self.record = record
        self.__array_interface__ = {
            "version": 3,
            "data": (address, False),
            "shape": shape,
            "typestr": kind,
        }


def _values(record: Record, variable: Variable, shape: tuple[int, ...]) -> np.ndarray:
    if variable.type != TEXT:
        return np.asarray(_Values(record, variable.values, shape, TYPES[variable.type].str))
    texts = ctypes.cast(variable.values, ctypes.POINTER(c_char_p))
    return np.array([texts[i].decode() for i in range(shape[0])], dtype=np.str_)


def _attributes(variable: Variable) -> dict[Hashable, Any]:
    attributes: dict[Hashable, Any] = {
        "units": variable.units.decode(),
        "long_name": variable.long_name.decode(),
        "symbol": variable.symbol.decode(),
    }
    if variable.n_flags > 0:
        attributes["flag_values"] = np.arange(variable.n_flags, dtype=TYPES[INTEGER])
        attributes["flag_meanings"] = variable.flag_meanings.decode()
    return attributes


def _value_of(attribute: Attribute) -> Any:
    if attribute.type == TEXT:
        return attribute.text.decode()
    return np.float64(attribute.real) if attribute.type == REAL else np.int64(attribute.integer)


def datasets(handle: int) -> tuple[xr.Dataset, xr.Dataset | None]:
    """The result of an analysis, and its events if it has any; they own the record."""
    import xarray as xr

    library, record, n = load(), Record(handle), c_int()
    variables = library.evolvent_record_variables(handle, byref(n))
    parts: tuple[dict[str, Any], dict[str, Any]] = {}, {}
    coordinates: tuple[dict[str, Any], dict[str, Any]] = {}, {}
    for variable in variables[: n.value]:
        name, rank = variable.name.decode(), variable.rank
        dimensions = tuple(text.decode() for text in variable.dimensions[:rank])
        made = xr.Variable(
            dimensions,
            _values(record, variable, tuple(variable.lengths[:rank])),
            _attributes(variable),
        )
        to = coordinates if dimensions == (name,) else parts
        to[variable.is_of_events][name] = made
    attributes = library.evolvent_record_attributes(handle, byref(n))
    attrs = {one.name.decode(): _value_of(one) for one in attributes[: n.value]}
    result = xr.Dataset(parts[0], coordinates[0], attrs)
    return result, xr.Dataset(parts[1], coordinates[1]) if coordinates[1] else None
