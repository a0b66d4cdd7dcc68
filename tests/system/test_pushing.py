"""Tooth pairs push and never pull: modes of contact agree with the state after every event."""

from __future__ import annotations

import numpy as np
import pytest

from evolvent import check_history
from system.runs import Run

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
    assert run.times("force_vanished").size > 20  # the pairs that would pull are let go
    assert least_force(run) == 0


def broken(run: Run, **changes: float) -> set[str]:
    """Names of the invariants that fail where a variable is changed at one output."""
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
