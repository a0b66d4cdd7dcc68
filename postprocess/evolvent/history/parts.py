"""History of a long run that is still in parts: a folder NAME.h5.parts.

Its closed parts, part-0001.h5 and so on, form one history up to the run's last checkpoint.
docs/guides/long_runs.md describes the folder.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from evolvent.errors import HistoryError
from evolvent.history.recording import Recording, Values, Variable, of_file

if TYPE_CHECKING:
    import h5py
    import xarray as xr

PART = re.compile(r"part-(\d{4,})\.h5")


def closed_parts(folder: Path) -> list[Path]:
    """Files of the closed parts, in order.

    Raises
    ------
    HistoryError
        There is none, or one is missing.
    """
    numbered = {int(m[1]): path for path in folder.iterdir() if (m := PART.fullmatch(path.name))}
    if not numbered:
        raise HistoryError(f"{folder}: has no closed part yet")
    missing = next((i for i in range(1, max(numbered) + 1) if i not in numbered), None)
    if missing is not None:
        raise HistoryError(f"{folder}: part-{missing:04d}.h5 is missing")
    return [numbered[i] for i in sorted(numbered)]


# ---- in pieces -------------------------------------------------------------------------------


class _Files:
    """Files, one open at a time: sequential reading opens each once."""

    def __init__(self, paths: Sequence[Path]) -> None:
        self.paths = paths
        self._index, self._file = -1, None

    def open(self, index: int) -> h5py.File:
        import h5py

        if self._index != index or self._file is None:
            self.close()
            self._file = h5py.File(self.paths[index], "r", rdcc_nbytes=0)
            self._index = index
        return self._file

    def close(self) -> None:
        if self._file is not None:
            self._file.close()
        self._file = None


@contextmanager
def recording_of_parts(folder: Path, source: str) -> Iterator[Recording]:
    """Read all closed parts as one recording.

    Raises
    ------
    HistoryError
        As `closed_parts`.
    OSError, KeyError
        A part cannot be read.
    """
    import h5py

    paths = closed_parts(folder)
    lengths = []
    for path in paths:
        with h5py.File(path, "r") as file:
            lengths.append(int(file["time"].shape[0]))
    starts = np.concatenate([[0], np.cumsum(lengths)])
    files = _Files(paths)
    with h5py.File(paths[0], "r", rdcc_nbytes=0) as first, h5py.File(paths[-1], "r") as last:
        like, end = of_file(first, source), of_file(last, source)
        attrs = {**like.attrs, **{k: end.attrs[k] for k in end.attrs if k.startswith("status")}}

        def rows(name: str) -> Callable[[int, int], Values]:
            def read(begin: int, end: int) -> Values:
                pieces = [
                    files.open(i)[name][max(begin - starts[i], 0) : end - starts[i]]
                    for i in range(len(paths))
                    if starts[i] < end and starts[i + 1] > begin
                ]
                return np.concatenate(pieces) if pieces else first[name][:0]

            return read

        variables: dict[str, Variable] = {
            name: replace(one, read=rows(name)) if one.is_over_time else one
            for name, one in like.variables.items()
        }
        sizes = {**like.sizes, "time": int(starts[-1])}
        labels = {dim: _named(like, dim) for dim in like.sizes if like.has_labels(dim)}
        try:
            yield Recording(source, attrs, sizes, variables, labels)
        finally:
            files.close()


def _named(recording: Recording, dim: str) -> Callable[[], list[str]]:
    return lambda: recording.labels(dim)


# ---- as a dataset ------------------------------------------------------------------------------


def joined_dataset(
    parts: Sequence[xr.Dataset], axis: str, source: str, shifted: str | None = None
) -> xr.Dataset:
    """Join datasets along an axis; values are read on first use, part by part.

    Parameters
    ----------
    shifted : a counter along the axis that continues from part to part.
    """
    import xarray as xr
    from xarray.core.indexing import LazilyIndexedArray

    first = parts[0]
    joined: dict[Any, xr.Variable] = {}
    for name, one in first.variables.items():
        if not one.dims or one.dims[0] != axis:
            joined[name] = one
        elif name == shifted:
            n = sum(part.sizes[axis] for part in parts)
            joined[name] = xr.Variable(one.dims, np.arange(n, dtype=one.dtype), one.attrs)
        elif name == axis:
            values = np.concatenate([part.variables[name].values for part in parts])
            joined[name] = xr.Variable(one.dims, values, one.attrs)
        else:
            lazy = LazilyIndexedArray(_lazy([part.variables[name] for part in parts]))
            joined[name] = xr.Variable(one.dims, lazy, one.attrs, one.encoding)
    ends = {k: v for k, v in parts[-1].attrs.items() if str(k).startswith("status")}
    whole = xr.Dataset(
        {name: one for name, one in joined.items() if name not in first.coords},
        {name: one for name, one in joined.items() if name in first.coords},
        {**first.attrs, **ends},
    )
    whole.encoding["source"] = source

    def close() -> None:
        for part in parts:
            part.close()

    whole.set_close(close)
    return whole


def _lazy(parts: Sequence[xr.Variable]) -> Any:
    """Concatenate variables to one lazily read array of xarray."""
    from xarray.backends import BackendArray
    from xarray.core.indexing import IndexingSupport, explicit_indexing_adapter

    starts = np.concatenate([[0], np.cumsum([part.shape[0] for part in parts])])

    def read(key: tuple[Any, ...]) -> Values:
        rows, *rest = key
        if not isinstance(rows, slice):
            index = int(np.searchsorted(starts, rows, "right")) - 1
            return np.asarray(parts[index][(rows - int(starts[index]), *rest)].values)
        begin, end, step = rows.indices(int(starts[-1]))
        if step < 0:
            length = len(range(begin, end, step))
            ahead = slice(begin + (length - 1) * step, begin + 1, -step) if length else slice(0, 0)
            return read((ahead, *rest))[::-1]
        pieces = []
        for part, start, stop in zip(parts, starts[:-1], starts[1:], strict=True):
            skipped = max(0, -(-(int(start) - begin) // step))  # rows of earlier parts
            local = slice(
                begin + skipped * step - int(start), min(end, int(stop)) - int(start), step
            )
            if local.start < local.stop:
                pieces.append(np.asarray(part[(local, *rest)].values))
        return np.concatenate(pieces) if pieces else np.asarray(parts[0][(slice(0, 0), *rest)])

    class Joined(BackendArray):
        shape = (int(starts[-1]), *parts[0].shape[1:])
        dtype = parts[0].dtype

        def __getitem__(self, key: Any) -> Values:
            found: Values = explicit_indexing_adapter(key, self.shape, IndexingSupport.BASIC, read)
            return found

    return Joined()
