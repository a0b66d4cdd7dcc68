"""The one command of all tests, and its tiers."""

from __future__ import annotations

import subprocess
import sys

import pytest

from documents import ROOT


def runtests(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "runtests", *arguments], capture_output=True, text=True, timeout=60, check=False
    )


def test_its_help_has_every_option() -> None:
    done = runtests("--help")
    assert done.returncode == 0, done.stderr
    for option in ("--quick", "--long", "-- PYTEST ARGUMENT..."):
        assert option in done.stdout


@pytest.mark.parametrize("argument", ["--fast", "--quik", "-k", "tests/laws", ""])
def test_it_refuses_an_unknown_argument_before_it_does_anything(argument: str) -> None:
    done = runtests("--quick", argument, "--", "tests/laws")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith(f"runtests: unknown argument '{argument}'; known are --quick")
    assert done.stderr.count("\n") == 1


def collected(*arguments: str) -> set[str]:
    """Files of the tests that pytest selects."""
    command = [sys.executable, "-m", "pytest", "--collect-only", "-q", "-p", "no:cacheprovider"]
    files = ["tests/fuzz", "tests/slurm", "tests/tools/test_machine.py"]
    done = subprocess.run(
        [*command, *arguments, *files], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return {line.split("::")[0] for line in done.stdout.splitlines() if "::" in line}


def test_quick_leaves_out_the_tests_of_whole_systems_and_no_other() -> None:
    unit = "tests/tools/test_machine.py"
    assert collected("--quick") == {unit}
    assert collected() == {unit, "tests/fuzz/test_fuzz.py", "tests/slurm/test_slurm.py"}
