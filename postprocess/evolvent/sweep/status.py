"""Status of a sweep: progress, failures with reasons, and estimated end."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evolvent.sweep.design import Design
from evolvent.sweep.folder import Shard, is_locked
from evolvent.sweep.journal import Counts, read_records

RECENT = 600.0  # averaging time of the rate [s]
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
MOST_LISTED = 20  # case numbers in a message


@dataclass(frozen=True)
class Reason:
    """Failures whose messages differ in numbers only."""

    count: int
    example: str  # the message of that case
    case: int  # the first such case


@dataclass(frozen=True)
class Status:
    """Status of a sweep."""

    counts: Counts
    repeated: int
    torn: int
    reasons: list[Reason]  # most frequent first
    running: list[Shard]
    rate: float  # recent cases per second, of all statuses; NaN if unknown
    finished_at: float  # Unix time [s]; NaN if unknown

    @property
    def is_complete(self) -> bool:
        """Whether every case is recorded."""
        return self.counts.missing == 0


def read_status(folder: Path, design: Design, now: float | None = None) -> Status:
    """Read the status of a folder.

    Parameters
    ----------
    now : Unix time [s]; current time by default.
    """
    records = read_records(folder, design, scalars=False)
    unfinished = np.flatnonzero(records.unfinished)
    messages = records.cases["message"].values[unfinished]
    now = time.time() if now is None else now
    running = [shard for shard in records.shards if is_locked(folder, shard)]
    missing = records.counts.missing
    rate = recent_rate(records.cases["recorded_at"].values, now if running else None)
    finished = now + missing / rate if running and missing and rate > 0.0 else float("nan")
    return Status(
        counts=records.counts,
        repeated=records.repeated.size,
        torn=records.torn,
        reasons=reasons(zip(unfinished.tolist(), messages, strict=True)),
        running=running,
        rate=rate,
        finished_at=finished,
    )


def recent_rate(recorded_at: np.ndarray, now: float | None) -> float:
    """Recent number of cases per second.

    Parameters
    ----------
    recorded_at : Unix times [s] of the records, NaN if missing.
    now : while the sweep runs; None for the rate up to the last record.
    """
    times = np.sort(recorded_at[np.isfinite(recorded_at)])
    if times.size < 2:
        return float("nan")
    end = times[-1] if now is None else max(now, times[-1])
    recent = times[times >= end - RECENT]
    if recent.size < 2 or end <= recent[0]:
        return 0.0 if recent.size == 0 else float("nan")
    # The interval starts at the end of the first case, which is not counted.
    return float((recent.size - 1) / (end - recent[0]))


def reasons(messages: Iterable[tuple[int, str]]) -> list[Reason]:
    """Reasons of failed or refused cases, most frequent first; numbers in messages are ignored.

    Parameters
    ----------
    messages : case indices in ascending order, with the message of each.
    """
    found: dict[str, Reason] = {}
    kinds: dict[str, str] = {}  # of earlier messages
    for case, message in messages:
        kind = kinds.get(message)
        if kind is None:
            kind = kinds.setdefault(message, NUMBER.sub("#", message))
        first = found.get(kind, Reason(0, message, case))
        found[kind] = Reason(first.count + 1, first.example, first.case)
    return sorted(found.values(), key=lambda reason: (-reason.count, reason.case))


def runs(numbers: np.ndarray | Sequence[int]) -> list[tuple[int, int]]:
    """First and last number of each run of consecutive numbers, in order."""
    ordered = np.sort(np.asarray(numbers, dtype=np.int64))
    parts = np.split(ordered, np.flatnonzero(np.diff(ordered) != 1) + 1)
    return [(int(part[0]), int(part[-1])) for part in parts]


def joined(runs: Sequence[tuple[int, int]], separator: str) -> str:
    """Format runs of numbers: 3, 7-12, 40."""
    return separator.join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def listed(cases: np.ndarray) -> str:
    """Format case numbers with runs combined: 3, 7-12, 40 and 17 more."""
    if len(cases) == 0:
        return "none"
    shown = runs(cases)[:MOST_LISTED]
    more = len(cases) - sum(last - first + 1 for first, last in shown)
    return joined(shown, ", ") + (f" and {more} more" if more else "")
