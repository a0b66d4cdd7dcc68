"""The histories of all cases as variables (case, time) of a summary.

The shards hold them, a row a case. A summary refers to the rows as virtual datasets, or copies
them: reading copies is faster, and they outlive the shards.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np

from evolvent.sweep.errors import SweepError
from evolvent.sweep.journal import Records

COPIED = 32 * 2**20  # bytes that are copied at a time


@dataclass(frozen=True)
class _Run:
    """Rows of a shard with a constant step that go to cases with a constant step."""

    first_row: int
    row_step: int
    first_case: int
    case_step: int
    count: int

    @property
    def rows(self) -> slice:
        return _slice(self.first_row, self.row_step, self.count)

    @property
    def cases(self) -> slice:
        return _slice(self.first_case, self.case_step, self.count)


@dataclass(frozen=True)
class _Source:
    path: Path
    runs: list[_Run]


def add_histories(
    file: h5py.File,
    cases: h5py.Dataset,
    folder: Path,
    records: Records,
    place: Path,
    copy: bool,
) -> None:
    """Add the histories of the shards to a summary.

    Parameters
    ----------
    file : the summary.
    cases : the scale of its dimension case.
    place : folder that the summary will be in; virtual datasets refer to the shards from there.
    copy : copy the values instead of referring to them.

    Raises
    ------
    SweepError
        Shards whose histories do not fit each other, or are no readable files.
    """
    one_split = len({shard.of for shard in records.shards}) <= 1
    sources: list[_Source] = []
    names: list[str] = []
    for number, shard in enumerate(records.shards):
        path = folder / f"{shard.stem}.h5"
        if not path.exists():
            continue
        try:
            with h5py.File(path, "r") as source:
                numbers = source["case"][:]
                if not names:
                    names = _copy_coordinates(source, file)
                elif not np.array_equal(source["time"][:], file["time"][:]):
                    raise SweepError(f"{path}: has other output times than the other shards")
        except (OSError, KeyError) as error:
            raise SweepError(f"{path}: is no readable file of histories ({error})") from error
        # Rows of missing cases are empty. Several shards have a row of a case only if the folder
        # was split in several ways: then that counts whose record does.
        of_shard = records.shard[numbers]
        rows = np.flatnonzero((of_shard == number) | ((of_shard == -1) & one_split))
        sources.append(_Source(path, list(_runs(rows, numbers[rows]))))
    for name in names:
        _add(file, cases, name, sources, place, copy)


def _copy_coordinates(source: h5py.File, file: h5py.File) -> list[str]:
    """Copy the scales of a shard, but its cases; return the names of the histories."""
    names = []
    for name, dataset in source.items():
        if dataset.is_scale and name != "case":
            source.copy(dataset, file, name, without_attrs=True)
            for key in ("units", "long_name", "symbol"):
                if key in dataset.attrs:
                    file[name].attrs[key] = dataset.attrs[key]
            file[name].make_scale(name)
        elif not dataset.is_scale:
            names.append(name)
    return names


def _add(
    file: h5py.File,
    cases: h5py.Dataset,
    name: str,
    sources: list[_Source],
    place: Path,
    copy: bool,
) -> None:
    with h5py.File(sources[0].path, "r") as first:
        pattern = first[name]
        shape = (cases.size, *pattern.shape[1:])
        kind = pattern.dtype
        scales = [axis[0].name.lstrip("/") for axis in list(pattern.dims)[1:]]
        attributes = {
            key: pattern.attrs[key]
            for key in ("units", "long_name", "symbol")
            if key in pattern.attrs
        }
    if copy:
        dataset = file.create_dataset(name, shape, kind, fillvalue=np.nan)
        for source in sources:
            with h5py.File(source.path, "r") as opened:
                for run in source.runs:
                    _copy_run(opened[name], dataset, run)
    else:
        layout = h5py.VirtualLayout(shape, kind)
        for source in sources:
            reference = os.path.relpath(source.path.resolve(), place.resolve())
            with h5py.File(source.path, "r") as opened:
                shard_shape = opened[name].shape
            virtual = h5py.VirtualSource(reference, name, shard_shape, kind)
            for run in source.runs:
                layout[run.cases] = virtual[run.rows]
        dataset = file.create_virtual_dataset(name, layout, fillvalue=np.nan)
    dataset.attrs.update(attributes)
    dataset.attrs["role"] = "history"
    dataset.attrs["_FillValue"] = np.array([np.nan], dtype=kind)
    dataset.dims[0].attach_scale(cases)
    for axis, scale in enumerate(scales, start=1):
        dataset.dims[axis].attach_scale(file[scale])


def _copy_run(source: h5py.Dataset, target: h5py.Dataset, run: _Run) -> None:
    size = max(int(np.prod(source.shape[1:])) * source.dtype.itemsize, 1)
    step = max(COPIED // size, 1)
    for begin in range(0, run.count, step):
        count = min(step, run.count - begin)
        rows = _slice(run.first_row + begin * run.row_step, run.row_step, count)
        cases = _slice(run.first_case + begin * run.case_step, run.case_step, count)
        target[cases] = source[rows]


def _runs(rows: np.ndarray, cases: np.ndarray) -> Iterator[_Run]:
    """Split rows and their cases into runs with constant steps, which HDF5 maps at once."""
    begin = 0
    row_steps, case_steps = np.diff(rows), np.diff(cases)
    # Where the step of either changes, a run ends.
    changes = np.flatnonzero((np.diff(row_steps) != 0) | (np.diff(case_steps) != 0)) + 1
    for end in [*changes.tolist(), rows.size - 1]:
        if end < begin or rows.size == 0:
            continue
        count = end - begin + 1
        row_step = int(row_steps[begin]) if count > 1 else 1
        case_step = int(case_steps[begin]) if count > 1 else 1
        if case_step < 1:  # HDF5 has no backward selections
            for one in range(begin, end + 1):
                yield _Run(int(rows[one]), 1, int(cases[one]), 1, 1)
        else:
            yield _Run(int(rows[begin]), row_step, int(cases[begin]), case_step, count)
        begin = end + 1


def _slice(first: int, step: int, count: int) -> slice:
    return slice(first, first + step * (count - 1) + 1, step)
