"""Tooth pairs push and never pull: modes of contact agree with the state after every event."""

from __future__ import annotations

import pytest

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
