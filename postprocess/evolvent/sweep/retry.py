"""Run chosen cases again, each in the shard that it belongs to."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evolvent.sweep.errors import NOT_WRITTEN, SweepError
from evolvent.sweep.folder import COPY, Shard
from evolvent.sweep.journal import MISSING, Records
from evolvent.sweep.left import write_list
from evolvent.sweep.run import Tally, run_shards
from evolvent.sweep.slurm import SCRIPTS


def lists_of_cases(records: Records, cases: list[int]) -> dict[Shard, list[int]]:
    """Cases by the shard that recorded them; one that is missing by a shard of the newest split."""
    of_newest = records.shards[-1].of if records.shards else 1
    lists: dict[Shard, list[int]] = {}
    for case in cases:
        number = int(records.shard[case])
        of = records.shards[number].of if number >= 0 else of_newest
        lists.setdefault(Shard(of, case % of + 1), []).append(case)
    return dict(sorted(lists.items()))


def write_lists(records: Records, folder: Path, cases: list[int]) -> tuple[Path, list[Shard]]:
    """Write the lists of a retry on Slurm; return their folder, and the shards.

    Raises
    ------
    SweepError
        They cannot be written.
    """
    place = folder.absolute() / SCRIPTS / "lists"
    lists = lists_of_cases(records, cases)
    try:
        place.mkdir(parents=True, exist_ok=True)
        place = Path(
            tempfile.mkdtemp(prefix="", dir=place)
        )  # an earlier retry may wait for its own
        place.chmod(0o755)
        for shard, chosen in lists.items():
            write_list(folder, place, shard, chosen)
    except OSError as error:
        raise SweepError(f"{place}: cannot be written ({error.strerror})", NOT_WRITTEN) from error
    return place, list(lists)


def retry_cases(program: Path, folder: Path, records: Records, cases: list[int], jobs: int) -> int:
    """Run cases again that may be recorded already; the new records count.

    Parameters
    ----------
    records : of the folder.
    jobs : worker processes.

    Returns
    -------
    Exit code of the run: 0, 1 (cases did not finish) or 75 (interrupted).
    """
    lists = lists_of_cases(records, cases)
    shards = list(lists)
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as name:
        files = {shard: Path(name) / f"{shard.stem}.txt" for shard in shards}
        for shard, path in files.items():
            path.write_text("".join(f"{case}\n" for case in lists[shard]), encoding="ascii")
        chosen = np.isin(np.arange(records.status.size), cases)
        others = replace(records, status=np.where(chosen, MISSING, records.status))
        tally = Tally(folder, shards, others)
        return run_shards(program, folder / COPY, folder, shards, jobs, tally, files)
