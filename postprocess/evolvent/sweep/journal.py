"""Records of each case in the journals of a folder.

`evolvent records` reads them: it skips lines that were truncated by a kill or a full disk, and
returns the latest of several records of a case.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from evolvent.errors import SweepError
from evolvent.sweep.design import Design
from evolvent.sweep.folder import Shard
from evolvent.sweep.program import call, find_program, last_message, started

# Values of the variable `status` and their meanings; 0 is a case without a record.
STATUSES = ("missing", "done", "failed", "refused")
MISSING, DONE, FAILED, REFUSED = range(4)
BLOCK = 2**21  # bytes of records that are parsed at a time
# Variables of the records by the keys of their lines: value of a missing case, and attributes.
FIELDS: dict[str, tuple[str, Any, dict[str, Any]]] = {
    "status": (
        "status",
        np.int8(MISSING),
        {
            "long_name": "status of the case",
            "flag_values": np.arange(len(STATUSES), dtype=np.int8),
            "flag_meanings": " ".join(STATUSES),
        },
    ),
    "message": ("message", "", {"long_name": "why the case failed or was refused"}),
    "exit": ("exit_code", np.int16(-1), {"long_name": "exit code of the case, -1 if missing"}),
    "at": (
        "recorded_at",
        np.nan,
        {"long_name": "when the case was finished, since 1970-01-01 00:00 UTC", "units": "s"},
    ),
    "history": ("history_check", "", {}),  # crc32 of its row in the stacked histories
    "journal": ("shard", np.int32(-1), {}),  # index of the shard that contains the record
}


@dataclass(frozen=True)
class Counts:
    """Number of cases by status, with one wording for all outputs."""

    done: int
    failed: int  # the integration ended early
    refused: int  # the case was invalid
    missing: int

    @property
    def unfinished(self) -> int:
        """Cases that are recorded, but did not finish."""
        return self.failed + self.refused

    @property
    def n_cases(self) -> int:
        """All cases of the design."""
        return self.done + self.unfinished + self.missing

    @property
    def unfinished_text(self) -> str:
        """Text with the cases that did not finish, by status."""
        kinds = f" ({self.failed} failed, {self.refused} refused)" if self.unfinished else ""
        return f"{self.unfinished} did not finish{kinds}"

    def __str__(self) -> str:
        """All counts in one line."""
        return (
            f"{self.n_cases} cases: {self.done} done, {self.unfinished_text}, "
            f"{self.missing} missing"
        )


def did_not_finish(status: np.ndarray) -> np.ndarray:
    """Whether each case is recorded, but failed or was refused."""
    return np.isin(status, (FAILED, REFUSED))


@dataclass(frozen=True)
class Column:
    """One variable of all cases."""

    values: np.ndarray  # (case)
    attributes: dict[str, Any]
    key: str  # of the lines


@dataclass(frozen=True)
class Records:
    """Records of the cases of a design."""

    cases: dict[str, Column]  # the variables of `FIELDS`, and the results if requested
    counts: Counts
    shards: list[Shard]  # those that have a journal
    rows: dict[Shard, int]  # lines of the journals
    versions: list[str]  # of evolvent
    repeated: np.ndarray  # cases that are recorded more than once
    torn: int  # truncated lines

    @property
    def recorded(self) -> np.ndarray:
        """Whether each case is recorded."""
        return np.asarray(self.cases["status"].values != MISSING)

    @property
    def unfinished(self) -> np.ndarray:
        """Whether each case failed or was refused."""
        return did_not_finish(self.cases["status"].values)

    @property
    def holes(self) -> np.ndarray:
        """Indices of the missing cases."""
        return np.flatnonzero(~self.recorded)


def read_records(folder: Path, design: Design, scalars: bool = True) -> Records:
    """Read the journals of a folder by the program.

    Parameters
    ----------
    folder : Path
        Folder of a sweep.
    design : Design
        Its design, as from `open_for_run`.
    scalars : bool, optional
        False omits the results, which takes less time and memory.

    Returns
    -------
    Records
        Status and results of every case.

    Raises
    ------
    SweepError
        A journal of another design, of another format, or that cannot be read.

    Examples
    --------
    >>> from pathlib import Path
    >>> from evolvent.sweep.folder import open_for_run
    >>> from evolvent.sweep.journal import read_records
    >>> from evolvent.sweep.program import find_program, program_version
    >>> folder = Path("torque")
    >>> design = open_for_run(Path("torque.h5"), folder, program_version(find_program()))
    >>> print(read_records(folder, design, scalars=False).counts)
    39 cases: 39 done, 0 did not finish, 0 missing
    """
    command = [str(find_program()), "records", str(folder), *([] if scalars else ["--brief"])]
    with started(command, stdout=subprocess.PIPE) as (process, said):
        assert process.stdout is not None
        head = process.stdout.readline()
        if head:
            records = _empty(folder, design, json.loads(head), scalars)
            while lines := process.stdout.readlines(BLOCK):
                # Parsing one list of many lines is faster than parsing each line.
                _take(records.cases, json.loads(b"[" + b",".join(lines) + b"]"))
        if process.wait() != 0:
            raise SweepError(said(), process.returncode)
    return records


def count_records(folder: Path) -> dict[str, int]:
    """Count the cases by status and the lines of the journals (`rows`), by the program.

    Raises
    ------
    SweepError
        A journal that cannot be read.
    """
    done = call(find_program(), "records", folder, "--counts")
    if done.returncode != 0:
        raise SweepError(last_message(done.stderr), done.returncode)
    return dict(json.loads(done.stdout))


def _empty(folder: Path, design: Design, head: dict[str, Any], scalars: bool) -> Records:
    """Create records in which all cases are missing."""
    n = design.n_cases
    rows = {Shard(one["of"], one["shard"]): one["rows"] for one in head["journals"]}
    heads = [journal["head"] for journal in head["journals"]]
    for shard, one in zip(rows, heads, strict=True):
        if one is not None and one["design"] != design.hash:
            raise SweepError(
                f"{folder / shard.stem}.jsonl: is of another design (its hash is "
                f"{one['design'][:12]}, not {design.hash[:12]})"
            )
    declared = {s["name"]: s for one in heads if one and scalars for s in one["scalars"]}
    cases: dict[str, Column] = {}
    for name, scalar in declared.items():
        attributes = {key: scalar[key] for key in ("units", "long_name") if scalar[key]}
        cases[name] = Column(np.full(n, np.nan), {"role": "result", **attributes}, name)
    for key, (name, nothing, attributes) in FIELDS.items():
        kind = object if isinstance(nothing, str) else None
        cases[name] = Column(np.full(n, nothing, dtype=kind), attributes, key)
    counts = {status: head[status] for status in STATUSES[DONE:]}
    return Records(
        cases=cases,
        counts=Counts(**counts, missing=n - sum(counts.values())),
        shards=list(rows),
        rows=rows,
        versions=sorted({str(one["evolvent"]) for one in heads if one}),
        repeated=np.array(head["repeated"], dtype=np.int64),
        torn=head["torn"],
    )


def _take(cases: dict[str, Column], rows: Sequence[dict[str, Any]]) -> None:
    """Store records at the indices of their cases."""
    indices = np.array([row["case"] for row in rows], dtype=np.int64)
    nothing = {key: "" for key, (_, value, _) in FIELDS.items() if value == ""}  # else None: NaN
    for name, column in cases.items():
        if name == "status":
            found: list[Any] = [STATUSES.index(row["status"]) for row in rows]
        else:
            found = [row.get(column.key, nothing.get(column.key)) for row in rows]
        column.values[indices] = np.array(found, dtype=column.values.dtype)
