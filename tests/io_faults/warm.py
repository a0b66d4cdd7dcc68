"""Who starts a command: the system, or a Python that has loaded what commands of Python need.

Loading is nine tenths of what such a command costs, and none of it is about the test's files.
"""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterator

START = Path(__file__).with_name("start_python.py")
SECONDS = 60.0  # until a command is taken for stuck


class Starter(Protocol):
    """Run a command to its end in a folder."""

    def __call__(
        self,
        words: Sequence[str | Path],
        folder: Path,
        environment: Mapping[str, str],
        output: Path,
    ) -> tuple[int, str]:
        """Return its exit code, -1 if it does not end, and what it says on standard error."""


def by_system(
    words: Sequence[str | Path], folder: Path, environment: Mapping[str, str], output: Path
) -> tuple[int, str]:
    """Start it as anybody does."""
    try:
        with output.open("w") as printed:
            done = subprocess.run(
                words,
                cwd=folder,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
                timeout=SECONDS,
                check=False,
            )
    except subprocess.TimeoutExpired as error:
        return -1, f"no end after {error.timeout} s"
    return done.returncode, done.stderr


class WarmPython:
    """A Python that runs commands of the Python programs in processes that it forks."""

    def __init__(self, layer: Path, root: Path) -> None:
        root.mkdir(parents=True)
        self.errors, state = root / "errors", root / "state"
        state.write_bytes(bytes(65536))
        environment = {
            **os.environ,
            "LD_PRELOAD": str(layer),
            "FAULTS_STATE": str(state),
            "OPENBLAS_NUM_THREADS": "1",  # a process of one thread may be forked
        }
        self.process = subprocess.Popen(
            [sys.executable, START, "--many"],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
        )

    def close(self) -> None:
        """End it."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.close()
        self.process.stdout.close()
        self.process.wait(SECONDS)

    def __call__(
        self,
        words: Sequence[str | Path],
        folder: Path,
        environment: Mapping[str, str],
        output: Path,
    ) -> tuple[int, str]:
        """Run it, if it is one of the Python programs, else as anybody does."""
        if list(words[:2]) != [sys.executable, START]:
            return by_system(words, folder, environment, output)
        asked = {
            "words": [str(word) for word in words[2:]],
            "folder": str(folder),
            "environment": dict(environment),
            "output": str(output),
            "errors": str(self.errors),
        }
        assert self.process.stdin is not None
        self.process.stdin.write(json.dumps(asked).encode() + b"\n")
        self.process.stdin.flush()
        pid = self._number()
        assert pid is not None
        code = self._number()
        if code is None:
            os.kill(pid, signal.SIGKILL)
            self._number()
            return -1, f"no end after {SECONDS} s"
        return code, self.errors.read_text(errors="replace")

    def _number(self) -> int | None:
        """Wait for the next number that it tells; None if it does not come."""
        assert self.process.stdout is not None
        if not select.select([self.process.stdout], [], [], SECONDS)[0]:
            return None
        line = b""
        while not line.endswith(b"\n"):
            more = os.read(self.process.stdout.fileno(), 1)
            assert more, "the Python that starts commands has ended"
            line += more
        return int(line)


@contextmanager
def starter(words: Sequence[str | Path], layer: Path, root: Path) -> Iterator[Starter]:
    """Who starts such commands fastest."""
    if words[0] != sys.executable:
        yield by_system
        return
    python = WarmPython(layer, root)
    try:
        yield python
    finally:
        python.close()
