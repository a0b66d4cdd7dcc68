"""History that is read in pieces: constants at once, variables over time by rows.

A history of a million outputs may exceed the memory. Code that iterates over it processes one part
at a time and stores only the requested results, not the rows.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.history.names import missing_error, source_name

if TYPE_CHECKING:
    import h5py
    import xarray as xr

Values = np.ndarray
AT_ONCE = 32 * 2**20  # bytes of all variables in one part; only few are read at the same time
NO_VARIABLE = b"This is a netCDF dimension but not a netCDF variable"


@dataclass(frozen=True)
class Variable:
    """One variable in a file or in memory."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]  # of one row, if it is over time
    is_over_time: bool
    read: Callable[[int, int], Values]  # rows from, to; the whole variable if it is constant
    attrs: Mapping[str, Any]
    dims: Callable[[], tuple[str, ...]]


class Recording:
    """A history, or some rows of it.

    Parameters
    ----------
    source : name for messages.
    labels : names along dimensions, where there are any.
    rows : first row, and that after the last.
    block : rows of a part.
    """

    def __init__(
        self,
        source: str,
        attrs: Mapping[str, Any],
        sizes: Mapping[str, int],
        variables: Mapping[str, Variable],
        labels: Mapping[str, Callable[[], list[str]]],
        rows: tuple[int, int] | None = None,
        block: int | None = None,
    ) -> None:
        self.source, self.attrs, self.variables, self._labels = source, attrs, variables, labels
        self._rows = rows or (0, sizes.get("time", 0))
        self.n = self._rows[1] - self._rows[0]
        self.sizes = {**sizes, "time": self.n} if "time" in sizes else dict(sizes)
        self.block = block or max(AT_ONCE // max(self._row_bytes(), 1), 1)
        self._cache: dict[Any, Any] = {}

    def _row_bytes(self) -> int:
        return sum(
            v.dtype.itemsize * int(np.prod(v.shape))
            for v in self.variables.values()
            if v.is_over_time
        )

    def __contains__(self, name: str) -> bool:
        return name in self.variables

    def __getitem__(self, name: str) -> Values:
        """Return all rows of a variable."""
        return self.read(name, 0, self.n)

    def has_labels(self, dim: str) -> bool:
        """Whether a dimension has names."""
        return dim in self._labels

    def labels(self, dim: str) -> list[str]:
        """Names along a dimension; indices if it has none."""
        if dim in self._labels:
            return self._labels[dim]()
        return [str(i) for i in range(self.sizes[dim])]

    def read(self, name: str, begin: int, end: int) -> Values:
        """Return rows of a variable; the whole variable if it is constant.

        Raises
        ------
        HistoryError
            There is no such variable.
        """
        if name not in self.variables:
            raise missing_error(self.source, name)
        variable = self.variables[name]
        # Cache variables that are read repeatedly and are not larger than a part.
        key = name if not variable.is_over_time or self.n <= self.block else None
        if key is None:
            return variable.read(self._rows[0] + begin, self._rows[0] + end)
        if key not in self._cache:
            self._cache[key] = variable.read(*self._rows)
        values: Values = self._cache[key]
        return values[begin:end] if variable.is_over_time else values

    def parts(self) -> Iterator[Part]:
        """Iterate over all rows, block by block."""
        for begin in range(0, self.n, self.block):
            yield Part(self, begin, min(begin + self.block, self.n))

    def between(self, begin: float, end: float) -> Recording:
        """Rows of times from `begin` to `end`, both included."""
        time = self["time"]
        first = int(np.searchsorted(time, begin, "left"))
        return self.rows_from(first, max(int(np.searchsorted(time, end, "right")), first))

    def rows_from(self, first: int, last: int) -> Recording:
        """Rows from `first` to the one before `last`."""
        rows = (self._rows[0] + first, self._rows[0] + last)
        return Recording(
            self.source, self.attrs, self.sizes, self.variables, self._labels, rows, self.block
        )

    def once(self, function: Callable[[Recording], Any]) -> Any:
        """Result of a function of this recording, computed once."""
        if function not in self._cache:
            self._cache[function] = function(self)
        return self._cache[function]


@dataclass(frozen=True)
class Part:
    """Some rows of a recording."""

    recording: Recording
    begin: int
    end: int

    @property
    def n(self) -> int:
        """Number of rows."""
        return self.end - self.begin

    def __contains__(self, name: str) -> bool:
        return name in self.recording

    def __getitem__(self, name: str) -> Values:
        """Return rows of a variable; the whole variable if it is constant."""
        return self.recording.read(name, self.begin, self.end)


def joined(
    recording: Recording, values: Callable[[Part], Values], join: Callable[[Values, Values], Values]
) -> Values:
    """Combine the results of all parts, such as maxima by np.fmax."""
    found: Values | None = None
    for part in recording.parts():
        found = values(part) if found is None else join(found, values(part))
    assert found is not None
    return found


def largest(recording: Recording, values: Callable[[Part], Values]) -> Values:
    """Maximum over the rows (first axis); NaN is ignored."""
    return joined(recording, lambda part: np.fmax.reduce(values(part), axis=0), np.fmax)


def largest_size(recording: Recording, name: str) -> Values:
    """Maximum absolute value of a variable over the rows."""
    return largest(recording, lambda part: abs(part[name]))


def ever(recording: Recording, values: Callable[[Part], Values]) -> Values:
    """Whether a condition is true in any row (first axis)."""
    return joined(recording, lambda part: np.any(values(part), axis=0), np.logical_or)


def integral(recording: Recording, values: Callable[[Part], Values]) -> Values:
    """Integral over time by the trapezoidal rule.

    Summed row by row: the result is bitwise independent of the length of a part.
    """
    total: Values | None = None
    before: tuple[Values, Values] | None = None
    for part in recording.parts():
        time, height = part["time"], np.asarray(values(part), dtype=float)
        if before is not None:
            time = np.concatenate([before[0], time])
            height = np.concatenate([before[1], height])
        before = time[-1:].copy(), height[-1:].copy()
        step = np.diff(time).reshape(-1, *[1] * (height.ndim - 1))
        areas = step * 0.5 * (height[1:] + height[:-1])
        start = np.zeros(height.shape[1:]) if total is None else total
        total = np.cumsum(np.concatenate([start[np.newaxis], areas]), axis=0)[-1]
    return np.zeros(()) if total is None else total


def at_rows(recording: Recording, name: str, rows: Sequence[Values]) -> list[Values]:
    """Values of each line of a variable over time at its own ascending row indices.

    Parameters
    ----------
    rows : of each line, in the order of the indices along the other dimensions.
    """
    kind = recording.variables[name].dtype
    found = [np.empty(each.size, kind) for each in rows]
    for part in recording.parts():
        values = part[name].reshape(part.n, -1)
        for column, (each, line) in enumerate(zip(rows, found, strict=True)):
            first, last = np.searchsorted(each, (part.begin, part.end))
            line[first:last] = values[each[first:last] - part.begin, column]
    return found


def recording_of(history: xr.Dataset | Recording) -> Recording:
    """Wrap a dataset of xarray, as from `open_history`, for reading in pieces."""
    if isinstance(history, Recording):
        return history
    variables = {}
    for name, given in history.variables.items():
        over_time = "time" in given.dims
        one = given.transpose("time", ...) if over_time else given

        variables[str(name)] = _of_array(one, over_time)

    def named(dim: str) -> Callable[[], list[str]]:
        return lambda: [str(value) for value in history[dim].values]

    sizes = {str(dim): size for dim, size in history.sizes.items()}
    labels = {dim: named(dim) for dim in sizes if dim in history.coords and dim != "time"}
    return Recording(source_name(history), history.attrs, sizes, variables, labels)


def _of_array(one: xr.Variable, over_time: bool) -> Variable:
    def read(begin: int, end: int) -> Values:
        return np.asarray((one[begin:end] if over_time else one).values)

    def dims() -> tuple[str, ...]:
        return tuple(map(str, one.dims))

    shape = one.shape[1:] if over_time else one.shape
    return Variable(one.dtype, shape, over_time, read, one.attrs, dims)


def of_file(file: h5py.File, source: str) -> Recording:
    """Wrap the root group of an open file for reading in pieces."""
    import h5py

    members = ((name, file[name]) for name in file)  # items() has None for unreadable members
    datasets = {name: one for name, one in members if isinstance(one, h5py.Dataset)}
    sizes = {
        name: one.shape[0]
        for name, one in datasets.items()
        if one.shape and h5py.h5ds.is_scale(one.id)
    }
    n = sizes.get("time", -1)
    # The dimensions themselves are tested only if another dimension has the same length.
    is_clear = list(sizes.values()).count(n) <= 1

    def over_time(one: h5py.Dataset) -> bool:
        if not one.shape or one.shape[0] != n:
            return False
        if is_clear or one.name == "/time":
            return True
        return bool(len(one.dims[0])) and one.dims[0][0].name == "/time"

    def variable(one: h5py.Dataset) -> Variable:
        def dims() -> tuple[str, ...]:
            return tuple(dim[0].name.lstrip("/") if len(dim) else "" for dim in one.dims)

        def rows(begin: int, end: int) -> Values:
            return np.asarray(one[begin:end])

        def whole(*_: int) -> Values:
            return np.asarray(one[()])

        if over_time(one):
            return Variable(one.dtype, one.shape[1:], True, rows, one.attrs, dims)
        return Variable(one.dtype, one.shape, False, whole, one.attrs, dims)

    def named(one: h5py.Dataset) -> Callable[[], list[str]]:
        return lambda: [str(name) for name in one.asstr()[()]]

    labels = {
        name: named(datasets[name])
        for name in sizes
        if h5py.check_string_dtype(datasets[name].dtype)
    }
    attrs = {name: _plain(value) for name, value in file.attrs.items()}
    variables = {
        name: variable(one)
        for name, one in datasets.items()
        if name not in sizes or not one.attrs.get("NAME", b"").startswith(NO_VARIABLE)
    }
    return Recording(source, attrs, sizes, variables, labels)


def _plain(value: Any) -> Any:
    """An attribute as a text or a number, as in xarray."""
    if isinstance(value, np.ndarray) and value.size == 1:
        value = value.reshape(())[()]
    return value.decode() if isinstance(value, bytes) else value
