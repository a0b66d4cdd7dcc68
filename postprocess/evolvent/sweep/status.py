"""How far a sweep has come, what failed and why, and when it will be finished."""

from __future__ import annotations

import re
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evolvent.sweep.design import Design
from evolvent.sweep.folder import Shard, is_locked
from evolvent.sweep.journal import Counts, Records, read_records

RECENT = 600.0  # the rate is that of the last so many seconds
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
MOST_LISTED = 20  # case numbers in a message


@dataclass(frozen=True)
class Reason:
    """Failures that differ in their numbers only."""

    count: int
    example: str  # one of the messages
    case: int  # the first case that it happened to


@dataclass(frozen=True)
class Status:
    """How far a sweep has come."""

    counts: Counts
    repeated: int
    torn: int
    reasons: list[Reason]  # most frequent first
    running: list[Shard]
    rate: float  # cases a second lately, of all statuses; NaN if not known
    finished_at: float  # Unix time [s]; NaN if not known

    @property
    def is_complete(self) -> bool:
        """Whether every case is recorded."""
        return self.counts.missing == 0


def read_status(folder: Path, design: Design, now: float | None = None) -> Status:
    """Look at a folder.

    Parameters
    ----------
    now : Unix time [s]; that of the clock unless given.
    """
    records = read_records(folder, design, scalars=False)
    now = time.time() if now is None else now
    running = [shard for shard in records.shards if is_locked(folder, shard)]
    missing = records.counts.missing
    rate = recent_rate(records.recorded_at, now if running else None)
    finished = now + missing / rate if running and missing and rate > 0.0 else float("nan")
    return Status(
        counts=records.counts,
        repeated=len(records.repeated),
        torn=records.torn,
        reasons=reasons(records),
        running=running,
        rate=rate,
        finished_at=finished,
    )


def recent_rate(recorded_at: np.ndarray, now: float | None) -> float:
    """Cases a second.

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
    # The first case was finished when the clock of the others started.
    return float((recent.size - 1) / (end - recent[0]))


def reasons(records: Records) -> list[Reason]:
    """Why cases failed or were refused, most frequent first; numbers in messages do not matter."""
    bad = np.flatnonzero(records.unfinished)
    which, first, counts = np.unique(records.message[bad], return_index=True, return_counts=True)
    rows = zip(which.tolist(), first.tolist(), counts.tolist(), strict=True)
    return grouped(Reason(n, records.messages[which], int(bad[at])) for which, at, n in rows)


def grouped(reasons: Iterable[Reason]) -> list[Reason]:
    """Draw reasons that differ in their numbers only together; most frequent first."""
    groups: dict[str, Reason] = {}
    for reason in reasons:
        kind = NUMBER.sub("#", reason.example)
        known = groups.get(kind, reason)
        first = min(known, reason, key=lambda one: one.case)
        count = reason.count + (known.count if known is not reason else 0)
        groups[kind] = Reason(count, first.example, first.case)
    return sorted(groups.values(), key=lambda reason: (-reason.count, reason.case))


def listed(cases: np.ndarray) -> str:
    """Write case numbers with runs drawn together: 3, 7-12, 40 and 17 more."""
    numbers = np.sort(np.asarray(cases, dtype=np.int64))
    if numbers.size == 0:
        return "none"
    ends = np.flatnonzero(np.diff(numbers) != 1)
    starts = numbers[np.concatenate([[0], ends + 1])]
    stops = numbers[np.concatenate([ends, [numbers.size - 1]])]
    parts, shown = [], 0
    for start, stop in list(zip(starts.tolist(), stops.tolist(), strict=True))[:MOST_LISTED]:
        parts.append(str(start) if start == stop else f"{start}-{stop}")
        shown += stop - start + 1
    more = numbers.size - shown
    return ", ".join(parts) + (f" and {more} more" if more else "")
