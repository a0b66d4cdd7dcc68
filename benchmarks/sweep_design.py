"""A design of a sweep for `evolvent batch`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import ArrayLike


def write_design(
    path: Path,
    version: str,
    case: str,
    columns: Mapping[str, ArrayLike],
    window: Sequence[float] = (np.nan, np.nan),
) -> None:
    """Write a design of a base case and of columns of values, one for each case.

    `version` is the version of the reading program.
    """
    values = {where: np.asarray(column) for where, column in columns.items()}
    digest = hashlib.sha256(case.encode())
    for where, column in values.items():
        digest.update(where.encode() + column.tobytes())
    with h5py.File(path, "w") as design:
        design.attrs.update(
            evolvent_design_format=1,
            evolvent_version=version,
            title="benchmark",
            case=case,
            hash=digest.hexdigest(),
            window=list(window),
            history_variables="",
            history_every=1,
            n_cases=len(next(iter(values.values()))),
        )
        for i, (where, column) in enumerate(values.items()):
            written = design.create_dataset(f"parameters/p{i}", data=column)
            written.attrs["path"] = where
