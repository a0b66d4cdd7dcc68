"""One file of all results of a sweep, for xarray."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr

from evolvent.sweep.design import TEXT, Design
from evolvent.sweep.errors import NOT_WRITTEN, SweepError
from evolvent.sweep.histories import add_histories
from evolvent.sweep.journal import STATUSES, Counts, Records, read_records
from evolvent.version import __version__

FORMAT = 1


@dataclass(frozen=True)
class Collected:
    """What was collected, and what has to be known of it."""

    counts: Counts
    holes: np.ndarray  # numbers of the cases that are missing
    repeated: np.ndarray  # numbers of the cases that are recorded more than once
    torn: int
    versions: tuple[str, ...]


def collect(
    folder: Path,
    design: Design,
    output: Path,
    *,
    copy_histories: bool = False,
    parquet: Path | None = None,
) -> Collected:
    """Write the summary of a folder: dims (case), and (case, time) if there are histories.

    Every case of the design is there, in its order. Missing ones have the status "missing" and
    NaN for results, so that a summary of a sweep that goes on has the shape of the final one.

    Parameters
    ----------
    output : the summary; an older one is replaced when the new one is whole.
    copy_histories : copy them; else they stay in the shards and the summary refers to them.
    parquet : a copy of all that has the dimension case alone, if given.

    Raises
    ------
    SweepError
        Journals that cannot be read, or a summary that cannot be written.
    """
    records = read_records(folder, design)
    temporary = output.with_name(f"{output.name}.{os.getpid()}.tmp")
    try:
        with h5py.File(temporary, "w", track_order=True) as file:
            _write_attributes(file, design, records)
            cases = _write_cases(file, design, records)
            if design.history_variables:
                add_histories(file, cases, folder, records, output.parent, copy_histories)
        temporary.replace(output)
    except OSError as error:
        reason = error.strerror or " ".join(str(error).split())
        raise SweepError(f"{output}: cannot be written ({reason})", NOT_WRITTEN) from error
    finally:
        temporary.unlink(missing_ok=True)
    if parquet is not None:
        _write_parquet(output, parquet)
    return Collected(
        counts=records.counts,
        holes=records.holes(),
        repeated=np.array(sorted(records.repeated), dtype=np.int64),
        torn=records.torn,
        versions=tuple(sorted(records.versions)),
    )


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
        summary = xr.open_dataset(path, engine="h5netcdf", decode_times=False)
    except (OSError, KeyError, ValueError) as error:
        reason = " ".join(str(error).split())
        raise SweepError(f"{path}: is no readable summary ({reason})") from error
    number = summary.attrs.get("evolvent_summary_format")
    if number != FORMAT:
        summary.close()
        if number is None:
            raise SweepError(f"{path}: is no summary (no attribute `evolvent_summary_format`)")
        raise SweepError(
            f"{path}: has summary format {number}, but this evolvent-sweep reads {FORMAT}; "
            "collect it anew"
        )
    return summary


def _write_attributes(file: h5py.File, design: Design, records: Records) -> None:
    file.attrs.update(
        {
            "Conventions": "CF-1.11",
            "title": design.title,
            "evolvent_summary_format": np.int64(FORMAT),
            "evolvent_version": " ".join(sorted(records.versions)) or design.version,
            "collected_by": f"evolvent-sweep {__version__}",
            "case": design.case,
            "design": design.hash,
            "plan": design.plan,
            "method": design.method,
            "seed": np.int64(design.seed),
            "sampling": design.sampling_text,
            "window": np.array(design.window),
        }
    )


def _write_cases(file: h5py.File, design: Design, records: Records) -> h5py.Dataset:
    """Write all variables with the dimension case alone; return its scale."""
    cases = file.create_dataset("case", data=np.arange(design.n_cases))
    cases.attrs["long_name"] = "number of the case in the design, from 0"
    cases.make_scale("case")

    def add(name: str, values: Any, kind: Any = None, **attributes: Any) -> None:
        dataset = file.create_dataset(name, data=values, dtype=kind)
        dataset.attrs.update(attributes)
        if dataset.dtype.kind == "f":
            dataset.attrs["_FillValue"] = np.array([np.nan], dtype=dataset.dtype)
        dataset.dims[0].attach_scale(cases)

    for p in design.parameters:
        name = p.name if p.name not in records.scalars else f"{p.name}_parameter"
        attributes: dict[str, Any] = {"units": p.units} if p.units else {}
        attributes |= {"role": "parameter", "path": p.path, "derived": np.int8(p.derived)}
        add(name, p.values, TEXT if p.is_text else None, **attributes)
    for scalar in records.scalars.values():
        attributes = {"units": scalar.units} if scalar.units else {}
        add(scalar.name, scalar.values, role="result", long_name=scalar.long_name, **attributes)
    add(
        "status",
        records.status,
        long_name="what became of the case",
        flag_values=np.arange(len(STATUSES), dtype=np.int8),
        flag_meanings=" ".join(STATUSES),
    )
    texts = np.array(records.messages, dtype=object)[records.message]
    add("message", texts, TEXT, long_name="why the case failed or was refused")
    add("exit_code", records.exit_code, long_name="exit code of the case, -1 if missing")
    add(
        "recorded_at",
        records.recorded_at,
        long_name="when the case was finished, since 1970-01-01 00:00 UTC",
        units="s",
    )
    return cases


def _write_parquet(summary: Path, path: Path) -> None:
    temporary = path.with_name(f"{path.name}.{os.getpid()}.tmp")
    try:
        with open_summary(summary) as data:
            flat = data[[name for name in data.variables if data[name].dims == ("case",)]]
            table = flat.to_dataframe()
        meanings = np.array(STATUSES, dtype=object)
        table["status"] = meanings[table["status"].to_numpy()]
        table.to_parquet(temporary)
        temporary.replace(path)
    except ImportError as error:
        raise SweepError(
            f"{path}: Parquet needs pyarrow; install it with: pip install 'evolvent[parquet]'"
        ) from error
    except OSError as error:
        raise SweepError(f"{path}: cannot be written ({error.strerror})", NOT_WRITTEN) from error
    finally:
        temporary.unlink(missing_ok=True)
