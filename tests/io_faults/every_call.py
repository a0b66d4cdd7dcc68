"""Make every call of a command fail, one after the other, and tell what came of it.

    python tests/io_faults/every_call.py                    all commands, every call
    python tests/io_faults/every_call.py batch resume -k write -k fsync --most 9

Prints for each command how many faults were tried, in how many something that was recorded or a
file under its final name was lost, how many ended with a wrong code or without their one line, and
how many were not made good by the same command, or --resume, afterwards.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "postprocess")]

from io_faults.commands import commands  # noqa: E402
from io_faults.trial import KINDS, Command, Workshop  # noqa: E402
from io_faults.warm import starter  # noqa: E402

VERDICTS = ("tried", "lost", "code", "line", "again", "missed")


def try_all(
    command: Command,
    layer: Path,
    root: Path,
    kinds: tuple[str, ...] = KINDS,
    most: int | None = None,
) -> tuple[Counter[str], list[str]]:
    """Try the faults of a command, all or so many of each kind; count, and tell what is wrong."""
    counts: Counter[str] = Counter()
    reported: list[str] = []
    root = root.resolve()
    with starter(command.words, layer, root / "warm") as start:
        workshop = Workshop(command, layer, root / "trials", start)
        for fault in workshop.faults([kind for kind in kinds if kind in command.kinds], most):
            wrong = workshop.judge(fault)
            counts["tried"] += 1
            counts.update({one.split(":")[0] for one in wrong})
            reported += wrong
    return counts, reported


def main() -> int:
    """Try what is named; 0 if nothing is wrong."""
    build = Path(os.environ.get("EVOLVENT_EXECUTABLE", ROOT / "build" / "ci" / "evolvent"))
    known = commands(build)
    parser = argparse.ArgumentParser(description="Make every call of a command fail.")
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help=", ".join(known))
    parser.add_argument("-k", "--kind", action="append", choices=KINDS)
    parser.add_argument("--most", type=int, help="try so many of each kind in each process")
    given = parser.parse_args()
    layer = build.parent / "tests" / "libfaults.so"
    is_good = True
    for name in given.commands or known:
        kinds = tuple(given.kind or KINDS)
        with tempfile.TemporaryDirectory() as root:
            counts, reported = try_all(known[name], layer, Path(root), kinds, given.most)
        for line in reported:
            print(f"  {name}: {line}", flush=True)
        print(name, *(f"{verdict} {counts[verdict]}" for verdict in VERDICTS), flush=True)
        is_good &= not reported
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
