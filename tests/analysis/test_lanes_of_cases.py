"""Outputs at eight states in lanes equal those at each state, over the steps of wide gearboxes.

`tests/gearbox/lanes` tests every law and component separately; here whole cases combine them:
meshes with and without coast flanks, prescribed speeds, housings, tooth pairs off their path.
"""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest

import machine
from system.wide_gearboxes import wide_case

CASES = 120
# Runs end before a full revolution, which tests/gearbox/lanes covers.
NEVER = {"reference_turns"}


@pytest.fixture(scope="module")
def compared(
    executable: Path, kernel_test_library: Path, tmp_path_factory: pytest.TempPathFactory
) -> str:
    """Output of the comparison of all cases."""
    program = kernel_test_library.resolve().parent / "lanes_of_case"
    if not program.is_file():
        machine.unavailable("this build has no tests")
    folder = tmp_path_factory.mktemp("cases")
    for seed in range(CASES):
        (folder / f"{seed}.yaml").write_text(json.dumps(wide_case(executable, seed)))
    files = [f"{seed}.yaml" for seed in range(CASES)]
    done = subprocess.run(
        [program, *files], cwd=folder, capture_output=True, text=True, timeout=60, check=False
    )
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def test_eight_states_at_once_are_told_what_each_is_told_alone(compared: str) -> None:
    different = [line for line in compared.splitlines() if " alone, " in line or "refused" in line]
    assert [line for line in different if not line.endswith("yaml: refused")] == []
    states = [int(n) for n in re.findall(r"(\d+) states", compared)]
    assert len(states) > 0.8 * CASES
    assert sum(states) > 20_000


def test_all_variables_over_time_have_a_value_somewhere(compared: str) -> None:
    """Each variable that a history may have over time: otherwise it was not compared."""
    reported = set(" ".join(re.findall("told: (.*)", compared)).split())
    known = set(" ".join(re.findall("outputs: (.*)", compared)).split())
    assert known - reported == NEVER
