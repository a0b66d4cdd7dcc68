"""No adhesive forces of tooth pairs: contact modes agree with the state after every event.

``pytest tests/system/test_pushing.py --long`` runs 500 random pairs of gears, without it 60.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from evolvent import check_history
from kernel.kernel import Kernel
from system.pushing_cases import FACTORS, levels, met, pushing_case, rows
from system.random_sets import seeds
from system.runs import Run

SHORT, LONG = 79, 500  # cases
# Energy errors above ten times the tolerance. 36: 18 bounces within 0.5 ms.
# 24 times by IDA, probably by its restarts after events; 1.2 times by radau.
INEXACT_BY_IDA = {36: 5e-8}

INTEGRATORS = ("radau", "ida")
RELIEF = (
    "wheels.pinion.tip_relief={amount: 2e-5, roll_angle: 34}",
    "meshes.pinion-gear.damping={law: hunt_crossley, restitution: 0.8, v0_min: 1e-3}",
)


def least_force(run: Run) -> float:
    """Smallest force of any tooth pair over the mean force of the mesh."""
    return float(run.history["pair_normal_force"].min() / run.history["normal_force"].mean())


@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_strong_damper_does_not_pull_where_linear_relief_begins(runs, integrator):
    """There the rate of the penetration jumps, and with it the damper's force."""
    run = runs("spur-pair.yaml", *RELIEF, f"simulation.integrator={integrator}")
    assert run.exit_code == 0
    assert run.times("profile_border").size > 20
    assert run.times("force_vanished").size > 20  # pairs that would pull are released
    assert least_force(run) == 0


def broken(run: Run, **changes: float) -> set[str]:
    """Names of the invariants that fail after a change of a variable at one output."""
    history = run.history.copy(deep=True)
    loaded = np.argwhere(history["pair_contact_mode"].values == 1)[7]
    for name, value in changes.items():
        history[name].values[tuple(loaded)] = value
    return {v.invariant.name for v in check_history(history) if v.failed}


def test_check_tells_a_pair_that_pulls_and_a_mode_that_contradicts_the_gap(runs):
    run = runs("spur-pair.yaml", *RELIEF)
    force = float(run.history["reference_force"][0])
    depth = float(run.history["reference_penetration"][0])
    assert broken(run) == set()
    assert broken(run, pair_normal_force=-2e-6 * force) == {"pushing"}
    assert broken(run, pair_penetration=-2e-6 * depth) == {"contact modes"}
    assert broken(run, pair_penetration=-0.5e-6 * depth) == set()
    assert broken(run, pair_contact_mode=0) == {"contact modes"}
    assert broken(run, pair_contact_mode=2) == {"contact modes"}


# ---- pairwise combinations of the tables


def test_every_two_entries_of_the_tables_meet(kernel: Kernel):
    everything = set()
    for (a, first), (b, second) in itertools.combinations(
        zip(FACTORS, levels(kernel), strict=True), 2
    ):
        if (a, b) == ("pinion", "gear"):
            continue
        a, b = ("deviation" if name in ("pinion", "gear") else name for name in (a, b))
        everything |= {(a, one, b, other) for one in first for other in second}
    assert everything == set(itertools.chain.from_iterable(map(met, rows(kernel, SHORT))))


@pytest.mark.parametrize("seed", seeds(range(SHORT), LONG))
def test_no_tooth_pair_pulls_whatever_laws_and_deviations_meet(runs, kernel, seed):
    row = rows(kernel, LONG)[seed]
    run = runs(pushing_case(kernel, row, seed))
    assert run.exit_code == 0, (row, run.messages)
    force = run.history["pair_normal_force"] / run.history["reference_force"]
    assert float(force.min()) >= -1e-6, row
    assert float(force.max()) > 0.1, row
    verdicts = {v.invariant.name: v for v in check_history(run.history)}
    assert verdicts["contact modes"].verdict == "pass", row
    energy = verdicts["energy balance"]
    assert energy.worst <= INEXACT_BY_IDA.get(seed, energy.bound), row
