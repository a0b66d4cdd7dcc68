"""The program `evolvent`: where it is, its version, and how many cores this job owns."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from evolvent.errors import USAGE, SweepError

VARIABLE = "EVOLVENT_EXECUTABLE"


def find_program() -> Path:
    """Find `evolvent`: named by EVOLVENT_EXECUTABLE, beside this Python, or in PATH.

    Raises
    ------
    SweepError
        It is nowhere.
    """
    named = os.environ.get(VARIABLE)
    if named:
        if not os.access(named, os.X_OK):
            raise SweepError(f"{VARIABLE}={named}: is no program that can be run", USAGE)
        return Path(named).absolute()
    beside = Path(sys.executable).with_name("evolvent")
    found = str(beside) if os.access(beside, os.X_OK) else shutil.which("evolvent")
    if not found:
        raise SweepError(
            "the program `evolvent` is not in PATH; activate its environment, or name it with "
            f"{VARIABLE}",
            USAGE,
        )
    return Path(found).absolute()


def program_version(program: Path) -> str:
    """Version of the program, such as "0.1.0"."""
    done = call(program, "--version")
    words = done.stdout.split()
    if done.returncode != 0 or len(words) < 2:
        raise SweepError(f"{program}: does not tell its version; is it evolvent?")
    return words[1]


def call(program: Path | str, *words: object) -> subprocess.CompletedProcess[str]:
    """Run the program to its end; what it says and its exit code are in the answer."""
    return subprocess.run(
        [str(program), *map(str, words)],
        capture_output=True,
        text=True,
        errors="replace",
        env=environment(),
        check=False,
    )


@contextmanager
def started(
    command: Sequence[str], **options: Any
) -> Iterator[tuple[subprocess.Popen[Any], Callable[[], str]]]:
    """Start the program; give its process, and what tells its last message when it has ended.

    Parameters
    ----------
    options : of `subprocess.Popen`; nothing is read or written by the program if none are given.
    """
    usual: dict[str, Any] = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL}
    with tempfile.TemporaryFile("w+", errors="replace") as messages:

        def said() -> str:
            messages.seek(0)
            return last_message(messages.read())

        with subprocess.Popen(
            command, **{**usual, **options}, stderr=messages, env=environment()
        ) as process:
            yield process, said


def last_message(messages: str) -> str:
    """What the program said last, without its name."""
    lines = [line for line in messages.split("\n") if line.strip()]
    return lines[-1].removeprefix("evolvent: ") if lines else "it ended without a message"


def environment() -> dict[str, str]:
    """Variables for the program: one thread a process, and a batch ends when this process does."""
    alone = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **alone, "EVOLVENT_PARENT": str(os.getpid())}


def cores() -> int:
    """Cores that this job owns: what Slurm says, else what the process may run on."""
    given = os.environ.get("SLURM_CPUS_PER_TASK", "")
    if given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0))
