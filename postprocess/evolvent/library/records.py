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

EVENTS = "events"  # key in a result's `encoding` of the function that makes its events
# Members of the library's variables that differ between results.
NUMBERS = np.dtype(
    {
        "names": ["lengths", "values"],
        "formats": [(np.uintp, Variable.lengths.size // ctypes.sizeof(ctypes.c_size_t)), np.uintp],
        "offsets": [Variable.lengths.offset, Variable.values.offset],
        "itemsize": ctypes.sizeof(Variable),
    }
)


class Record:
    """Record of the library, freed when none of its arrays is referenced any more."""

    def __init__(self, handle: int) -> None:
        self.handle = handle
        self._free = load().evolvent_record_free

    def __del__(self) -> None:
        self._free(self.handle)


class _Values:
    """Values in the memory of the library."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self.__array_interface__: dict[str, Any] = {"version": 3}

    def array(self, address: int, shape: tuple[int, ...], kind: str) -> np.ndarray:
        """Array at an address, with a reference to the record."""
        description = self.__array_interface__
        description["data"], description["shape"], description["typestr"] = (
            (address, False),
            shape,
            kind,
        )
        return np.asarray(self)


def _value_of(attribute: Attribute) -> Any:
    if attribute.type == TEXT:
        return attribute.text.decode()
    return np.float64(attribute.real) if attribute.type == REAL else np.int64(attribute.integer)


def dataset(handle: int) -> xr.Dataset:
    """Convert a record to the dataset of an analysis; the dataset owns the record.

    Its events, if any, are built on request of `open_events`, by a function in `encoding`.
    """
    library, record, n = load(), Record(handle), c_int()
    attributes = library.evolvent_record_attributes(handle, byref(n))
    attrs = {one.name.decode(): _value_of(one) for one in attributes[: n.value]}
    variables = library.evolvent_record_variables(handle, byref(n))
    description = ctypes.string_at(variables, n.value * NUMBERS.itemsize)
    numbers = np.frombuffer(description, dtype=NUMBERS)
    layouts = layouts_of(handle, variables, n.value)
    result = _assembled(record, layouts.own, numbers, attrs)
    if layouts.events is not None:
        result.encoding[EVENTS] = Events(partial(_assembled, record, layouts.events, numbers, {}))
    return result


class Events:
    """Function that builds the dataset of events; pickling builds and copies it."""

    def __init__(self, make: Callable[[], xr.Dataset]) -> None:
        self._make = make

    def __call__(self) -> xr.Dataset:
        """Build the dataset."""
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
    for record_index, name, shape, kind, attributes in layout.columns:
        dimensions, counts = shapes[shape]
        made = variable_of(
            dimensions, values.array(addresses[record_index], counts, kind), attributes
        )
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
    """Create `xr.Dataset(parts, coordinates, attrs)` from variables known to be consistent.

    That constructor aligns and compares them, which takes longer than all other work on a result.
    xarray has no public alternative. If the private constructor has changed, the public one is
    used.
    """
    import xarray as xr

    try:
        return _inner()({**parts, **coordinates}, set(coordinates), sizes, attrs, indexes)
    except (AttributeError, TypeError):
        return xr.Dataset(parts, coordinates, attrs)


def _inner() -> Callable[..., xr.Dataset]:
    import xarray as xr

    return xr.Dataset._construct_direct
