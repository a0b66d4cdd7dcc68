"""Estimate the run time of a sweep by running some of its cases."""

from __future__ import annotations

import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from evolvent.errors import BAD_INPUT, FAILED_CASES, INTERRUPTED, SweepError
from evolvent.sweep.design import Design, take, write_design
from evolvent.sweep.journal import count_records
from evolvent.sweep.program import started

TRIED = 12  # cases, spread over the design
LONGEST = 30.0  # of the trial [s]


def seconds_per_case(design: Design, program: Path) -> tuple[float, bool]:
    """Mean time of a case on one core [s], from a trial of at most half a minute.

    Returns
    -------
    The time, and whether it is only a lower bound because no case had ended.

    Raises
    ------
    SweepError
        The program rejects the design.
    """
    chosen = np.unique(np.linspace(0, design.n_cases - 1, min(TRIED, design.n_cases)).astype(int))
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as name:
        folder = Path(name)
        trial = take(design, chosen.tolist())
        write_design(trial, folder / "design.h5")
        command = [str(program), "batch", str(folder / "design.h5"), "-o", str(folder / "trial")]
        start = time.monotonic()
        with started([*command, "--jobs", "1"]) as (process, said):
            try:
                process.wait(LONGEST)
            except subprocess.TimeoutExpired:
                process.terminate()
                process.wait()
            elapsed = time.monotonic() - start
            if process.returncode not in (0, FAILED_CASES, INTERRUPTED):
                raise SweepError(said(), BAD_INPUT)
        done = count_records(folder / "trial")["rows"]
    return elapsed / max(done, 1), done == 0


def span(seconds: float) -> str:
    """Format a time span: 42 s, 3 min 20 s, 5 h 07 min, 3 d 4 h."""
    whole = max(round(seconds), 0)
    if whole < 1:
        return "less than 1 s"
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    if whole < 86400:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    return f"{whole // 86400} d {whole % 86400 // 3600} h"
