"""What is left of a list of cases to run again: python -m evolvent.sweep.left DIR LISTS SHARD OF.

A job of a retry that is requeued goes on with it. The first line of a list is the size that the
journal had when the list was written: what is recorded behind it was run again.
"""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable
from pathlib import Path

from evolvent.sweep.folder import Shard


def write_list(folder: Path, lists: Path, shard: Shard, cases: Iterable[int]) -> None:
    """Write the list of a shard of the sweep in `folder`."""
    journal = folder / f"{shard.stem}.jsonl"
    size = journal.stat().st_size if journal.exists() else 0
    text = "".join(f"{number}\n" for number in (size, *cases))
    (lists / f"{shard.stem}.txt").write_text(text, encoding="ascii")


def left(folder: Path, lists: Path, shard: Shard) -> list[int]:
    """Cases of the list of a shard that were not run since it was written."""
    size, *cases = map(int, (lists / f"{shard.stem}.txt").read_text(encoding="ascii").split())
    done = set()
    with (
        contextlib.suppress(FileNotFoundError),
        (folder / f"{shard.stem}.jsonl").open("rb") as file,
    ):
        file.seek(size)
        for line in file:
            with contextlib.suppress(ValueError):  # cut off by a kill
                done.add(json.loads(line).get("case"))
    return [case for case in cases if case not in done]


if __name__ == "__main__":
    index, of = map(int, sys.argv[3:5])
    for number in left(Path(sys.argv[1]), Path(sys.argv[2]), Shard(of, index)):
        print(number)
