"""Which cases of a design the program would refuse: asked of every case, before anything runs."""

from __future__ import annotations

import contextlib
import json
import math
import subprocess
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from evolvent.sweep.design import Design, write_design
from evolvent.sweep.errors import FAILED_CASES, SweepError
from evolvent.sweep.program import cores, environment, last_message
from evolvent.sweep.status import Reason, grouped

A_PROCESS = 2000  # cases: a tenth of a second
MANY = 20000  # cases: more than a second


@dataclass(frozen=True)
class Checked:
    """What the program says of the cases of a design."""

    n_cases: int
    refused: int
    reasons: list[Reason]  # why, most frequent first, as of cases that were run
    shortest: float  # duration of the cases that it takes [s], NaN if there are none


def check_design(design: Design, program: Path, case_name: str, name: str) -> Checked:
    """Ask `evolvent batch --check` about all cases, on all cores.

    Parameters
    ----------
    case_name, name : what the base case and the design are called in messages.

    Raises
    ------
    SweepError
        The program does not take the design as a whole.
    """
    with tempfile.TemporaryDirectory(prefix="evolvent-sweep-") as folder:
        file = Path(folder) / "design.h5"
        write_design(design, file)
        n = max(1, min(cores(), design.n_cases // A_PROCESS))
        answers = [Path(folder) / f"{i}.jsonl" for i in range(1, n + 1)]
        errors = [path.with_suffix(".txt") for path in answers]
        processes: list[subprocess.Popen[bytes]] = []
        try:
            for i, (answer, error) in enumerate(zip(answers, errors, strict=True), start=1):
                command = [str(program), "batch", str(file), "--check", "--shard", f"{i}/{n}"]
                with answer.open("wb") as out, error.open("wb") as err:
                    processes.append(
                        subprocess.Popen(command, stdout=out, stderr=err, env=environment())
                    )
            with _waiting(design.n_cases):
                codes = [process.wait() for process in processes]
        finally:
            for process in processes:
                process.kill()  # nothing, unless waiting for it was interrupted
                process.wait()

        def named(message: str) -> str:
            return message.replace(f"{file}: base case", case_name).replace(str(file), name)

        for code, error in zip(codes, errors, strict=True):
            if code not in (0, FAILED_CASES):
                message = last_message(error.read_text(encoding="utf-8", errors="replace"))
                raise SweepError(named(message))
        return _read(answers, named)


def _waiting(n_cases: int) -> contextlib.AbstractContextManager[object]:
    """Say on a terminal what takes more than a moment."""
    if n_cases < MANY or not sys.stderr.isatty():
        return contextlib.nullcontext()
    return Console(stderr=True).status(f"asking the program about {n_cases} cases")


def _read(answers: list[Path], named: Callable[[str], str]) -> Checked:
    reasons: list[Reason] = []
    totals: list[dict[str, Any]] = []
    for answer in answers:
        with answer.open(encoding="utf-8") as lines:
            for line in lines:
                row = json.loads(line)
                if "case" in row:
                    reasons.append(Reason(1, named(row["message"]), int(row["case"])))
                else:
                    totals.append(row)
    durations = [float(total["shortest"]) for total in totals if total["shortest"] is not None]
    return Checked(
        n_cases=sum(int(total["checked"]) for total in totals),
        refused=len(reasons),
        reasons=grouped(reasons),
        shortest=min(durations, default=math.nan),
    )
