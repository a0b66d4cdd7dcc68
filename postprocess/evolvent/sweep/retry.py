"""Run chosen cases again, each in the shard that it belongs to."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evolvent.sweep.folder import COPY, Shard
from evolvent.sweep.journal import MISSING, Records
from evolvent.sweep.run import Tally, run_shards


def retry_cases(program: Path, folder: Path, records: Records, cases: list[int], jobs: int) -> int:
    """Run cases again that may be recorded already; the new records count.

    A case goes to the shard that recorded it, or if it is missing to one of the newest split.

    Parameters
    ----------
    records : of the folder.
    jobs : worker processes.

    Returns
    -------
    Exit code of the run: 0, 1 (cases failed) or 75 (interrupted).
    """
    of_newest = records.shards[-1].of if records.shards else 1
    lists: dict[Shard, list[int]] = {}
    for case in cases:
        number = int(records.shard[case])
        of = records.shards[number].of if number >= 0 else of_newest
        lists.setdefault(Shard(of, case % of + 1), []).append(case)
    shards = sorted(lists)
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as name:
        files = {shard: Path(name) / f"{shard.stem}.txt" for shard in shards}
        for shard, path in files.items():
            path.write_text("".join(f"{case}\n" for case in lists[shard]), encoding="ascii")
        chosen = np.isin(np.arange(records.status.size), cases)
        others = replace(records, status=np.where(chosen, MISSING, records.status))
        tally = Tally(folder, shards, others)
        return run_shards(program, folder / COPY, folder, shards, jobs, tally, files)
