"""Histories of all cases as variables (case, time) or (case, output_position) of a summary.

The shards contain them, one row per case. A summary refers to the rows as virtual datasets, or
copies them: copies are faster to read and remain valid without the shards.
"""

from __future__ import annotations

import os
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from evolvent.checksums import BROKEN, NONE, check
from evolvent.errors import UNREADABLE, SweepError, reason_of
from evolvent.sweep.journal import Records

COPIED = 32 * 2**20  # bytes copied at a time
COPIED_ATTRIBUTES = ("units", "long_name", "symbol")  # attributes copied to a summary

Run = tuple[range, range]  # rows of a shard, and the corresponding cases


def history_coordinates(folder: Path, records: Records) -> xr.Dataset:
    """Read the coordinates of the histories, except the cases, from the first shard that has some.

    Raises
    ------
    SweepError
        It is no readable file.
    """
    stacks = _stacks(folder, records)
    for _, path in stacks:
        _verify_checksum(path)
    for _, path in stacks:
        try:
            with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as stack:
                found = stack.coords.to_dataset().drop_vars("case").load()
        except UNREADABLE as error:
            raise _unreadable(path, error) from error
        for values in found.variables.values():
            values.attrs = {
                key: values.attrs[key] for key in COPIED_ATTRIBUTES if key in values.attrs
            }
            values.encoding = {"_FillValue": None}
        return found
    return xr.Dataset()


def add_histories(file: h5py.File, folder: Path, records: Records, base: Path, copy: bool) -> None:
    """Add the histories of the shards to a summary that has their coordinates.

    Parameters
    ----------
    file : the summary.
    base : final folder of the summary; virtual datasets refer to the shards relative to it.
    copy : copy the values instead of referring to them.

    Raises
    ------
    SweepError
        Shards whose histories are inconsistent, are no readable files, or are damaged; checksums
        of values are verified when they are copied.
    """
    one_split = len({shard.of for shard in records.shards}) <= 1
    has_check = records.cases["history_check"].values != ""
    sources: list[tuple[Path, list[Run]]] = []
    for number, path in _stacks(folder, records):
        try:
            with h5py.File(path, "r") as source:
                cases = source["case"][:]
                axis = "output_position" if "output_position" in source else "time"
                if axis not in file or not np.array_equal(source[axis][:], file[axis][:]):
                    raise SweepError(f"{path}: has other outputs than the other shards")
        except UNREADABLE as error:
            raise _unreadable(path, error) from error
        # Rows of missing cases are empty. Several shards have a row of a case only if the folder
        # was split in several ways: then the shard of the valid record counts.
        of_shard = records.cases["shard"].values[cases]
        is_there = (of_shard == number) | ((of_shard == -1) & one_split)
        if copy and has_check.any():  # a row without a checksum was not written completely
            is_there &= has_check[cases]
        rows = np.flatnonzero(is_there)
        sources.append((path, list(_runs(rows, cases[rows]))))
    if sources:
        with h5py.File(sources[0][0], "r") as first:
            checks = _Checks(records) if copy else None
            # The checksum covers a row in the order of the variables in the file.
            named = ((name, first[name]) for name in first)  # items() has None for what fails
            histories = [(name, one) for name, one in named if not one.is_scale]
            for name, pattern in sorted(histories, key=lambda one: one[1].id.get_offset() or 0):
                _add(file, name, pattern, sources, base, checks)
            if checks is not None:
                checks.compare(sources)


class _Checks:
    """Checksums of the copied rows, compared with those in the journals."""

    def __init__(self, records: Records) -> None:
        self.expected = records.cases["history_check"].values
        self.found = np.zeros(self.expected.size, dtype=np.uint32)

    def take(self, cases: range, values: np.ndarray) -> None:
        """Update the checksums with the next variable of some rows."""
        for case, row in zip(cases, values, strict=True):
            self.found[case] = zlib.crc32(row.tobytes(), int(self.found[case]))

    def compare(self, sources: list[tuple[Path, list[Run]]]) -> None:
        """Reject a row that differs from the written one.

        Raises
        ------
        SweepError
            It names the file and the case.
        """
        for path, runs in sources:
            for case in (case for _, cases in runs for case in cases):
                if self.expected[case] not in ("", f"{self.found[case]:08x}"):
                    raise SweepError(
                        f"{path}: the history of case {case} is damaged: its checksum is wrong; "
                        "run that case again (evolvent batch --cases)"
                    )


def _verify_checksum(path: Path) -> None:
    """Verify the checksum of a file before HDF5 reads it, which does not detect damage."""
    status = check(path)
    if status == BROKEN:
        raise SweepError(
            f"{path}: is damaged, or was changed: its checksum is wrong; run its cases again in "
            "another folder"
        )
    if status == NONE:
        print(
            f"evolvent-sweep: warning: {path}: has no checksum, so damage would not be detected",
            file=sys.stderr,
        )


def _stacks(folder: Path, records: Records) -> list[tuple[int, Path]]:
    """Files of histories, and the indices of their shards in the records."""
    paths = [folder / f"{shard.stem}.h5" for shard in records.shards]
    return [(number, path) for number, path in enumerate(paths) if path.exists()]


def _unreadable(path: Path, error: Exception) -> SweepError:
    return SweepError(f"{path}: is not a readable file of histories ({reason_of(error)})")


def _add(
    file: h5py.File,
    name: str,
    pattern: h5py.Dataset,
    sources: list[tuple[Path, list[Run]]],
    base: Path,
    checks: _Checks | None,
) -> None:
    """Add a variable with the layout of `pattern` and a row for each case.

    Parameters
    ----------
    checks : None to refer to the values; else they are copied and their checksums updated.
    """
    copy = checks is not None
    kind, shape = pattern.dtype, (file["case"].size, *pattern.shape[1:])
    layout = h5py.VirtualLayout(shape, kind)
    if copy:
        dataset = file.create_dataset(name, shape, kind, fillvalue=np.nan)
    for path, runs in sources:
        reference = os.path.relpath(path.resolve(), base.resolve())
        with h5py.File(path, "r") as source:
            virtual = h5py.VirtualSource(reference, name, source[name].shape, kind)
            for rows, cases in runs:
                if checks is not None:
                    _copy(source[name], rows, dataset, cases, checks)
                else:
                    layout[_slice(cases)] = virtual[_slice(rows)]
    if not copy:
        dataset = file.create_virtual_dataset(name, layout, fillvalue=np.nan)
    dataset.attrs.update(
        {key: pattern.attrs[key] for key in COPIED_ATTRIBUTES if key in pattern.attrs}
    )
    dataset.attrs.update(role="history", _FillValue=np.array([np.nan], dtype=kind))
    for here, there in zip(dataset.dims, pattern.dims, strict=True):
        here.attach_scale(file[there[0].name])


def _copy(
    source: h5py.Dataset, rows: range, target: h5py.Dataset, cases: range, checks: _Checks
) -> None:
    size = max(int(np.prod(source.shape[1:])) * source.dtype.itemsize, 1)
    step = max(COPIED // size, 1)
    for begin in range(0, len(rows), step):
        part = slice(begin, begin + step)
        values = source[_slice(rows[part])]
        checks.take(cases[part], values)
        target[_slice(cases[part])] = values


def _runs(rows: np.ndarray, cases: np.ndarray) -> Iterator[Run]:
    """Split ascending rows and their cases into runs with constant steps, as HDF5 requires."""
    begin = 0
    # A run ends where either step changes.
    changes = np.flatnonzero((np.diff(rows, 2) != 0) | (np.diff(cases, 2) != 0)) + 1
    for end in [*changes.tolist(), rows.size - 1]:
        if end >= begin:
            second = min(begin + 1, end)
            row, case = (
                range(int(v[begin]), int(v[end]) + 1, int(v[second] - v[begin]) or 1)
                for v in (rows, cases)
            )
            yield row, case
            begin = end + 1


def _slice(run: range) -> slice:
    return slice(run.start, run.stop, run.step)
