"""Run the shards of a design here and now with `evolvent batch`."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from types import FrameType
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn

from evolvent.sweep.errors import FAILED_CASES, SweepError
from evolvent.sweep.estimate import span
from evolvent.sweep.folder import Shard
from evolvent.sweep.journal import Records
from evolvent.sweep.program import environment, last_message

LOOKED = 0.25  # seconds between two looks at the journals
LINE_EACH = 60.0  # seconds between two lines if nobody watches
FORWARDED = (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1)


@dataclass
class Tally:
    """Counts the lines that journals grow by."""

    folder: Path
    shards: Sequence[Shard]
    before: Records  # when the run began
    unfinished: int = 0  # failed or refused
    began: float = field(default_factory=time.monotonic)
    new: int = 0
    _read: dict[Path, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.unfinished = self.before.counts.unfinished
        for shard in self.shards:
            path = self.folder / f"{shard.stem}.jsonl"
            self._read[path] = path.stat().st_size if path.exists() else 0

    def look(self) -> None:
        """Read what was appended since the last look."""
        for path, position in self._read.items():
            try:
                with path.open("rb") as journal:
                    journal.seek(position)
                    grown = journal.read()
            except FileNotFoundError:
                continue
            whole = grown[: grown.rfind(b"\n") + 1]
            self._read[path] = position + len(whole)
            rows = whole.count(b'"case":')
            self.new += rows
            self.unfinished += rows - whole.count(b'"status":"done"')

    @property
    def total(self) -> int:
        """Number of cases of the design."""
        return self.before.status.size

    @property
    def recorded(self) -> int:
        """Number of recorded cases."""
        return min(int(self.before.recorded.sum()) + self.new, self.total)

    @property
    def rate(self) -> float:
        """Cases a second since the run began."""
        return self.new / max(time.monotonic() - self.began, 1e-9)

    @property
    def remaining(self) -> str:
        """Time that is left, as people say it."""
        missing = self.total - self.recorded
        return span(missing / self.rate) if self.new else "?"


def batch_command(
    program: Path, design: Path, folder: Path, shard: Shard, jobs: int, cases: Path | None = None
) -> list[str]:
    """The command line that runs what is missing of a shard, or the cases listed in a file."""
    command = [str(program), "batch", str(design), "-o", str(folder)]
    command += ["--shard", f"{shard.index}/{shard.of}", "--jobs", str(jobs), "--resume"]
    return command if cases is None else [*command, "--cases", str(cases)]


def run_shards(
    program: Path,
    design: Path,
    folder: Path,
    shards: Sequence[Shard],
    jobs: int,
    tally: Tally,
    cases: Mapping[Shard, Path] | None = None,
) -> int:
    """Run shards one after the other, each with `jobs` worker processes, and show the progress.

    TERM, USR1 and INT are passed on: the cases that run are given up, the journals are complete.

    Parameters
    ----------
    cases : for each shard a file of case numbers to run, recorded or not; what is missing if None.

    Returns
    -------
    Exit code: 0, 1 (cases failed) or 75 (interrupted).

    Raises
    ------
    SweepError
        The batch refused, could not write, or was killed; with its message and exit code.
    """
    result = 0
    with Display(tally) as show:
        for shard in shards:
            chosen = None if cases is None else cases[shard]
            code = _run(batch_command(program, design, folder, shard, jobs, chosen), show)
            if code not in (0, FAILED_CASES):
                return code
            result = max(result, code)
    return result


def _run(command: list[str], show: Callable[[], None]) -> int:
    with tempfile.TemporaryFile("w+", errors="replace") as messages:
        # A group of its own: Ctrl-C reaches it once, through this process.
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=messages,
            env=environment(),
            process_group=0,
        )
        with _Forwarding(process):
            while True:
                try:
                    process.wait(LOOKED)
                except subprocess.TimeoutExpired:
                    show()
                else:
                    break
        show()
        if process.returncode in (0, FAILED_CASES, 75):
            return process.returncode
        messages.seek(0)
        reason = last_message(messages.read())
    if process.returncode < 0:
        name = signal.Signals(-process.returncode).name
        raise SweepError(
            f"evolvent batch was ended by {name}; run the same command again to go on", 75
        )
    raise SweepError(reason, process.returncode)


class _Forwarding:
    """Passes signals on to a process while it runs."""

    def __init__(self, process: subprocess.Popen[Any]) -> None:
        self.process = process
        self.before: dict[int, Any] = {}

    def __enter__(self) -> None:
        try:
            for number in FORWARDED:
                self.before[number] = signal.signal(number, self._forward)
        except ValueError:  # not in the main thread: whoever is there handles signals
            self.before = {}

    def __exit__(self, *_: object) -> None:
        for number, handler in self.before.items():
            signal.signal(number, handler)

    def _forward(self, number: int, _: FrameType | None) -> None:
        self.process.send_signal(number)


class Display:
    """Shows the progress: a bar on a terminal, else a line a minute."""

    def __init__(self, tally: Tally) -> None:
        self.tally = tally
        self.last_line = time.monotonic()
        self.bar: Progress | None = None

    def __enter__(self) -> Callable[[], None]:
        if not sys.stderr.isatty():
            return self._line
        self.bar = Progress(
            TextColumn("{task.completed:.0f} of {task.total:.0f} cases"),
            BarColumn(),
            TextColumn(
                "{task.fields[bad]} did not finish, {task.fields[rate]}, {task.fields[left]} left"
            ),
            console=Console(stderr=True),
        )
        texts: dict[str, Any] = {"bad": self.tally.unfinished, "rate": "?", "left": "?"}
        self.task = self.bar.add_task("", total=self.tally.total, **texts)
        self.bar.start()
        return self._bar

    def __exit__(self, *_: object) -> None:
        if self.bar is not None:
            self.bar.stop()

    def _bar(self) -> None:
        tally = self.tally
        tally.look()
        assert self.bar is not None
        self.bar.update(
            self.task,
            completed=tally.recorded,
            bad=tally.unfinished,
            rate=f"{tally.rate:.3g} a second",
            left=tally.remaining,
        )

    def _line(self) -> None:
        self.tally.look()
        if time.monotonic() - self.last_line >= LINE_EACH:
            self.last_line = time.monotonic()
            print(progress_line(self.tally), file=sys.stderr, flush=True)


def progress_line(tally: Tally) -> str:
    """The progress in one line, for logs."""
    return (
        f"evolvent-sweep: {tally.recorded} of {tally.total} cases, {tally.unfinished} "
        f"did not finish, {tally.rate:.3g} a second, {tally.remaining} left"
    )
