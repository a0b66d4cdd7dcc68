"""A run from its case to its history: what is written, and what is left when it goes wrong."""

from __future__ import annotations

import os
import pty
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORT = ("--set", "simulation.duration=0.05")
ENDLESS = ("--set", "simulation.duration=1e6", "--set", "simulation.output_interval=0.01")
# beyond the limit (15) of the Johnson force, about 1e9 N for this pair
OVERLOAD = ("--set", "wheels.pinion.loads.0.value=-1e9")


@pytest.fixture
def case(examples: Path) -> Path:
    """The paper's case."""
    return examples / "paper.yaml"


def names(folder: Path) -> list[str]:
    """What a folder holds."""
    return sorted(path.name for path in folder.iterdir())


def attributes(path: Path) -> dict[str, object]:
    """Root attributes of a history."""
    with xr.open_dataset(path, engine="h5netcdf") as history:
        return dict(history.attrs)


def wait_for(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait until something is the case; fail if it never is."""
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


# ---- what a complete run leaves ------------------------------------------------------------------


def test_a_history_is_named_after_its_case_and_nothing_else_is_left(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    result = evolvent("run", case, *SHORT)
    assert result.returncode == 0, result.stderr
    assert result.stdout == ""
    assert names(tmp_path) == ["paper.h5"]


def test_the_summary_is_one_line_on_stderr(evolvent: Evolvent, case: Path) -> None:
    lines = evolvent("run", case, *SHORT).stderr.splitlines()
    assert re.fullmatch(r"evolvent: \d+ steps, \d+ events?, \S+ s CPU: paper\.h5", lines[-1])
    assert all(line.startswith("evolvent: warning: ") for line in lines[:-1])


def test_quiet_leaves_only_warnings(evolvent: Evolvent, case: Path) -> None:
    loud = evolvent("run", case, *SHORT).stderr.splitlines()
    quiet = evolvent("run", case, *SHORT, "-q").stderr.splitlines()
    assert quiet == [line for line in loud if line.startswith("evolvent: warning: ")]


def test_the_case_inside_a_history_runs_again_to_the_same_data(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    evolvent("run", case, *SHORT, "--set", "wheels.gear.teeth=31")
    (tmp_path / "again.yaml").write_text(str(attributes(tmp_path / "paper.h5")["case"]))
    assert evolvent("run", "again.yaml").returncode == 0
    with (
        xr.open_dataset(tmp_path / "paper.h5") as first,
        xr.open_dataset(tmp_path / "again.h5") as second,
    ):
        assert first.identical(second)


def test_the_same_case_gives_the_same_file_to_the_byte(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    evolvent("run", case, *SHORT, "-o", "a.h5")
    evolvent("run", case, *SHORT, "-o", "b.h5")
    assert (tmp_path / "a.h5").read_bytes() == (tmp_path / "b.h5").read_bytes()


def test_a_run_that_loses_contact_for_good_says_so(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    apart = ("--set", "wheels.pinion.loads.0.value=1", *SHORT)
    result = evolvent("run", case, *apart)
    assert result.returncode == 0, result.stderr
    said = r"(mesh 'pinion-gear' lost contact at t = \S+ s and never regained it"
    said += r"|the flanks of mesh 'pinion-gear' never touched)"
    assert re.search(f"evolvent: warning: {said}", result.stderr)
    assert re.search(said, str(attributes(tmp_path / "paper.h5")["status_message"]))


# ---- on a terminal -------------------------------------------------------------------------------


def test_progress_appears_on_a_terminal_and_is_wiped_at_the_end(
    executable: Path, case: Path, tmp_path: Path
) -> None:
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [str(executable), "run", str(case), *ENDLESS], cwd=tmp_path, stderr=theirs
    ) as process:
        os.close(theirs)
        text = os.read(ours, 4096)
        while text.count(b"%") < 2:
            text += os.read(ours, 4096)
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=60) == 75
    text += os.read(ours, 65536)
    os.close(ours)
    assert re.search(rb"\r *\d+\.\d %  t = \S+ of 1e\+06 s, \S+ s per s, \S+( h)? left", text)
    assert re.search(rb"\r\x1b\[K[^\r]*interrupted by SIGINT", text)


# ---- what is refused leaves no trace -------------------------------------------------------------
