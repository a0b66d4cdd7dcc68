"""Results of the library as datasets of xarray: without a copy, and without a file."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Hashable, Mapping, Sequence
from ctypes import byref, c_char_p, c_int
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.library.binding import INTEGER, REAL, TEXT, Attribute, Variable, load

if TYPE_CHECKING:
    import xarray as xr

EVENTS = "events"  # of a result's `encoding`: what makes a dataset of its events
TYPES: dict[int, np.dtype[Any]] = {REAL: np.dtype("f8"), INTEGER: np.dtype("i4")}
KINDS = {number: kind.str for number, kind in TYPES.items()}


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


def _texts(variable: Variable, shape: tuple[int, ...]) -> tuple[bytes, ...]:
    return tuple(ctypes.cast(variable.values, ctypes.POINTER(c_char_p))[: shape[0]])


# What results have in common, such as names and units, is decoded once.
_text = lru_cache(4096)(bytes.decode)


@lru_cache(4096)
def _attributes(
    units: bytes, long_name: bytes, symbol: bytes, n_flags: int, meanings: bytes
) -> dict[Hashable, Any]:
    """The attributes of a variable; who puts them into one copies them, as xarray does."""
    attributes: dict[Hashable, Any] = {
        "units": units.decode(),
        "long_name": long_name.decode(),
        "symbol": symbol.decode(),
    }
    if n_flags > 0:
        attributes["flag_values"] = np.arange(n_flags, dtype=TYPES[INTEGER])
        attributes["flag_values"].flags.writeable = False  # shared by all results
        attributes["flag_meanings"] = meanings.decode()
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


@lru_cache(1024)
def _names(
    name: str, texts: tuple[bytes, ...], *attributes: Any
) -> tuple[xr.Variable, Mapping[Any, Any]]:
    """A coordinate of names, and its index."""
    import xarray as xr

    values = np.array([text.decode() for text in texts], dtype=np.str_)
    made = xr.Coordinates({name: xr.Variable((name,), values, _attributes(*attributes))})
    return made.variables[name], dict(made.xindexes)


def _assembled(
    record: Record, variables: Sequence[Variable], attrs: Mapping[Any, Any]
) -> xr.Dataset:
    import xarray as xr

    parts: dict[Hashable, xr.Variable] = {}
    coordinates: dict[Hashable, xr.Variable] = {}
    indexes: dict[Hashable, Any] = {}
    sizes: dict[Hashable, int] = {}
    for variable in variables:
        name, rank = _text(variable.name), variable.rank
        dimensions = tuple(map(_text, variable.dimensions[:rank]))
        shape = tuple(variable.lengths[:rank])
        sizes.update(zip(dimensions, shape, strict=True))
        told = (
            variable.units,
            variable.long_name,
            variable.symbol,
            variable.n_flags,
            variable.flag_meanings,
        )
        if variable.type == TEXT:
            names, index = _names(name, _texts(variable, shape), *told)
            coordinates[name] = names.copy(deep=False)
            indexes.update(index)
            continue
        values = np.asarray(_Values(record, variable.values, shape, KINDS[variable.type]))
        made = xr.Variable(dimensions, values, _attributes(*told), fastpath=True)
        if dimensions == (name,):
            indexed = xr.Coordinates({name: made})
            coordinates[name] = indexed.variables[name]
            indexes.update(indexed.xindexes)
        else:
            parts[name] = made
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
