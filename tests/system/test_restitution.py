"""Impacts of two unloaded wheels: the actual restitution of the Hunt-Crossley laws."""

from __future__ import annotations

import math
from typing import Any

import pytest
from restitution import FACTORS, effective_restitution, factor

from system.cases import unloaded_pair
from system.runs import Run

BASE_PINION = 0.2 * math.cos(1.05 * math.atan(2 * math.pi / 50))
SPEEDS = (1e-3, 1e-2, 1e-1)  # of approach along the line of action [m/s]
NOMINAL = (0.05, 0.5, 0.9)
ELASTIC = {
    "johnson": {},
    "radzimovsky": {},
    "linear": {"stiffness": 1e9},
    "yang_lin": {},
    "power": {"coefficient": 1e11, "exponent": 1.5},
}
# 2e-11 is reached at this tolerance of the integrator, 1e-9 at 1e-11.
INTEGRATOR, TOLERANCE = 1e-13, 1e-8


def impact(runs, damping: dict[str, Any], contact: dict[str, Any], speed: float) -> Run:
    """The pinion strikes the gear at rest, with the flanks initially in contact."""
    speeds = {"pinion": -speed / BASE_PINION, "gear": 0.0}
    case = unloaded_pair(
        "closed_form",
        duration=0.02,
        output_interval=0.01,
        tolerance=INTEGRATOR,
        initial={"kind": "speeds", "speeds": speeds},
    )
    case["meshes"][0] |= {"damping": damping, "contact": contact}
    return runs(case)


def restitution(run: Run) -> float:
    """Relative speed along the line of action after the impact over the one before."""
    assert len(run.times("contact_opened")) == 1
    assert len(run.times("contact_closed")) == 0
    speed = run.history["angular_velocity"].values @ run.history["base_radius"].values
    return -speed[-1] / speed[0]


@pytest.mark.parametrize("speed", SPEEDS)
@pytest.mark.parametrize("nominal", NOMINAL)
@pytest.mark.parametrize("law", FACTORS)
def test_an_impact_has_the_restitution_of_the_equation_at_every_speed(runs, law, nominal, speed):
    damping = {"law": law, "restitution": nominal, "v0_min": 1e-6}
    expected = float(effective_restitution(factor(law, nominal)))
    found = restitution(impact(runs, damping, {"law": "johnson"}, speed))
    assert found == pytest.approx(expected, rel=0, abs=TOLERANCE)


@pytest.mark.parametrize("contact", ELASTIC)
def test_the_restitution_does_not_depend_on_the_elastic_law(runs, contact):
    damping = {"law": "gonthier", "restitution": 0.6, "v0_min": 1e-6}
    expected = float(effective_restitution(factor("gonthier", 0.6)))
    found = restitution(impact(runs, damping, {"law": contact, **ELASTIC[contact]}, 1e-2))
    assert found == pytest.approx(expected, rel=0, abs=TOLERANCE)


def test_an_impact_after_free_flight_has_the_same_restitution(runs):
    """v0 is the speed at the located contact closure."""
    speed = 1e-2
    case = unloaded_pair(
        "differential",
        duration=0.02,
        output_interval=0.01,
        tolerance=INTEGRATOR,
        initial={
            "kind": "speeds",
            "speeds": {"pinion": -speed / BASE_PINION, "gear": 0.0},
            "gaps": {"pinion-gear": 1e-5},
        },
    )
    case["meshes"][0]["damping"] = {"law": "flores", "restitution": 0.5, "v0_min": 1e-6}
    run = runs(case)
    # from contact of the flanks to 1e-10 of the penetration scale beyond it
    assert run.times("contact_closed") == pytest.approx([1e-5 / speed], rel=1e-9)
    after = run.history["angular_velocity"].values @ run.history["base_radius"].values
    expected = float(effective_restitution(factor("flores", 0.5)))
    assert -after[-1] / after[0] == pytest.approx(expected, rel=0, abs=TOLERANCE)


def test_below_v0_min_an_impact_loses_less(runs):
    """The force is that of an impact at v0_min: chi is scaled by v/v0_min."""
    speed, v0_min, chi = 1e-3, 4e-3, factor("hunt_crossley", 0.5)
    damping = {"law": "hunt_crossley", "restitution": 0.5, "v0_min": v0_min}
    found = restitution(impact(runs, damping, {"law": "johnson"}, speed))
    expected = float(effective_restitution(chi * speed / v0_min))
    assert found == pytest.approx(expected, rel=0, abs=TOLERANCE)
