#!/usr/bin/env python3
"""Overhead of a run in this process besides the integration: CPU time of a case, medians.

usage: python benchmarks/in_process.py [CASE.yaml] [--repeats N] [--set PATH=VALUE]...

read      the case: YAML, checks, the gearbox
run       everything of evolvent_run
 beside   its part outside the integration: measured with a run of two outputs, whose
          integration time is negligible
dataset   the result as a dataset of xarray
whole     evolvent.run, all of this with its threads
program   `evolvent run -q` as a separate process, with its file
"""

from __future__ import annotations

import argparse
import ctypes
import os
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import evolvent
from evolvent.library.binding import Error, load
from evolvent.library.records import dataset

PAPER = Path(__file__).resolve().parents[1] / "examples" / "paper.yaml"


def milliseconds(work: Callable[[], Any], clock: Callable[[], float]) -> tuple[float, Any]:
    """Return the time of a call [ms], and its result."""
    begun = clock()
    result = work()
    return 1e3 * (clock() - begun), result


def of_children() -> float:
    """Return the CPU time of processes that have ended [s]."""
    spent = os.times()
    return spent.children_user + spent.children_system


def measure(case: Path, settings: list[str], repeats: int) -> dict[str, list[float]]:
    """Measure each part [ms], with the requested repeats."""
    library, error = load(), Error()
    parts: dict[str, list[float]] = {}

    def note(
        part: str, work: Callable[[], Any], clock: Callable[[], float] = time.thread_time
    ) -> Any:
        spent, result = milliseconds(work, clock)
        parts.setdefault(part, []).append(spent)
        return result

    def read(*more: str) -> Any:
        options = [option.encode() for option in (*settings, *more)]
        texts = (ctypes.c_char_p * len(options))(*options)
        return library.evolvent_case_read(
            os.fsencode(case), len(options), texts, ctypes.byref(error)
        )

    def run(handle: Any) -> Any:
        record = ctypes.c_void_p()
        library.evolvent_run(handle, None, ctypes.byref(record), ctypes.byref(error))
        return record.value

    program = os.environ.get("EVOLVENT_EXECUTABLE", "evolvent")
    with tempfile.TemporaryDirectory() as folder:
        words = [program, "run", "-q", case, "-o", Path(folder) / "h.h5"]
        words += [word for setting in settings for word in ("--set", setting)]
        for _ in range(repeats):
            handle = note("read", read)
            short = read("simulation.duration=1e-9", "simulation.output_interval=1e-9")
            record = note("run", lambda handle=handle: run(handle))
            library.evolvent_record_free(note(" beside", lambda short=short: run(short)))
            note("dataset", lambda record=record: dataset(record))
            library.evolvent_case_free(short)
            library.evolvent_case_free(handle)
            note("whole", lambda: evolvent.run(case, settings), time.process_time)
            note("program", lambda: subprocess.run(words, check=True), of_children)
    return parts


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("case", nargs="?", type=Path, default=PAPER)
    parser.add_argument("--repeats", type=int, default=21)
    parser.add_argument("--set", action="append", default=[])
    given = parser.parse_args()
    evolvent.run(given.case, given.set)  # imports
    for part, spent in measure(given.case, given.set, given.repeats).items():
        print(f"{part:8} {statistics.median(spent):8.3f} ms")


if __name__ == "__main__":
    main()
