"""What the journals of a folder record of each case.

A journal has a line a finished case, in JSON. A line that was cut off by a kill or a full disk is
passed over. If a case is recorded several times, the latest record counts.
"""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from evolvent.sweep.design import Design
from evolvent.sweep.errors import SweepError
from evolvent.sweep.folder import Shard, shards_of

FORMAT = 1
# Values of the variable `status` and their meanings; 0 is a case that no journal has.
STATUSES = ("missing", "done", "failed", "refused")
MISSING, DONE, FAILED, REFUSED = range(4)
BLOCK = 4096  # lines that are turned into numbers at a time


@dataclass(frozen=True)
class Counts:
    """How many cases of a sweep became what: the same numbers and words wherever they are told."""

    done: int
    failed: int  # the integration ended early
    refused: int  # the case was no good
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
        """Those that did not finish, and what they are."""
        kinds = f" ({self.failed} failed, {self.refused} refused)" if self.unfinished else ""
        return f"{self.unfinished} did not finish{kinds}"

    def __str__(self) -> str:
        """All of them in one line."""
        return (
            f"{self.n_cases} cases: {self.done} done, {self.unfinished_text}, "
            f"{self.missing} missing"
        )


def count(status: np.ndarray) -> Counts:
    """Count cases by their status, an index of `STATUSES`."""
    counts = np.bincount(np.asarray(status, dtype=np.int64), minlength=len(STATUSES))
    missing, done, failed, refused = (int(n) for n in counts)
    return Counts(done, failed, refused, missing)


def did_not_finish(status: np.ndarray) -> np.ndarray:
    """Of each case whether it is recorded, but failed or was refused."""
    return np.isin(status, (FAILED, REFUSED))


@dataclass(frozen=True)
class Scalar:
    """A result of every case: its description and its values (case), NaN where there is none."""

    name: str
    units: str
    long_name: str
    values: np.ndarray


@dataclass
class Records:
    """What is known of each case of a design."""

    status: np.ndarray  # (case), index of `STATUSES`
    exit_code: np.ndarray  # (case), -1 if missing
    recorded_at: np.ndarray  # (case), Unix time [s], NaN if missing
    shard: np.ndarray  # (case), index of `shards` that the record is from, -1 if missing
    message: np.ndarray  # (case), index of `messages`
    messages: list[str] = field(default_factory=lambda: [""])
    scalars: dict[str, Scalar] = field(default_factory=dict)
    shards: list[Shard] = field(default_factory=list)
    versions: set[str] = field(default_factory=set)  # of evolvent
    repeated: set[int] = field(default_factory=set)  # cases that are recorded more than once
    torn: int = 0  # lines that were cut off

    @property
    def recorded(self) -> np.ndarray:
        """Of each case whether it is recorded."""
        return np.asarray(self.status != MISSING)

    @property
    def unfinished(self) -> np.ndarray:
        """Of each case whether it failed or was refused."""
        return did_not_finish(self.status)

    @property
    def counts(self) -> Counts:
        """How many cases became what."""
        return count(self.status)

    def holes(self) -> np.ndarray:
        """Numbers of the cases that are missing."""
        return np.flatnonzero(~self.recorded)


def read_records(folder: Path, design: Design, scalars: bool = True) -> Records:
    """Read all journals of a folder.

    Parameters
    ----------
    scalars : False leaves the results out, which takes less time and memory.

    Raises
    ------
    SweepError
        A journal of another design, of a newer format, or that cannot be read.
    """
    n = design.n_cases
    records = Records(
        status=np.zeros(n, dtype=np.int8),
        exit_code=np.full(n, -1, dtype=np.int16),
        recorded_at=np.full(n, np.nan),
        shard=np.full(n, -1, dtype=np.int32),
        message=np.zeros(n, dtype=np.int32),
        shards=shards_of(folder),
    )
    texts = {"": 0}
    for number, shard in enumerate(records.shards):
        path = folder / f"{shard.stem}.jsonl"
        reader = _Reader(path, records, number, design, texts, scalars)
        try:
            with path.open("rb") as file:
                reader.read(file)
        except OSError as error:
            raise SweepError(f"{path}: cannot be read ({error.strerror})") from error
    records.messages = list(texts)
    return records


# What a line begins and ends with, in the form that `evolvent batch` writes.
HEAD = re.compile(rb'\{"case":\d+,"status":"\w+","exit":-?\d+,"message":"(?:[^"\\]|\\.)*",')
AT = b'"at":'


def _head(line: bytes) -> dict[str, Any] | None:
    """Read a line without its results, several times faster; None if it is of another form."""
    head = HEAD.match(line)
    if head is None or not line.endswith(b"}\n"):
        return None
    try:
        row = json.loads(head[0] + line[line.rindex(AT) :])
    except ValueError:
        return None
    return row if isinstance(row, dict) else None


class _Reader:
    """Reads one journal into the records."""

    def __init__(
        self,
        path: Path,
        records: Records,
        shard: int,
        design: Design,
        texts: dict[str, int],
        scalars: bool,
    ) -> None:
        self.path, self.records, self.shard = path, records, shard
        self.design, self.texts, self.scalars = design, texts, scalars
        self.names: list[str] = []
        self.began = False

    def read(self, file: BinaryIO) -> None:
        block: dict[int, dict[str, Any]] = {}
        for row in self._rows(file):
            if "journal" in row:
                self._header(row)
                continue
            if not self.began:
                raise SweepError(f"{self.path}: is no journal (its first line says nothing of it)")
            case = row.get("case")
            if not isinstance(case, int) or not 0 <= case < self.design.n_cases:
                raise SweepError(
                    f"{self.path}: has case {case}, but the design has {self.design.n_cases}"
                )
            if case in block:
                self.records.repeated.add(case)
            block[case] = row
            if len(block) == BLOCK:
                self._take(block)
                block = {}
        self._take(block)

    def _rows(self, file: BinaryIO) -> Iterator[dict[str, Any]]:
        for line in file:
            row = None if self.scalars else _head(line)
            if row is None and line.endswith(b"\n"):
                with contextlib.suppress(ValueError):
                    row = json.loads(line)
            if isinstance(row, dict):
                yield row
            elif line.strip():
                self.records.torn += 1

    def _header(self, header: dict[str, Any]) -> None:
        if header["journal"] != FORMAT:
            raise SweepError(
                f"{self.path}: has journal format {header['journal']}, but this evolvent-sweep "
                f"reads format {FORMAT}; use the evolvent-sweep of its evolvent"
            )
        if header.get("design") != self.design.hash:
            raise SweepError(
                f"{self.path}: is of another design (its hash is "
                f"{str(header.get('design'))[:12]}, not {self.design.hash[:12]})"
            )
        self.records.versions.add(str(header.get("evolvent", "?")))
        self.began = True
        if not self.scalars:
            return
        self.names = [str(scalar["name"]) for scalar in header.get("scalars", [])]
        for scalar in header.get("scalars", []):
            name = str(scalar["name"])
            if name not in self.records.scalars:
                self.records.scalars[name] = Scalar(
                    name,
                    str(scalar.get("units", "")),
                    str(scalar.get("long_name", "")),
                    np.full(self.design.n_cases, np.nan),
                )

    def _take(self, block: dict[int, dict[str, Any]]) -> None:
        """Put rows where their cases are, unless a later record is there."""
        if not block:
            return
        records = self.records
        cases = np.fromiter(block, dtype=np.int64, count=len(block))
        rows = list(block.values())
        at = np.array([row.get("at") for row in rows], dtype=float)
        known = records.recorded[cases]
        records.repeated.update(cases[known].tolist())
        # In one journal the later line counts, whatever the clock said.
        elsewhere = known & (records.shard[cases] != self.shard)
        with np.errstate(invalid="ignore"):
            kept = ~(elsewhere & (at < records.recorded_at[cases]))
        cases, at = cases[kept], at[kept]
        rows = [row for row, k in zip(rows, kept.tolist(), strict=True) if k]
        records.status[cases] = [self._status(row) for row in rows]
        records.exit_code[cases] = [int(row.get("exit", -1)) for row in rows]
        records.recorded_at[cases] = at
        records.shard[cases] = self.shard
        records.message[cases] = [
            self.texts.setdefault(str(row.get("message", "")), len(self.texts)) for row in rows
        ]
        for name in self.names:
            records.scalars[name].values[cases] = [row.get(name) for row in rows]

    def _status(self, row: dict[str, Any]) -> int:
        status = row.get("status")
        if status not in STATUSES[1:]:
            raise SweepError(f"{self.path}: case {row['case']}: the status '{status}' is not known")
        return STATUSES.index(status)
