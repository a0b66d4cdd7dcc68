"""Results of the library as datasets of xarray: without a copy, and without a file."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Hashable, Mapping
from ctypes import byref, c_int
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.library.binding import REAL, TEXT, Attribute, Variable, load
from evolvent.library.layouts import Layout, layouts_of, variable_of

if TYPE_CHECKING:
    import xarray as xr

EVENTS = "events"  # of a result's `encoding`: what makes a dataset of its events
# Of the library's variables, what changes from result to result.
NUMBERS = np.dtype(
    {
        "names": ["lengths", "values"],
        "formats": [(np.uintp, Variable.lengths.size // ctypes.sizeof(ctypes.c_size_t)), np.uintp],
        "offsets": [Variable.lengths.offset, Variable.values.offset],
        "itemsize": ctypes.sizeof(Variable),
    }
)


class Record:
    """A record of the library, which goes when nobody has one of its arrays any more."""

    def __init__(self, handle: int) -> None:
        self.handle = handle
        self._free = load().evolvent_record_free

    def __del__(self) -> None:
        self._free(self.handle)


class _Values:
    """Numbers where the library has them."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.__array_interface__: dict[str, Any] = {"version": 3}

    def array(self, address: int, shape: tuple[int, ...], kind: str) -> np.ndarray:
        """Those at an address, as an array that keeps the record."""
        told = self.__array_interface__
        told["data"], told["shape"], told["typestr"] = (address, False), shape, kind
        return np.asarray(self)


def _value_of(attribute: Attribute) -> Any:
    if attribute.type == TEXT:
        return attribute.text.decode()
    return np.float64(attribute.real) if attribute.type == REAL else np.int64(attribute.integer)


def dataset(handle: int) -> xr.Dataset:
    """The result of an analysis, which owns the record from here on.

    Its events, if it has any, are made when `open_events` asks for them: its `encoding` tells how.
    """
    library, record, n = load(), Record(handle), c_int()
    attributes = library.evolvent_record_attributes(handle, byref(n))
    attrs = {one.name.decode(): _value_of(one) for one in attributes[: n.value]}
    variables = library.evolvent_record_variables(handle, byref(n))
    told = ctypes.string_at(variables, n.value * NUMBERS.itemsize)
    numbers = np.frombuffer(told, dtype=NUMBERS)
    layouts = layouts_of(handle, variables, n.value)
    result = _assembled(record, layouts.own, numbers, attrs)
    if layouts.events is not None:
        result.encoding[EVENTS] = Events(partial(_assembled, record, layouts.events, numbers, {}))
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
    record: Record, layout: Layout, numbers: np.ndarray, attrs: Mapping[Any, Any]
) -> xr.Dataset:
    import xarray as xr

    addresses, lengths, values = numbers["values"].tolist(), numbers["lengths"], _Values(record)
    sizes: dict[Hashable, int] = {
        dimension: int(lengths[where]) for dimension, where in layout.sizes.items()
    }
    shapes = [(shape, tuple(map(sizes.__getitem__, shape))) for shape in layout.shapes]
    parts: dict[Hashable, xr.Variable] = {}
    found: dict[Hashable, xr.Variable] = {
        name: names.copy(deep=False) for name, names in layout.names.items()
    }
    indexes = dict(layout.indexes)
    for place, name, shape, kind, attributes in layout.columns:
        dimensions, counts = shapes[shape]
        made = variable_of(dimensions, values.array(addresses[place], counts, kind), attributes)
        if dimensions == (name,):
            index = xr.indexes.PandasIndex.from_variables({name: made}, options={})
            found.update(index.create_variables({name: made}))
            indexes[name] = index
        else:
            parts[name] = made
    coordinates: dict[Hashable, xr.Variable] = {name: found[name] for name in layout.coordinates}
    return joined(parts, coordinates, indexes, sizes, dict(attrs))


def joined(
    parts: dict[Hashable, xr.Variable],
    coordinates: dict[Hashable, xr.Variable],
    indexes: dict[Hashable, Any],
    sizes: dict[Hashable, int],
    attrs: dict[Hashable, Any],
) -> xr.Dataset:
    """`xr.Dataset(parts, coordinates, attrs)` of variables that are known to fit each other.

    That constructor aligns and compares them, which takes longer than all else that is done with a
    result. xarray has no public way around it; where the inner one is not what it was, the public
    one serves.
    """
    import xarray as xr

    try:
        return _inner()({**parts, **coordinates}, set(coordinates), sizes, attrs, indexes)
    except (AttributeError, TypeError):
        return xr.Dataset(parts, coordinates, attrs)


def _inner() -> Callable[..., xr.Dataset]:
    import xarray as xr

    return xr.Dataset._construct_direct
