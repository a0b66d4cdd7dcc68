"""What the journals of a folder record of each case.

`evolvent records` reads them: it passes over lines that were cut off by a kill or a full disk, and
tells the latest of several records of a case.
"""

from __future__ import annotations

import io
import json
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from evolvent.sweep.design import Design
from evolvent.sweep.errors import SweepError
from evolvent.sweep.folder import Shard
from evolvent.sweep.program import find_program, last_message

# Values of the variable `status` and their meanings; 0 is a case that no journal has.
STATUSES = ("missing", "done", "failed", "refused")
MISSING, DONE, FAILED, REFUSED = range(4)
BLOCK = 4096  # records that are turned into numbers at a time


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
    texts: dict[str, int] = field(default_factory=lambda: {"": 0})  # the messages' indices
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

    @property
    def messages(self) -> list[str]:
        """Messages by their index."""
        return list(self.texts)

    def holes(self) -> np.ndarray:
        """Numbers of the cases that are missing."""
        return np.flatnonzero(~self.recorded)


def read_records(folder: Path, design: Design, scalars: bool = True) -> Records:
    """Ask the program what the journals of a folder record.

    Parameters
    ----------
    scalars : False leaves the results out, which takes less time and memory.

    Raises
    ------
    SweepError
        A journal of another design, of another format, or that cannot be read.
    """
    command = [str(find_program()), "records", str(folder), *([] if scalars else ["--brief"])]
    with (
        tempfile.TemporaryFile("w+", errors="replace") as messages,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=messages) as process,
    ):
        assert process.stdout is not None
        head = process.stdout.readline()
        if head:
            records = _empty(folder, design, json.loads(head), scalars)
            # Doubles as they were written: the quick way of pandas rounds.
            blocks = pd.read_json(
                io.TextIOWrapper(process.stdout, "utf-8"),
                lines=True,
                chunksize=BLOCK,
                dtype=False,
                precise_float=True,
            )
            for block in blocks:
                _take(records, block)
        if process.wait() != 0:
            messages.seek(0)
            raise SweepError(last_message(messages.read()), process.returncode)
    return records


def _empty(folder: Path, design: Design, head: dict[str, Any], scalars: bool) -> Records:
    """Nothing is known of any case."""
    n = design.n_cases
    shards = [Shard(journal["of"], journal["shard"]) for journal in head["journals"]]
    heads = [journal["head"] for journal in head["journals"]]
    for shard, one in zip(shards, heads, strict=True):
        if one is not None and one["design"] != design.hash:
            raise SweepError(
                f"{folder / shard.stem}.jsonl: is of another design (its hash is "
                f"{one['design'][:12]}, not {design.hash[:12]})"
            )
    told = [s for one in heads if one and scalars for s in one["scalars"]]
    return Records(
        status=np.zeros(n, dtype=np.int8),
        exit_code=np.full(n, -1, dtype=np.int16),
        recorded_at=np.full(n, np.nan),
        shard=np.full(n, -1, dtype=np.int32),
        message=np.zeros(n, dtype=np.int32),
        scalars={
            name: Scalar(name, s["units"], s["long_name"], np.full(n, np.nan))
            for name, s in {s["name"]: s for s in told}.items()
        },
        shards=shards,
        versions={str(one["evolvent"]) for one in heads if one},
        repeated=set(head["repeated"]),
        torn=head["torn"],
    )


def _take(records: Records, block: pd.DataFrame) -> None:
    """Put records where their cases are."""
    cases = block["case"].to_numpy()
    texts = records.texts
    records.status[cases] = block["status"].map(STATUSES.index)
    records.exit_code[cases] = block["exit"]
    records.recorded_at[cases] = block["at"]
    records.shard[cases] = block["journal"]
    records.message[cases] = [texts.setdefault(text, len(texts)) for text in block["message"]]
    for name, scalar in records.scalars.items():
        if name in block:
            scalar.values[cases] = block[name].to_numpy(dtype=float)
