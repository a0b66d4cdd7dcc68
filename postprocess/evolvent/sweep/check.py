"""Check all cases of a design with the program before any is run."""

from __future__ import annotations

import contextlib
import json
import math
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from evolvent.errors import FAILED_CASES, SweepError
from evolvent.sweep.design import Design, write_design
from evolvent.sweep.program import call, cores, last_message
from evolvent.sweep.status import Reason, reasons

A_PROCESS = 2000  # cases: a tenth of a second
MANY = 20000  # cases: more than a second


@dataclass(frozen=True)
class Checked:
    """Result of the check of a design."""

    refused: int
    reasons: list[Reason]  # most frequent first, as for cases that were run
    shortest: float  # duration of the accepted cases [s], NaN if there are none


def check_design(design: Design, program: Path, case_name: str, name: str) -> Checked:
    """Check all cases with `evolvent batch --check`, on all cores.

    Parameters
    ----------
    case_name, name : names of the base case and the design in messages.

    Raises
    ------
    SweepError
        The program rejects the design as a whole.
    """
    n = max(1, min(cores(), design.n_cases // A_PROCESS))
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as folder:
        file = Path(folder) / "design.h5"
        write_design(design, file)

        def named(message: str) -> str:
            return message.replace(f"{file}: base case", case_name).replace(str(file), name)

        def ask(shard: int) -> subprocess.CompletedProcess[str]:
            return call(program, "batch", file, "--check", "--shard", f"{shard}/{n}")

        with ThreadPoolExecutor(n) as threads, _waiting(design.n_cases):
            processes = list(threads.map(ask, range(1, n + 1)))
    for process in processes:
        if process.returncode not in (0, FAILED_CASES):
            raise SweepError(named(last_message(process.stderr)))
    rows = [
        json.loads(line) for process in processes for line in process.stdout.split("\n") if line
    ]
    refused = {int(row["case"]): named(row["message"]) for row in rows if "case" in row}
    durations = [float(row["shortest"]) for row in rows if row.get("shortest") is not None]
    return Checked(
        refused=len(refused),
        reasons=reasons(sorted(refused.items())),
        shortest=min(durations, default=math.nan),
    )


def _waiting(n_cases: int) -> contextlib.AbstractContextManager[object]:
    """Show a status on a terminal if the check takes more than a second."""
    if n_cases < MANY or not sys.stderr.isatty():
        return contextlib.nullcontext()
    from rich.console import Console

    return Console(stderr=True).status(f"checking {n_cases} cases")
