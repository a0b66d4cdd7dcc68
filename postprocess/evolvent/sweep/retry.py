"""Run selected cases again, each in its own shard."""

from __future__ import annotations

import tempfile
from pathlib import Path

from evolvent.errors import replacing, writing
from evolvent.sweep.folder import COPY, Shard
from evolvent.sweep.journal import Records
from evolvent.sweep.run import Tally, Work, run_shards
from evolvent.sweep.slurm import SCRIPTS


def write_lists(records: Records, cases: list[int], target: Path) -> dict[Shard, Path]:
    """Write the lists of cases that each shard runs again, for `evolvent batch --cases`.

    A case is run again by the shard that recorded it; a missing one by a shard of the newest split.
    Cases recorded after the list was written are not repeated: a requeued cluster job continues
    with the remaining cases.

    Raises
    ------
    SweepError
        They cannot be written.
    """
    of_newest = records.shards[-1].of if records.shards else 1
    lists: dict[Shard, list[int]] = {}
    for case, number in zip(cases, records.cases["shard"].values[cases], strict=True):
        of = records.shards[number].of if number >= 0 else of_newest
        lists.setdefault(Shard(of, case % of + 1), []).append(case)
    files = {shard: target / f"{shard.stem}.txt" for shard in sorted(lists)}
    with writing(target):
        for shard, path in files.items():
            lines = [f"after {records.rows.get(shard, 0)}", *map(str, lists[shard])]
            with replacing(path) as temporary:
                temporary.write_text("\n".join([*lines, ""]), encoding="ascii")
    return files


def folder_of_lists(folder: Path) -> Path:
    """Create a folder for the lists of a retry on Slurm; an earlier retry may still need its own.

    Raises
    ------
    SweepError
        It cannot be made.
    """
    target = folder.absolute() / SCRIPTS / "lists"
    with writing(target):
        target.mkdir(parents=True, exist_ok=True)
        target = Path(tempfile.mkdtemp(prefix="", dir=target))
        target.chmod(0o755)
    return target


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
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as name:
        files = write_lists(records, cases, Path(name))
        tally = Tally(folder, records, again=int(records.recorded[cases].sum()))
        return run_shards(Work(program, folder / COPY, folder), list(files), jobs, tally, files)
