"""Processor time and memory of whole processes, of two programs in turn.

Machines have other load and change their clock: only runs side by side can be compared. Each turn
runs both programs once, in alternating order; its ratio is one sample. The bootstrap interval of
the median of ratios shows the remaining noise.
"""

from __future__ import annotations

import os
import random
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass

Command = Sequence[str | os.PathLike[str]]
ONE_THREAD = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}

# Linux counts the parent's memory at the fork as memory of the child. So a small process starts
# the command and reports its use. About 9 MB are the least memory that can be measured.
LAUNCHER = """
import os, sys
process = os.posix_spawnp(sys.argv[2], sys.argv[2:], os.environ)
_, status, used = os.wait4(process, 0)
report = (os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, used.ru_maxrss)
os.write(int(sys.argv[1]), " ".join(map(repr, report)).encode())
"""


class FailedError(Exception):
    """A command that ended with another exit code than 0; its last line has the reason."""


@dataclass(frozen=True)
class Use:
    """Resources used by a process and all its children."""

    cpu: float  # user and system time [s]
    memory: float  # of the largest of them [MB]


@dataclass(frozen=True)
class Ratio:
    """A median of ratios, and its confidence interval at a level of 95 %."""

    median: float
    low: float
    high: float

    def __str__(self) -> str:
        """Return it as "0.97 (0.95 to 0.99)"."""
        return f"{self.median:.3f} ({self.low:.3f} to {self.high:.3f})"


def run(command: Command, environment: dict[str, str] | None = None) -> Use:
    """Run a command to its end."""
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as report:
        launcher = [sys.executable, "-I", "-S", "-c", LAUNCHER, str(report.fileno())]
        subprocess.run(
            [*launcher, *(os.fspath(word) for word in command)],
            stdout=subprocess.DEVNULL,
            stderr=said,
            env={**os.environ, **ONE_THREAD, **(environment or {})},
            pass_fds=[report.fileno()],
            check=False,
        )
        report.seek(0)
        code, cpu, memory = report.read().split() or (b"127", b"0", b"0")
        if int(code) != 0:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines() or ["no message"]
            raise FailedError(f"exit code {int(code)}: {lines[-1]}")
    return Use(float(cpu), float(memory) / 1024)


def alternate(
    new: Callable[[], Use], old: Callable[[], Use], turns: int
) -> tuple[list[Use], list[Use]]:
    """Run both in each turn, with the order changed from turn to turn."""
    used: dict[bool, list[Use]] = {True: [], False: []}
    for turn in range(turns):
        for is_new in (turn % 2 == 0, turn % 2 == 1):
            used[is_new].append(new() if is_new else old())
    return used[True], used[False]


def ratio_of(new: Sequence[float], old: Sequence[float], draws: int = 2000) -> Ratio:
    """Return the median of the ratios new over old of each turn; draws are reproducible."""
    ratios = [a / b for a, b in zip(new, old, strict=True)]
    generator = random.Random(1)
    medians = sorted(
        statistics.median(generator.choices(ratios, k=len(ratios))) for _ in range(draws)
    )
    low, high = (medians[round(part * (draws - 1))] for part in (0.025, 0.975))
    return Ratio(statistics.median(ratios), low, high)
