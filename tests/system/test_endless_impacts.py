"""Unlimited impacts: a run reports them, with mesh and time, after a bounded number."""

from __future__ import annotations

import re

import pytest

from system.runs import Runs

START = (
    "simulation.initial={kind: speeds, speeds: {pinion: -1, gear: 0.66}, gaps: {pinion-gear: 1e-5}}"
)
BOUNCES = 1500  # restitution 0.9: 400 until a bounce is rounding of the time, and 1000 more


@pytest.mark.parametrize("rest_velocity", [1e-10, 1e-13, 1e-100, 1e-300])
def test_bounces_below_what_digits_resolve_are_named(runs: Runs, rest_velocity: float) -> None:
    contact = f"{{law: rigid, restitution: 0.9, rest_velocity: {rest_velocity}}}"
    run = runs(
        "paper-rigid.yaml",
        *(f"meshes.0.contact={contact}", "meshes.0.backlash=1e-4"),
        *("simulation.duration=0.5", START),
    )
    assert run.exit_code == 4
    last = run.messages.splitlines()[-1]
    assert re.search(r"t = [0-9.]+ s: mesh 'pinion-gear': endless impacts, ", last), last
    assert "increase rest_velocity" in last
    assert len(run.times("impact")) <= BOUNCES


def test_the_same_bounces_come_to_rest_at_a_velocity_that_digits_resolve(runs: Runs) -> None:
    contact = "{law: rigid, restitution: 0.9, rest_velocity: 1e-6}"
    run = runs(
        "paper-rigid.yaml",
        *(f"meshes.0.contact={contact}", "meshes.0.backlash=1e-4"),
        *("simulation.duration=0.5", START),
    )
    assert run.exit_code == 0
    assert len(run.times("impacts_ended")) > 0
