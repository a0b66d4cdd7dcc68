"""Wild gearboxes: energy balances to 1e-8 in every run that comes to its end at tolerance 1e-12.

``pytest tests/system/test_wild_gearboxes.py --long`` runs the first 500; these are cheap ones.
"""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from evolvent import check_history
from system.runs import Runs
from system.wild_gearboxes import wild_gearbox

TIGHT = "simulation.tolerance=1e-12"
SEEDS = (
    *(6, 16, 17, 22, 28, 31, 34, 41, 51, 56, 59, 77, 79, 89, 90),
    *(93, 104, 118, 121, 129, 167, 224, 249, 279, 282, 289, 293, 296, 306, 319),
    *(345, 348, 405, 407, 426, 438, 453, 471, 493, 519),
)
LONG = 500
ENERGY = 1e-8  # asked for; 3.4e-11 was the worst of 507 runs
FAILED = 4  # exit code of a run that the model or the integrator ends
REFUSED = 3
SHARE = 0.01  # of sound runs at the default tolerance that may fail the check


def worst_of(history: xr.Dataset, name: str) -> float:
    """Worst deviation of an invariant."""
    (verdict,) = [v for v in check_history(history) if v.invariant.name == name]
    return verdict.worst or 0.0


@pytest.mark.parametrize("seed", SEEDS)
def test_the_energy_of_a_wild_gearbox_balances(runs: Runs, seed: int) -> None:
    run = runs(wild_gearbox(seed), TIGHT)
    assert run.exit_code == 0, run.messages
    assert worst_of(run.history, "energy balance") <= ENERGY


@pytest.mark.parametrize("seed", SEEDS)
def test_a_wild_gearbox_keeps_its_invariants_at_the_default_tolerance(runs: Runs, seed: int):
    run = runs(wild_gearbox(seed))
    assert run.exit_code == 0, run.messages
    assert [(v.invariant.name, v.worst) for v in check_history(run.history) if v.failed] == []
    assert run.history.attrs["invariants"] == "held"


@pytest.mark.parametrize("name", ["moving-axles-energy", "shaken-housing-energy"])
def test_energy_balances_where_axles_move_far_under_johnsons_law(runs: Runs, name: str) -> None:
    """Axles, deviations and a shaken housing change the radii: 8e-7 and 4e-4 got lost once.

    In the second the flanks overlap by 3 % of their radii.
    """
    case = json.loads((Path(__file__).parent / "cases_of_energy.json").read_text())[name]
    run = runs(case, TIGHT)
    assert run.exit_code == 0, run.messages
    assert worst_of(run.history, "energy balance") <= 1e-11


def run_apart(executable: Path, folder: Path, seed: int, *settings: str) -> Any:
    """Run a seed without a limit that fails the test: the exit code, the words and the history."""
    case, output = folder / f"{seed}.yaml", folder / f"{seed}.h5"
    case.write_text(json.dumps(wild_gearbox(seed)))
    options = [word for setting in settings for word in ("--set", setting)]
    command = [executable, "run", case, "-o", output, *options]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    except subprocess.TimeoutExpired:
        return None, "takes longer than 300 s", None
    if done.returncode != 0:
        return done.returncode, done.stderr.splitlines()[-1], None
    with xr.open_dataset(output, engine="netcdf4") as history:
        return 0, done.stderr, history.load()


def test_500_wild_gearboxes(executable: Path, tmp_path: Path, pytestconfig: pytest.Config) -> None:
    """Energy at tolerance 1e-12, and every invariant at the default one; prints what it saw."""
    if not pytestconfig.getoption("--long"):
        pytest.skip("a quarter of an hour: --long")
    energies: list[float] = []
    ended: list[str] = []
    broken: list[str] = []
    sound = 0
    for seed in range(LONG):
        code, words, history = run_apart(executable, tmp_path, seed, TIGHT)
        if history is None:
            ended.append(f"{seed}: {code} {re.sub(r'[^ ]*/', '', words)}")
        else:
            energies.append(worst_of(history, "energy balance"))
        code, words, history = run_apart(executable, tmp_path, seed)
        if history is not None:
            sound += 1
            failed = [
                f"{v.invariant.name} {v.worst:.3g}" for v in check_history(history) if v.failed
            ]
            broken += [f"{seed}: {', '.join(failed)}"] if failed else []
    print(f"{len(energies)} runs at 1e-12: energy balances to {np.max(energies):.3g}")
    print(f"{sound} runs at the default tolerance, of which fail the check: {broken or 'none'}")
    print("\n".join(["ended early at 1e-12:", *ended]))
    assert len(energies) >= 0.95 * LONG
    assert max(energies) <= ENERGY
    assert len(broken) <= SHARE * sound
