"""Steps of the set-up scripts: a line each, how far a build is, the end of the log on failure."""

from __future__ import annotations

import os
import pty
import re
import subprocess
from pathlib import Path

import pytest

SETUP = Path(__file__).resolve().parents[2] / "tools" / "setup.sh"
SCRIPT = f"""
set -euo pipefail
. {SETUP}
work() {{
  for i in $(seq 1 12); do echo "[$i/12] Building x$i"; done
  echo "last words"
  return $1
}}
step "A quiet step" echo quiet
counted_step "Nothing to do" echo "ninja: no work to do."
counted_step "A build" work 0
counted_step "Another: build" work 7
echo "not reached"
"""


def steps(folder: Path, stdout: int) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(
        ["bash", "-c", SCRIPT, "name"],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=stdout,
        stderr=subprocess.PIPE,
        timeout=60,
        check=False,
    )


def without_times(text: str) -> str:
    return re.sub(r"\d+ s\b", "T", text)


def assert_stopped(done: subprocess.CompletedProcess[bytes], folder: Path) -> None:
    """The last step failed: the end of its log, where all of it is, and nothing after it."""
    assert done.returncode == 1
    said = done.stderr.decode().splitlines()
    assert said[-2:] == [
        "last words",
        "name: Another: build failed; the whole log is build/log/Another-build.log",
    ]
    assert len(said) == 14
    for name in ("A-build", "Another-build"):
        assert len((folder / f"build/log/{name}.log").read_text().splitlines()) == 13
    assert (folder / "build/log/A-quiet-step.log").read_text() == "quiet\n"


def test_elsewhere_than_on_a_terminal_a_build_tells_each_quarter(tmp_path: Path) -> None:
    done = steps(tmp_path, subprocess.PIPE)
    assert_stopped(done, tmp_path)
    quarters = "".join(f"  {n} of 12 steps after T\n" for n in (3, 6, 9))
    assert without_times(done.stdout.decode()) == (
        "A quiet step ... done (T)\n"
        "Nothing to do ... done (T)\n"
        f"A build ... \n{quarters}A build ... done (T)\n"
        f"Another: build ... \n{quarters}Another: build ... failed\n"
    )


def test_on_a_terminal_a_build_counts_in_its_line(terminal: str) -> None:
    assert all(f"\rA build ... {n} of 12 steps, T" in terminal for n in range(1, 13))


def test_on_a_terminal_each_step_ends_as_one_line(terminal: str) -> None:
    lines = [line.split("\r")[-1].removeprefix("\x1b[K") for line in terminal.split("\r\n")]
    assert lines[:4] == [
        "A quiet step ... done (T)",
        "Nothing to do ... done (T)",
        "A build ... done (T)",
        "Another: build ... failed",
    ]


@pytest.fixture(scope="module")
def terminal(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What a terminal gets."""
    folder = tmp_path_factory.mktemp("terminal")
    screen, end = pty.openpty()
    done = steps(folder, end)
    os.close(end)
    text = b""
    while True:
        try:
            piece = os.read(screen, 65536)
        except OSError:  # all is read
            break
        if not piece:
            break
        text += piece
    os.close(screen)
    assert_stopped(done, folder)
    return without_times(text.decode())
