"""Run the shards of a design on this machine with `evolvent batch`."""

from __future__ import annotations

import math
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from evolvent.errors import FAILED_CASES, INTERRUPTED, SweepError
from evolvent.sweep.estimate import span
from evolvent.sweep.folder import Shard
from evolvent.sweep.journal import Records, count_records
from evolvent.sweep.program import started

LOOKED = 0.25  # polling interval of the process [s]
A_LOOK = 0.1  # maximum share of the time for reading the journals
LINE_EACH = 60.0  # seconds between two lines without a terminal; default of the variable below
INTERVAL = "EVOLVENT_PROGRESS_INTERVAL"  # the variable; used by the program, too
FORWARDED = (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1)


@dataclass
class Tally:
    """Counts the recorded cases during a run."""

    folder: Path
    before: Records  # at the start of the run
    again: int = 0  # recorded cases that are run again
    began: float = field(default_factory=time.monotonic)
    new: int = 0

    def __post_init__(self) -> None:
        self.unfinished = self.before.counts.unfinished
        self._looked = self._next = self.began

    def look(self, at_once: bool = False) -> None:
        """Read the counts of recorded cases; at limited frequency unless `at_once`."""
        start = time.monotonic()
        if at_once or start >= self._next:
            with suppress(SweepError):  # the run continues; the counts are read again at its end
                count_of = count_records(self.folder)
                self.new = count_of["rows"] - sum(self.before.rows.values())
                self.unfinished = count_of["failed"] + count_of["refused"]
            self._looked = start
            self._next = start + (time.monotonic() - start) / A_LOOK

    @property
    def total(self) -> int:
        """Number of cases of the design."""
        return self.before.counts.n_cases

    @property
    def recorded(self) -> int:
        """Number of recorded cases, without those that are still to be run again."""
        return min(self.total - self.before.counts.missing - self.again + self.new, self.total)

    @property
    def progress_rate(self) -> str:
        """Unfinished cases, rate and remaining time, in words."""
        rate = self.new / max(self._looked - self.began, 1e-9)
        left = span((self.total - self.recorded) / rate) if self.new else "?"
        return f"{self.unfinished} did not finish, {rate:.3g} a second, {left} left"


@dataclass(frozen=True)
class Work:
    """Program, design and folder of a run."""

    program: Path
    design: Path
    folder: Path

    def command(self, shard: Shard, jobs: int, cases: Path | None = None) -> list[str]:
        """Command line for the missing cases of a shard, or the cases listed in a file."""
        command = [str(self.program), "batch", str(self.design), "-o", str(self.folder)]
        command += ["--shard", f"{shard.index}/{shard.of}", "--jobs", str(jobs), "--resume"]
        return command if cases is None else [*command, "--cases", str(cases)]


def run_shards(
    work: Work,
    shards: Sequence[Shard],
    jobs: int,
    tally: Tally,
    cases: Mapping[Shard, Path] | None = None,
) -> int:
    """Run shards sequentially, each with `jobs` worker processes, and show the progress.

    TERM, USR1 and INT are forwarded: running cases are aborted, the journals are complete.

    Parameters
    ----------
    cases : for each shard a file of cases to run, recorded or not; the missing ones if None.

    Returns
    -------
    Exit code: 0, 1 (cases failed) or 75 (interrupted).

    Raises
    ------
    SweepError
        The batch was rejected, could not write, or was killed; with its message and exit code.
    """
    result = 0
    with display(tally) as show:
        for shard in shards:
            chosen = None if cases is None else cases[shard]
            code = _run(work.command(shard, jobs, chosen), show)
            if code not in (0, FAILED_CASES):
                return code
            result = max(result, code)
    return result


def _run(command: list[str], show: Callable[[], None]) -> int:
    # A separate process group: Ctrl-C reaches it once, through this process.
    with started(command, process_group=0) as (process, said):
        with _forwarding(process):
            while process.returncode is None:
                with suppress(subprocess.TimeoutExpired):
                    process.wait(LOOKED)
                show()
        reason = said()
    if process.returncode in (0, FAILED_CASES, INTERRUPTED):
        return int(process.returncode)
    if process.returncode < 0:
        name = signal.Signals(-process.returncode).name
        raise SweepError(
            f"evolvent batch was ended by {name}; repeat the command to continue", INTERRUPTED
        )
    raise SweepError(reason, process.returncode)


@contextmanager
def _forwarding(process: subprocess.Popen[Any]) -> Iterator[None]:
    """Forward signals to a process while it runs."""
    before: dict[int, Any] = {}
    with suppress(ValueError):  # not in the main thread: the main thread handles signals
        for number in FORWARDED:
            before[number] = signal.signal(number, lambda n, _: process.send_signal(n))
    try:
        yield
    finally:
        for forwarded, handler in before.items():
            signal.signal(forwarded, handler)


@contextmanager
def display(tally: Tally) -> Iterator[Callable[[], None]]:
    """Yield a function that updates the progress: a bar on a terminal, else a line a minute."""
    bar = Progress(
        TextColumn("{task.completed:.0f} of {task.total:.0f} cases"),
        BarColumn(),
        TextColumn("{task.description}"),
        console=Console(stderr=True),
        disable=not sys.stderr.isatty(),
    )
    task = bar.add_task(tally.progress_rate, total=tally.total, completed=tally.recorded)
    interval = log_interval()
    last_line = time.monotonic()

    def show(at_once: bool = False) -> None:
        nonlocal last_line
        if bar.disable and time.monotonic() - last_line < interval:
            return
        tally.look(at_once)
        bar.update(task, completed=tally.recorded, description=tally.progress_rate)
        if bar.disable:
            last_line = time.monotonic()
            print(progress_line(tally), file=sys.stderr, flush=True)

    with bar:
        yield show
        show(at_once=True)


def log_interval() -> float:
    """Seconds between two lines of a log."""
    try:
        seconds = float(os.environ.get(INTERVAL, LINE_EACH))
    except ValueError:
        return LINE_EACH
    return seconds if 0.0 < seconds < math.inf else LINE_EACH


def progress_line(tally: Tally) -> str:
    """Progress in one line, for logs."""
    now = time.strftime("%Y-%m-%d %H:%M:%S")
    return f"evolvent-sweep: {now}  {tally.recorded} of {tally.total} cases, {tally.progress_rate}"
