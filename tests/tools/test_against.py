"""The comparison of two revisions: what it makes of times, commands and rows; no test is timed."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import alternation
import pytest
from against_rows import ROWS, Build


def test_a_ratio_is_the_median_of_the_turns_and_its_interval_holds_it() -> None:
    generator = random.Random(3)
    drift = [1 + 0.5 * i / 15 for i in range(15)]  # the machine's clock, the same for both
    new = [0.9 * d * (1 + 0.01 * generator.random()) for d in drift]
    old = [1.0 * d * (1 + 0.01 * generator.random()) for d in drift]
    ratio = alternation.ratio_of(new, old)
    assert ratio.low <= ratio.median <= ratio.high
    assert ratio.low < 0.9 < ratio.high
    assert ratio.high - ratio.low < 0.02
    assert alternation.ratio_of(new, old) == ratio  # the draws are the same


def test_of_one_turn_the_interval_is_the_ratio() -> None:
    assert alternation.ratio_of([3.0], [2.0]) == alternation.Ratio(1.5, 1.5, 1.5)


def test_both_run_once_a_turn_and_who_is_first_changes() -> None:
    order: list[str] = []

    def use_of(name: str) -> alternation.Use:
        order.append(name)
        return alternation.Use(1.0, len(order))

    new, old = alternation.alternate(lambda: use_of("new"), lambda: use_of("old"), 3)
    assert order == ["new", "old", "old", "new", "new", "old"]
    assert [use.memory for use in new] == [1, 4, 5]
    assert [use.memory for use in old] == [2, 3, 6]


def test_children_count_and_a_failure_is_told_with_its_last_line() -> None:
    spin = "sum(range(3000000))"
    child = f"import subprocess, sys; subprocess.run([sys.executable, '-c', '{spin}'], check=True)"
    start = alternation.run([sys.executable, "-c", "pass"])
    assert alternation.run([sys.executable, "-c", child]).cpu > start.cpu > 0
    with pytest.raises(alternation.FailedError, match=r"^exit code 3: no such thing$"):
        alternation.run(["sh", "-c", "echo first >&2; echo no such thing >&2; exit 3"])


def test_memory_is_that_of_the_command_and_not_of_the_process_that_measures() -> None:
    here = bytearray(100_000_000)
    small = alternation.run([sys.executable, "-c", "pass"]).memory
    large = alternation.run([sys.executable, "-c", "x = bytearray(50_000_000)"]).memory
    assert len(here) / 2**20 > large
    assert 1 < small < 40
    assert large - small == pytest.approx(50_000_000 / 2**20, abs=5)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_every_row_is_a_command_that_the_program_takes(
    row, executable: Path, root: Path, tmp_path: Path
) -> None:
    """Runs and batches as far as their check goes: it refuses nothing. All others as they are."""
    said = subprocess.run([executable, "--version"], capture_output=True, text=True, check=True)
    command = row.command(Build(executable, root, said.stdout.split()[1]), tmp_path)
    words = command
    if command[1] == "batch":
        words = [*command[:3], "--check"]
    elif command[1] == "run":
        case = next(word for word in command if word.endswith(".yaml"))
        words = [command[0], "validate", case, *command[command.index("-o") + 2 :]]
    done = subprocess.run(words, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode == 0, done.stderr


def test_rows_have_names_of_their_own() -> None:
    assert len({row.name for row in ROWS}) == len(ROWS)
