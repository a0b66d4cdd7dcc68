"""The program `evolvent`: its path, its version, and the number of cores of this job."""

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

    Returns
    -------
    Path
        Absolute path of the program.

    Raises
    ------
    SweepError
        It is not found.

    Examples
    --------
    >>> from evolvent.sweep.program import find_program
    >>> find_program().name
    'evolvent'
    """
    named = os.environ.get(VARIABLE)
    if named:
        if not os.access(named, os.X_OK):
            raise SweepError(f"{VARIABLE}={named}: is not an executable program", USAGE)
        return Path(named).absolute()
    beside = Path(sys.executable).with_name("evolvent")
    found = str(beside) if os.access(beside, os.X_OK) else shutil.which("evolvent")
    if not found:
        raise SweepError(
            f"the program `evolvent` is not in PATH; activate its environment, or set {VARIABLE}",
            USAGE,
        )
    return Path(found).absolute()


def program_version(program: Path) -> str:
    """Version of the program, such as "0.1.0".

    Parameters
    ----------
    program : Path
        As from `find_program`.

    Returns
    -------
    str
        The version.

    Raises
    ------
    SweepError
        The program does not return a version.

    Examples
    --------
    >>> from evolvent.sweep.program import find_program, program_version
    >>> len(program_version(find_program()).split("."))
    3
    """
    done = call(program, "--version")
    words = done.stdout.split()
    if done.returncode != 0 or len(words) < 2:
        raise SweepError(f"{program}: does not print its version; check that it is evolvent")
    return words[1]


def call(program: Path | str, *words: object) -> subprocess.CompletedProcess[str]:
    """Run the program to its end; return its output, messages and exit code."""
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
    """Start the program; yield its process, and a function that returns its last message.

    Parameters
    ----------
    options : of `subprocess.Popen`; by default the program has no standard input and output.
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
    """Last message of the program, without its name."""
    lines = [line for line in messages.split("\n") if line.strip()]
    return lines[-1].removeprefix("evolvent: ") if lines else "it ended without a message"


def environment() -> dict[str, str]:
    """Environment of the program: one thread per process; a batch ends with this process."""
    alone = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    return {**os.environ, **alone, "EVOLVENT_PARENT": str(os.getpid())}


def cores() -> int:
    """Number of cores of this job: from Slurm, else those available to the process."""
    given = os.environ.get("SLURM_CPUS_PER_TASK", "")
    if given.isdigit() and int(given) > 0:
        return int(given)
    return len(os.sched_getaffinity(0))
