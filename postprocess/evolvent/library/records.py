"""Results of the library as datasets of xarray: without a copy, and without a file."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Hashable, Mapping, Sequence
from ctypes import byref, c_char_p, c_int
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.library.binding import INTEGER, REAL, TEXT, Attribute, Variable, load

if TYPE_CHECKING:
    import xarray as xr

EVENTS = "events"  # of a result's `encoding`: what makes a dataset of its events
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


def dataset(handle: int) -> xr.Dataset:
    """The result of an analysis, which owns the record from here on.

    Its events, if it has any, are made when `open_events` asks for them: its `encoding` tells how.
    """
    library, record, n = load(), Record(handle), c_int()
    variables = library.evolvent_record_variables(handle, byref(n))[: n.value]
    attributes = library.evolvent_record_attributes(handle, byref(n))
    attrs = {one.name.decode(): _value_of(one) for one in attributes[: n.value]}
    events = [variable for variable in variables if variable.is_of_events]
    result = _assembled(
        record, [variable for variable in variables if not variable.is_of_events], attrs
    )
    if events:
        result.encoding[EVENTS] = Events(partial(_assembled, record, events, {}))
    return result


class Events:
    """What makes the dataset of events; a copy, as another process gets it, has it made."""

    def __init__(self, make: Callable[[], xr.Dataset]) -> None:
        self._make = make

    def __call__(self) -> xr.Dataset:
        """The dataset."""
        return self._make()

    def __reduce__(self) -> tuple[Any, ...]:
        return Events, (partial(_same, self._make()),)


def _same(events: xr.Dataset) -> xr.Dataset:
    return events


def _assembled(
    record: Record, variables: Sequence[Variable], attrs: Mapping[Any, Any]
) -> xr.Dataset:
    import xarray as xr

    parts: dict[str, xr.Variable] = {}
    coordinates: dict[str, xr.Variable] = {}
    for variable in variables:
        name, rank = variable.name.decode(), variable.rank
        dimensions = tuple(text.decode() for text in variable.dimensions[:rank])
        values = _values(record, variable, tuple(variable.lengths[:rank]))
        made = xr.Variable(dimensions, values, _attributes(variable), fastpath=True)
        (coordinates if dimensions == (name,) else parts)[name] = made
    return xr.Dataset(parts, coordinates, attrs)
