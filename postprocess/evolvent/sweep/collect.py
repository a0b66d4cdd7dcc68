"""Collect all results of a sweep in one file, for xarray."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import h5netcdf
import h5py
import numpy as np
import xarray as xr

from evolvent.checksums import BROKEN, NONE, append_checksum, check
from evolvent.errors import UNREADABLE, SweepError, needing, reason_of, replacing, replacing_hdf5
from evolvent.sweep.design import Design
from evolvent.sweep.histories import add_histories, history_coordinates
from evolvent.sweep.journal import STATUSES, Records, read_records
from evolvent.version import __version__

FORMAT = 1
INTERNAL = ("shard", "history_check")  # columns of each case that are not written


def collect(
    folder: Path,
    design: Design,
    output: Path,
    *,
    copy_histories: bool = False,
    parquet: Path | None = None,
) -> Records:
    """Write the summary of a folder: dims (case), and (case, time) if there are histories.

    It contains all cases of the design, in order. Missing ones have the status "missing" and NaN
    for results, so that the summary of an unfinished sweep has the shape of the final one.

    Parameters
    ----------
    output : the summary; an older one is replaced when the new one is complete.
    copy_histories : copy them; else they stay in the shards and the summary refers to them.
    parquet : a copy of all variables with the dimension case alone, if given.

    Returns
    -------
    The collected records.

    Raises
    ------
    SweepError
        Journals that cannot be read, or a summary that cannot be written.
    """
    records = read_records(folder, design)
    summary = _summary(design, records)
    with replacing_hdf5(output, append_checksum) as stream:
        whole = summary
        if design.history_variables:
            whole = summary.merge(history_coordinates(folder, records))
        with h5netcdf.File(stream, "w") as target:
            whole.dump_to_store(xr.backends.H5NetCDFStore(target))
        if design.history_variables:
            with h5py.File(stream, "r+") as file:
                add_histories(file, folder, records, output.parent, copy_histories)
    if parquet is not None:
        _write_parquet(summary, parquet)
    return records


def open_summary(path: Path) -> xr.Dataset:
    """Open a summary.

    Returns
    -------
    Dataset with the dimension case: parameters (`role` "parameter"), results (`role` "result"),
    `status`, as numbers with CF flags, and `message`.

    Raises
    ------
    SweepError
        No such file, no summary, or of a newer format.
    """
    if not path.exists():
        raise SweepError(f"{path}: no such file; make it with `evolvent-sweep collect`")
    try:
        status = check(path)
        if status == BROKEN:
            raise SweepError(
                f"{path}: is damaged, or was changed: its checksum is wrong; collect it anew"
            )
        summary = xr.open_dataset(path, engine="h5netcdf", decode_times=False)
    except UNREADABLE as error:
        raise SweepError(f"{path}: is not a readable summary ({reason_of(error)})") from error
    if status == NONE:
        print(
            f"evolvent-sweep: warning: {path}: has no checksum, so damage would not be detected",
            file=sys.stderr,
        )
    number = summary.attrs.get("evolvent_summary_format")
    if number != FORMAT:
        summary.close()
        if number is None:
            raise SweepError(f"{path}: is not a summary (no attribute `evolvent_summary_format`)")
        raise SweepError(
            f"{path}: has summary format {number}, but this evolvent-sweep reads {FORMAT}; "
            "collect it again"
        )
    return summary


def _summary(design: Design, records: Records) -> xr.Dataset:
    """Variables with the dimension case alone."""
    number = {"long_name": "number of the case in the design, from 0"}
    variables: dict[str, Any] = {}
    for p in design.parameters:
        name = p.name if p.name not in records.cases else f"{p.name}_parameter"
        attributes: dict[str, Any] = {"units": p.units} if p.units else {}
        attributes |= {"role": "parameter", "path": p.path, "derived": np.int8(p.derived)}
        variables[name] = ("case", p.values, attributes)
    variables["case"] = ("case", np.arange(design.n_cases), number)
    for name, column in records.cases.items():
        if name not in INTERNAL:
            variables[name] = ("case", column.values, column.attributes)
    return xr.Dataset(
        variables,
        attrs={
            "Conventions": "CF-1.11",
            "title": design.title,
            "evolvent_summary_format": np.int64(FORMAT),
            "evolvent_version": " ".join(records.versions) or design.version,
            "collected_by": f"evolvent-sweep {__version__}",
            "case": design.case,
            "design": design.hash,
            "plan": design.plan,
            "method": design.method,
            "seed": np.int64(design.seed),
            "sampling": design.sampling_text,
            "window": np.array(design.window),
        },
    )


def _write_parquet(summary: xr.Dataset, path: Path) -> None:
    table = summary.to_dataframe()
    table["status"] = np.array(STATUSES, dtype=object)[table["status"].to_numpy()]
    with needing("parquet", f"{path}: Parquet needs pyarrow"), replacing(path) as temporary:
        table.to_parquet(temporary)
