"""Wild gearboxes: energy balances to 1e-8 in every complete run at tolerance 1e-12.

``pytest tests/system/test_wild_gearboxes.py --long`` runs 500, without it some short ones.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from evolvent import check_history
from system.random_sets import seeds
from system.runs import Runs
from system.wild_gearboxes import wild_gearbox

TIGHT = "simulation.tolerance=1e-12"
SEEDS = (
    *(6, 16, 17, 22, 28, 31, 34, 41, 51, 56, 59, 77, 79, 89, 90),
    *(93, 104, 118, 121, 129, 167, 180, 224, 249, 278, 279, 282, 289, 293, 296, 306, 319),
    *(345, 348, 405, 407, 426, 438, 453, 471, 493, 519),
)
TRAINS = (117, 180, 278)  # whose rigid flanks open and close each other at one instant
LONG = 500
ENERGY = 1e-8  # required; 6.2e-11 was the worst of 488 runs
# Incomplete runs (docs/reports/random_sets.md), at 1e-12 and at the default tolerance.
ENDED_AT_TIGHT = {0, 5, 8, 101, 117, 147, 312, 339, 423, 427, 452}
ENDED = {312, 423}


def worst_of(history: xr.Dataset, name: str) -> float:
    """Worst deviation of an invariant."""
    (verdict,) = [v for v in check_history(history) if v.invariant.name == name]
    return verdict.worst or 0.0


@pytest.mark.parametrize("seed", seeds(SEEDS, LONG, without=ENDED_AT_TIGHT))
def test_the_energy_of_a_wild_gearbox_balances(runs: Runs, seed: int) -> None:
    run = runs(wild_gearbox(seed), TIGHT)
    assert run.exit_code == 0, run.messages
    assert worst_of(run.history, "energy balance") <= ENERGY


@pytest.mark.parametrize("seed", seeds((*SEEDS, *TRAINS), LONG, without=ENDED))
def test_a_wild_gearbox_keeps_its_invariants_at_the_default_tolerance(runs: Runs, seed: int):
    run = runs(wild_gearbox(seed))
    assert run.exit_code == 0, run.messages
    assert [(v.invariant.name, v.worst) for v in check_history(run.history) if v.failed] == []
    assert run.history.attrs["invariants"] == "held"


@pytest.mark.parametrize("rest", [1e-8, 1e-6, 1e-4, 1.0])
@pytest.mark.parametrize("seed", TRAINS)
def test_rigid_flanks_that_share_wheels_settle_at_every_rest_velocity(
    runs: Runs, seed: int, rest: float
) -> None:
    """In the past an open flank penetrated its mate, or the flanks bounced endlessly."""
    case = wild_gearbox(seed)
    for mesh in case["meshes"]:
        mesh["contact"]["rest_velocity"] = rest
    run = runs(case)
    assert run.exit_code == 0, run.messages
    history = run.history
    assert np.nanmax(history["pair_penetration"]) <= 1e-15  # roots lie 1e-10 h_0 past the change
    assert float(history["normal_force"].min()) >= 0
    assert [v for v in check_history(history) if v.failed] == []


@pytest.mark.parametrize("name", ["moving-axles-energy", "shaken-housing-energy"])
def test_energy_balances_where_axles_move_far_under_johnsons_law(runs: Runs, name: str) -> None:
    """Axes, deviations and a moving housing change the radii: 8e-7 and 4e-4 were once lost.

    In the second the flanks overlap by 3 % of their radii.
    """
    case = json.loads((Path(__file__).parent / "cases_of_energy.json").read_text())[name]
    run = runs(case, TIGHT)
    assert run.exit_code == 0, run.messages
    assert worst_of(run.history, "energy balance") <= 1e-11


@pytest.mark.parametrize("seed", [55, 393])
def test_teeth_off_their_path_overlap_nowhere(runs: Runs, seed: int) -> None:
    """Axes that were pushed apart: once a penetration of 19 m was reported there."""
    run = runs(wild_gearbox(seed))
    assert run.exit_code == 0, run.messages
    of_pairs = run.history["pair_penetration"].fillna(0.0).max("pair").clip(min=0.0)
    assert (run.history["penetration"] <= of_pairs).all()
    assert [v.invariant.name for v in check_history(run.history) if v.failed] == []
