"""Choice of the integrator, and incomplete runs by radau."""

from __future__ import annotations

import re
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

from processes import running, wait_for

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
RADAU = ("--set", "meshes.0.tracking=closed_form", "--set", "simulation.integrator=radau")
OVERLOAD = ("--set", "wheels.pinion.loads.0.value=-1e9")


@pytest.fixture
def case(examples: Path) -> Path:
    """The paper's case."""
    return examples / "paper.yaml"


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("meshes.0.tracking=algebraic", "tracking: tracked contact points are algebraic states"),
        ("meshes.0.contact={law: rigid}", "contact: a rigid contact is a constraint"),
        (
            "housing={kind: mounted, mass: 20, inertia: [1, 1, 1], mount: {}}",
            "housing.kind: the accelerations of a mounted housing are coupled",
        ),
        ("simulation.tolerance=1e-14", "tolerance: is 1e-14, but integrator radau accepts 1e-13"),
    ],
)
def test_radau_is_refused_where_it_cannot_serve_with_place_and_remedy(
    evolvent: Evolvent, case: Path, setting: str, said: str
) -> None:
    damping = ("--set", "meshes.0.damping={law: none}")
    result = evolvent("run", case, *RADAU, *damping, "--set", setting)
    assert result.returncode == 3
    assert result.stderr.startswith(f"--set {setting}: ")
    assert said in result.stderr
    assert "choose integrator ida" in result.stderr


def test_an_unknown_integrator_is_refused(evolvent: Evolvent, case: Path) -> None:
    result = evolvent("run", case, "--set", "simulation.integrator=euler")
    assert result.returncode == 3
    assert "must be one of ida, radau, not 'euler'" in result.stderr


def test_the_resolved_case_says_which_is_taken(evolvent: Evolvent, case: Path) -> None:
    assert "integrator: ida" in evolvent("show", case).stdout
    closed = evolvent("show", case, "--set", "meshes.0.tracking=closed_form")
    assert "integrator: radau" in closed.stdout


def test_beyond_the_limit_of_the_force_radau_ends_with_the_law_s_words(
    evolvent: Evolvent, case: Path
) -> None:
    result = evolvent("run", case, *RADAU, *OVERLOAD)
    assert result.returncode == 4
    last = result.stderr.splitlines()[-1]
    assert re.search(
        r": t = \S+ s: mesh 'pinion-gear': penetration h = \S+ m exceeds .* of the Johnson",
        last,
    )
    assert "the history up to there is in 'paper.h5.partial'" in last


def test_an_interrupted_run_by_radau_leaves_what_it_has(
    executable: Path, case: Path, tmp_path: Path
) -> None:
    endless = ("--set", "simulation.duration=1e6", "--set", "simulation.output_interval=0.01")
    partial = tmp_path / "paper.h5.partial"
    command = [executable, "run", case, *RADAU, *endless]
    with running(command, tmp_path, stderr=subprocess.PIPE, text=True) as process:
        wait_for(lambda: partial.exists() and partial.stat().st_size > 100_000)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 75
    assert "interrupted by SIGINT" in said
    with xr.open_dataset(partial, engine="netcdf4") as history:
        assert history.attrs["status"] == "interrupted"
        assert history.attrs["integrator_steps"] > 0
        assert history.sizes["time"] > 1
