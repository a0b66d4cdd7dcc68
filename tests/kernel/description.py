"""Descriptions as in `evolvent/description.h`: the table of rows, and a case as entries.

A case is nested dicts and lists with the keys of the case file, values in SI units and radians.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, NamedTuple

from kernel.interface import Handle, Library, fields

NUMBER, INTEGER = 0, 1
NAMED, TEXT_TYPE, NAME, REFERENCE, REFERENCES, CHOICE, BLOCK, LIST, MAP = range(8, 17)
RADIANS_PER_DEGREE = 0.017453292519943295769


class Block(dict[str, Any]):
    """A block of a case, whose keys are also attributes."""

    __setattr__ = dict.__setitem__

    def __getattr__(self, key: str) -> Any:
        """Return the value of a key."""
        try:
            return self[key]
        except KeyError:
            raise AttributeError(key) from None


class _Row(ctypes.Structure):
    """`evl_row`."""

    _fields_ = fields("evl_row")


class _Kind(ctypes.Structure):
    """`evl_kind`."""

    _fields_ = fields("evl_kind")


class Entry(ctypes.Structure):
    """`evl_entry`."""

    _fields_ = fields("evl_entry")


class Parameter(ctypes.Structure):
    """`evl_parameter`."""

    _fields_ = fields("evl_parameter")


class Row(NamedTuple):
    """One key of a block."""

    index: int
    block: str
    key: str
    type: int
    unit: str
    text: str
    minimum: float
    maximum: float
    minimum_open: bool
    maximum_open: bool
    required: bool
    default_text: str
    words: str
    holds: str
    variants: str


class Kind(NamedTuple):
    """A law, or a kind of load or support, with its own rows."""

    name: str
    text: str
    source: str
    rows: list[Row]


def rows(library: Library) -> list[Row]:
    """All rows of the table."""
    n = library.evl_rows(0, None)
    table = (_Row * n)()
    assert library.evl_rows(n, table) == n
    return [
        Row(i, *(_plain(getattr(row, name)) for name in Row._fields[1:]))
        for i, row in enumerate(table)
    ]


def kinds(library: Library, block: str) -> list[Kind]:
    """Kinds of a block: contact, damping, friction, load or support."""
    n = library.evl_kinds(block.encode(), 0, None)
    table = (_Kind * n)()
    assert library.evl_kinds(block.encode(), n, table) == n
    of_block = [row for row in rows(library) if row.block == block]
    return [
        Kind(
            name,
            _plain(kind.text),
            _plain(kind.source),
            [row for row in of_block if name in row.variants.split()],
        )
        for kind in table
        for name in [_plain(kind.name)]
    ]


def _plain(value: Any) -> Any:
    return value.decode() if isinstance(value, bytes) else value


def in_unit(value: float, unit: str) -> float:
    """Return the value in the unit of a row that the kernel converts to this one, to the bit."""
    if unit != "deg" or not math.isfinite(value):
        return value
    degrees = math.degrees(value)
    near = (degrees, math.nextafter(degrees, math.inf), math.nextafter(degrees, -math.inf))
    return next((d for d in near if d * RADIANS_PER_DEGREE == value), degrees)


def entries(library: Library, case: dict[str, Any]) -> ctypes.Array[Entry]:
    """Convert a case to entries."""
    laid = list(_of_block(rows(library), "case", case, 1))
    return (Entry * len(laid))(*laid)


def create(library: Library, case: dict[str, Any], status: Any) -> Handle:
    """Create a description of a case; a null pointer if it is rejected."""
    laid = entries(library, case)
    made: Handle = library.evl_description_create(len(laid), laid, status)
    return made


@contextmanager
def described(library: Library, case: dict[str, Any], status: Any) -> Iterator[Handle]:
    """Create a description of a case, and free it afterwards."""
    description = create(library, case, status)
    yield description
    library.evl_description_delete(ctypes.byref(description))


def _of_block(table: list[Row], block: str, case: dict[str, Any], level: int) -> Iterator[Entry]:
    of_block = [row for row in table if row.block == block]
    variant = case.get(of_block[0].key, of_block[0].default_text)
    for key, value in case.items():
        named = [row for row in of_block if row.key == key]
        fits = [row for row in named if variant in row.variants.split()] or named
        assert fits, f"{block} has no {key}"
        yield from _of_key(table, fits[0], value, level)


def _of_key(table: list[Row], row: Row, value: Any, level: int) -> Iterator[Entry]:
    if row.type == BLOCK:
        yield _entry(row, level)
        yield from _of_block(table, row.holds, value, level + 1)
    elif row.type == LIST:
        for element in value:
            yield _entry(row, level, element.get("name", ""))
            yield from _of_block(table, row.holds, element, level + 1)
    elif row.type == MAP:
        for name, element in value.items():
            yield _entry(row, level, name)
            yield from _of_block(table, row.holds, element, level + 1)
    elif row.type == NAMED:
        for name, number in value.items():
            yield _entry(row, level, name, [number])
    elif row.type == REFERENCES:
        for name in value:
            yield _entry(row, level, name)
    elif isinstance(value, str):
        yield _entry(row, level, value)
    else:
        yield _entry(
            row,
            level,
            "",
            [float(v) for v in value] if hasattr(value, "__len__") else [float(value)],
        )


def _entry(
    row: Row, level: int, name: str = "", numbers: list[float] | tuple[float, ...] = ()
) -> Entry:
    given = [in_unit(number, row.unit) for number in numbers]
    return Entry(
        row.index, level, name.encode(), len(given), (ctypes.c_double * len(given))(*given)
    )
