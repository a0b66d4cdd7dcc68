"""Common layout of results, built once: names, dimensions, attributes, coordinates of names."""

from __future__ import annotations

import ctypes
from collections.abc import Hashable, Mapping, Sequence
from ctypes import byref, c_char_p, c_size_t
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from evolvent.library.binding import INTEGER, REAL, TEXT, Variable, load

if TYPE_CHECKING:
    import xarray as xr

TYPES: dict[int, np.dtype[Any]] = {REAL: np.dtype("f8"), INTEGER: np.dtype("i4")}
MOST = 256  # layouts in the cache


class Column(NamedTuple):
    """A numerical variable."""

    record_index: int  # index in the record
    name: str
    shape: int  # index into the shapes of the layout
    kind: str  # type string of numpy's array interface
    attributes: Mapping[Hashable, Any]  # shared by all results; copied into each dataset


@dataclass(frozen=True)
class Layout:
    """A dataset without its values."""

    columns: tuple[Column, ...]
    sizes: Mapping[str, tuple[int, int]]  # index of a variable, index of the dimension
    shapes: tuple[tuple[str, ...], ...]  # distinct dimension tuples of the columns
    coordinates: tuple[str, ...]  # in the order of the record
    names: Mapping[Hashable, xr.Variable]  # coordinates of names, shared as well
    indexes: Mapping[Hashable, Any]


@dataclass(frozen=True)
class Layouts:
    """Layouts of a record."""

    own: Layout
    events: Layout | None


_cache: dict[bytes, Layouts] = {}


def layouts_of(handle: int, variables: Any, n: int) -> Layouts:
    """Return the layouts of a record; cached if the library reports the same layout."""
    size = c_size_t()
    encoded = ctypes.string_at(load().evolvent_record_layout(handle, byref(size)), size.value)
    layouts = _cache.get(encoded)
    if layouts is None:
        numbered = list(enumerate(variables[:n]))
        events = [(record_index, one) for record_index, one in numbered if one.is_of_events]
        own = _layout(
            [(record_index, one) for record_index, one in numbered if not one.is_of_events]
        )
        layouts = Layouts(own, _layout(events) if events else None)
        if len(_cache) >= MOST:
            _cache.clear()
        _cache[encoded] = layouts
    return layouts


def _layout(variables: Sequence[tuple[int, Variable]]) -> Layout:
    columns: list[Column] = []
    sizes: dict[str, tuple[int, int]] = {}
    shapes: dict[tuple[str, ...], int] = {}
    coordinates: list[str] = []
    names: dict[Hashable, xr.Variable] = {}
    indexes: dict[Hashable, Any] = {}
    for record_index, variable in variables:
        name = variable.name.decode()
        dimensions = tuple(text.decode() for text in variable.dimensions[: variable.rank])
        for which, dimension in enumerate(dimensions):
            sizes.setdefault(dimension, (record_index, which))
        attributes = _attributes(variable)
        if dimensions == (name,):
            coordinates.append(name)
        if variable.type == TEXT:
            names[name], index = _names(name, _texts(variable), attributes)
            indexes.update(index)
        else:
            shape = shapes.setdefault(dimensions, len(shapes))
            columns.append(Column(record_index, name, shape, TYPES[variable.type].str, attributes))
    return Layout(tuple(columns), sizes, tuple(shapes), tuple(coordinates), names, indexes)


def _attributes(variable: Variable) -> dict[Hashable, Any]:
    attributes: dict[Hashable, Any] = {
        "units": variable.units.decode(),
        "long_name": variable.long_name.decode(),
        "symbol": variable.symbol.decode(),
    }
    if variable.rates:
        attributes["rates"] = variable.rates.decode()
    if variable.n_flags > 0:
        attributes["flag_values"] = np.arange(variable.n_flags, dtype=TYPES[INTEGER])
        attributes["flag_values"].flags.writeable = False  # shared by all results
        attributes["flag_meanings"] = variable.flag_meanings.decode()
    return attributes


def _texts(variable: Variable) -> list[str]:
    texts = ctypes.cast(variable.values, ctypes.POINTER(c_char_p))[: variable.lengths[0]]
    return [text.decode() for text in texts]


def _names(
    name: str, texts: Sequence[str], attributes: Mapping[Hashable, Any]
) -> tuple[xr.Variable, Mapping[Any, Any]]:
    """Create a coordinate of names, and its index."""
    import xarray as xr

    values = np.array(texts, dtype=np.str_)
    made = xr.Coordinates({name: xr.Variable((name,), values, attributes)})
    return made.variables[name], dict(made.xindexes)


def variable_of(
    dimensions: tuple[str, ...], values: np.ndarray, attributes: Mapping[Hashable, Any]
) -> xr.Variable:
    """Create `xr.Variable(dimensions, values, attributes)` without the checks of the constructor.

    A result has some hundred variables, and the checks take longer than all other work. If a
    variable of this xarray does not consist of exactly these four members, the constructor is used.
    """
    import xarray as xr

    if not _is_made_of_four():
        return xr.Variable(dimensions, values, attributes, fastpath=True)
    made: Any = object.__new__(xr.Variable)
    made._dims = dimensions
    made._data = values
    made._attrs = dict(attributes)
    made._encoding = None
    return made  # type: ignore[no-any-return]


@cache
def _is_made_of_four() -> bool:
    """Whether the constructor sets exactly the members that `variable_of` sets."""
    import xarray as xr

    values = np.zeros(1)
    made = xr.Variable(("x",), values, {"units": "m"}, fastpath=True)
    members = {name for kind in type(made).__mro__ for name in getattr(kind, "__slots__", ())}
    there = {name: getattr(made, name) for name in members if hasattr(made, name)}
    expected = {"_dims": ("x",), "_attrs": {"units": "m"}, "_encoding": None, "_data": values}
    return there == expected and there["_data"] is values and not getattr(made, "__dict__", None)
