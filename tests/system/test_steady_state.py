"""The steady state of the paper's frictionless gearbox, against its closed form."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest

from system.cases import pair
from system.runs import FRICTIONLESS, TRACKINGS, tracking
from system.stribeck_gearboxes import stribeck_gearbox

WIDTH = 0.1  # [m]
EFFECTIVE_MODULUS = 2e11 / (2 * (1 - 0.3**2))  # [Pa]
STIFFNESS = 1e9  # of the slider [N/m]
ALPHA = 1.05 * math.atan(2 * math.pi / 50)  # working pressure angle, paper 7.1
BASE_A, BASE_B = 0.2 * math.cos(ALPHA), 0.3 * math.cos(ALPHA)  # [m]
FORCE = 1.0 / BASE_A  # the pinion's 1 N m [N]
SPEED = 0.15  # 1.5 N m on the gear against 10 N m s/rad [rad/s]


def penetration() -> float:
    """Compute h [m] by (13), with the axis in equilibrium with its spring."""
    slider = h = 0.0
    for _ in range(50):  # contracts by 1e-8 per iteration
        distance = 0.5 + slider
        length = math.sqrt(distance**2 - (BASE_A + BASE_B) ** 2)
        slider = FORCE * length / distance / STIFFNESS
        line = FORCE / WIDTH
        scale = math.pi * EFFECTIVE_MODULUS
        h = line / scale * (math.log(4 * scale * (length + h) / line) - 1)
    return h


def test_the_closed_form_has_the_known_values():
    assert penetration() == pytest.approx(2.96653e-9, rel=2e-6)  # six printed digits
    assert pytest.approx(5.0434, rel=1e-5) == FORCE  # five


@pytest.mark.parametrize("kind", TRACKINGS)
def test_a_run_from_rest_comes_to_the_steady_state(runs, kind):
    last = runs(FRICTIONLESS, tracking(kind), "simulation.duration=20").history.isel(time=-1)
    # The speeds approach theirs with a time constant of 1.43 s: 9e-7 remain after 20 s.
    assert float(last["penetration"][0]) == pytest.approx(penetration(), rel=1e-5)
    assert float(last["normal_force"][0]) == pytest.approx(FORCE, rel=1e-5)
    assert float(last["angular_velocity"].sel(wheel="gear")) == pytest.approx(SPEED, rel=1e-5)


@pytest.mark.parametrize("kind", TRACKINGS)
def test_a_run_from_the_steady_state_stays_there(runs, kind):
    history = runs(pair(0.0, kind, initial={"kind": "steady"})).history
    # A complete equilibrium: the difference is rounding, of h relative to its nanometres.
    np.testing.assert_allclose(history["penetration"][:, 0], penetration(), rtol=1e-12)
    np.testing.assert_allclose(history["normal_force"][:, 0], FORCE, rtol=1e-12)
    np.testing.assert_allclose(history["angular_velocity"].sel(wheel="gear"), SPEED, rtol=1e-12)


def test_a_pair_that_its_own_load_takes_off_the_path_is_named(evolvent, tmp_path):
    """Friction halves the speed under load; the axis yields, and the pair is off the path."""
    file = tmp_path / "case.yaml"
    case = stribeck_gearbox(156)
    case["simulation"]["initial"]["position"] = 0.0
    file.write_text(json.dumps(case))
    done = evolvent("run", file)
    assert done.returncode == 3
    assert "there is no steady state: tooth pair 0 is on the path of contact while" in done.stderr
