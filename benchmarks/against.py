"""Processor time and memory of this tree relative to another revision.

    benchmarks/against REVISION [--rows WORDS] [--turns N] [--json FILE]

Builds the revision beside the present tree, both as ./quickstart does (build/against/REVISION and
build/release), and runs the rows of against_rows.py in alternation: whole processes, one after the
other, the order changed from turn to turn. Prints the median of the ratios, present over past, with
its bootstrap interval. A row that the revision cannot run is reported and skipped. With --guard the
exit code is 1 if an interval lies above 1.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import alternation
from against_rows import ROOT, ROWS, Build, Row

TURNS = 15


def build(tree: Path) -> Build:
    """Build the program as ./quickstart does."""
    jobs = str(len(os.sched_getaffinity(0)))
    for words in (
        ["cmake", "--preset", "release"],
        ["cmake", "--build", "--preset", "release", "--target", "evolvent", "-j", jobs],
    ):
        done = subprocess.run(words, cwd=tree, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"against: {tree} cannot be built:\n{done.stdout[-2000:]}{done.stderr}")
    program = tree / "build/release/evolvent"
    said = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
    return Build(program, tree, said.stdout.split()[1])


def tree_of(revision: str) -> Path:
    """Return the tree of a revision, below build/against."""
    found = subprocess.run(
        ["git", "rev-parse", "--verify", "--quiet", f"{revision}^{{commit}}"],
        **{"cwd": ROOT, "capture_output": True, "text": True, "check": False},
    )
    if found.returncode != 0:
        sys.exit(f"against: there is no revision '{revision}'; name a commit, a tag or a branch")
    tree = ROOT / "build/against" / found.stdout.strip()[:12]
    if not (tree / "CMakeLists.txt").exists():
        tree.mkdir(parents=True, exist_ok=True)
        archive = subprocess.run(
            ["git", "archive", found.stdout.strip()], cwd=ROOT, capture_output=True, check=True
        )
        subprocess.run(["tar", "-x", "-C", tree], input=archive.stdout, check=True)
    return tree


def compare(row: Row, new: Build, old: Build, turns: int) -> dict[str, Any]:
    """Return the ratios of a row, or the reason why they are missing."""

    def use_of(of: Build) -> alternation.Use:
        with tempfile.TemporaryDirectory() as folder:
            path = {"PYTHONPATH": str(of.tree / "postprocess")} if row.by_python else None
            return alternation.run(row.command(of, Path(folder)), path)

    try:
        use_of(new), use_of(old)  # warm-up, so that both are in the page cache
        used = alternation.alternate(lambda: use_of(new), lambda: use_of(old), turns)
    except alternation.FailedError as reason:
        return {"row": row.name, "failed": str(reason)}
    cpu, memory = (
        alternation.ratio_of(*([getattr(use, what) for use in of] for of in used))
        for what in ("cpu", "memory")
    )
    least = min(use.cpu for use in used[0])
    return {"row": row.name, "seconds": least, "cpu": asdict(cpu), "memory": asdict(memory)}


def report(result: dict[str, Any]) -> None:
    """Print a line."""
    if "failed" in result:
        print(f"{result['row']:52} not compared: {result['failed']}", flush=True)
        return
    cpu, memory = (alternation.Ratio(**result[what]) for what in ("cpu", "memory"))
    seconds = f"{result['seconds']:.3f}"
    print(f"{result['row']:52} {seconds:>9} {cpu!s:>24} {memory.median:>8.3f}", flush=True)


def main() -> int:
    """Compare the revisions."""
    parser = argparse.ArgumentParser(prog="benchmarks/against", description=__doc__.split("\n")[0])
    parser.add_argument("revision", help="a commit, tag or branch")
    parser.add_argument("--rows", default="", help="only rows whose name has this in it (regex)")
    parser.add_argument("--turns", type=int, default=TURNS, help=f"alternations ({TURNS})")
    parser.add_argument("--json", type=Path, help="write all ratios to this file")
    parser.add_argument("--guard", action="store_true", help="fail if an interval lies above 1")
    arguments = parser.parse_args()
    rows = [row for row in ROWS if re.search(arguments.rows, row.name)]
    if not rows or arguments.turns < 1:
        names = "\n  ".join(row.name for row in ROWS)
        parser.error(f"there is no such row; there are\n  {names}" if not rows else "no turns")
    old = build(tree_of(arguments.revision))
    new = build(ROOT)
    print(f"{'':52} {'[s]':>9} {'CPU, new over old':>24} {'memory':>8}")
    results = []
    for row in rows:
        results.append(compare(row, new, old, arguments.turns))
        report(results[-1])
    if arguments.json:
        arguments.json.write_text(json.dumps(results, indent=1) + "\n")
    slower = [r["row"] for r in results if "cpu" in r and r["cpu"]["low"] > 1.0]
    return 1 if arguments.guard and slower else 0


if __name__ == "__main__":
    sys.exit(main())
