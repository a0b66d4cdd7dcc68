"""Out of memory: one line and one exit code at any point."""

from __future__ import annotations

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import machine
from designs import write_design

NO_MEMORY, NOT_LOADED = 71, 127
PLENTY = 2**32  # bytes
RUN = ("--set", "simulation.duration=0.002", "-o", "m.h5", "-q")


@pytest.fixture
def ended(executable: Path, tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the program with this number of bytes of address space."""

    def run(limit: int, *words: object) -> subprocess.CompletedProcess[str]:
        def limited() -> None:
            resource.setrlimit(resource.RLIMIT_AS, (limit, limit))

        return subprocess.run(
            [str(executable), *map(str, words)], cwd=tmp_path, preexec_fn=limited,
            capture_output=True, text=True, check=False,
        )  # fmt: skip

    if run(PLENTY, "--version").returncode != 0:
        machine.unavailable("this build needs an address space without a limit, as sanitizers do")
    return run


def test_a_table_of_a_million_knots_is_shown_in_500_megabytes(
    executable: Path, examples: Path, tmp_path: Path
) -> None:
    n = 1_000_000
    times = ", ".join(f"{1e-5 * i:.5f}" for i in range(n))
    torques = ", ".join(f"{-5 - 1e-6 * i:.6f}" for i in range(n))
    table = f"loads:\n  - {{kind: table, time: [{times}], torque: [{torques}]}}"
    text = (examples / "spur-pair.yaml").read_text().replace("loads:", table, 1)
    (tmp_path / "million.yaml").write_text(text)
    # a separate process measures: the child before exec counts, too
    ask = (
        "import resource, subprocess, sys; subprocess.run(sys.argv[1:], check=True); "
        "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss, file=sys.stderr)"
    )
    words = [sys.executable, "-c", ask, str(executable), "show", "million.yaml"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "(999994 more)" in done.stdout
    assert int(done.stderr.splitlines()[-1]) < 500_000  # kB


@pytest.mark.parametrize(
    "words",
    [
        ("validate", "spur-pair.yaml"),
        ("run", "spur-pair.yaml", *RUN),
        ("run", "paper.yaml", *RUN),
        ("show", "compliant-pair.yaml"),
        ("batch", "design.h5", "-o", "r", "--resume", "-q"),
    ],
    ids=lambda words: " ".join(words[:2]),
)
def test_whatever_memory_there_is_a_command_is_done_or_says_so(
    ended: Callable[..., subprocess.CompletedProcess[str]],
    examples: Path,
    tmp_path: Path,
    words: tuple[str, ...],
) -> None:
    for name in {"spur-pair.yaml", "paper.yaml", "compliant-pair.yaml"} & set(words):
        (tmp_path / name).write_text((examples / name).read_text())
    write_design(
        tmp_path / "design.h5", {"wheels.pinion.loads.0.value": [-1.0]}, histories="normal_force"
    )
    low, high = 2**22, PLENTY  # loading limit of the program: 27 halvings, to a few bytes
    while high - low > 2**16:
        middle = (low + high) // 2
        low, high = (
            (middle, high)
            if ended(middle, "--version").returncode in (NOT_LOADED, -11)
            else (low, middle)
        )
    codes = set()
    for more in range(0, 2**25, 2**20 + 7919):  # 32 steps of slightly more than a megabyte
        done = ended(high + more, *words)
        codes.add(done.returncode)
        assert done.returncode in (0, NO_MEMORY), (more, done)
        if done.returncode == NO_MEMORY:
            assert done.stderr.startswith("evolvent: out of memory: ")
            assert done.stderr.count("\n") == 1
    assert NO_MEMORY in codes
