"""One degree of freedom with backlash, against an independent program without gears.

Natural frequency 1586 Hz, damping ratio 0.05, excited at 0.9 times that by a triangle wave of 60 %
of the mean: a stable motion with the period of the load, in which contact is lost once a period.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from backlash_oscillator import Oscillator, Solution, solve

from system.cases import STEEL
from system.runs import Run

PERIODS, ROWS = 50, 20
BASE = 0.075 * math.cos(math.radians(20))  # of the gear
INERTIA, STIFFNESS, BACKLASH = 1e-3, 2e7, 4e-5
MASS = INERTIA / BASE**2
FREQUENCY = math.sqrt(STIFFNESS / MASS)
OSCILLATOR = Oscillator(
    mass=MASS,
    stiffness=STIFFNESS,
    damping=2 * 0.05 * math.sqrt(STIFFNESS * MASS),
    backlash=BACKLASH,
    mean=100.0,
    amplitude=60.0,
    period=2 * math.pi / (0.9 * FREQUENCY),
)


@pytest.fixture(scope="module")
def pair_run(runs) -> Run:
    """Equivalent pair of wheels: the pinion has a constant speed, the load is on the gear."""
    o = OSCILLATOR
    time, force = o.knots(PERIODS)
    speeds = {"pinion": -60.0, "gear": 40.0}
    case = {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                **{"name": "pinion", "teeth": 20, "pitch_radius": 0.05, "width": 0.02},
                **{"material": "steel", "centre": [0, 0]},
                "loads": [{"kind": "speed", "value": speeds["pinion"]}],
            },
            {
                **{"name": "gear", "teeth": 30, "width": 0.02, "material": "steel"},
                "inertia": INERTIA,
                "loads": [
                    {"kind": "table", "time": time.tolist(), "torque": (-BASE * force).tolist()}
                ],
            },
        ],
        "meshes": [
            {
                **{"driving": "pinion", "driven": "gear", "driving_rotation": "clockwise"},
                **{"centre_line_angle": 0, "pressure_angle": 20, "backlash": BACKLASH},
                "contact": {"law": "linear", "stiffness": STIFFNESS},
                "damping": {"law": "linear", "coefficient": o.damping},
            }
        ],
        "simulation": {
            **{"duration": PERIODS * o.period, "output_interval": o.period / ROWS},
            "tolerance": 1e-12,
            "initial": {
                **{"kind": "speeds", "speeds": speeds},
                "gaps": {"pinion-gear": -o.mean / STIFFNESS},
            },
        },
    }
    run = runs(case)
    assert run.exit_code == 0, run.messages
    return run


@pytest.fixture(scope="module")
def solution(pair_run) -> Solution:
    return solve(OSCILLATOR, PERIODS, pair_run.history["time"].values)


def test_the_motion_is_that_of_the_independent_program(pair_run, solution):
    x = -pair_run.history["gap"][:, 0].values
    largest = abs(solution.x).max()
    assert abs(x - solution.x).max() <= 1e-7 * largest


def test_contact_is_lost_and_found_at_the_same_times(pair_run, solution):
    opened, closed = pair_run.times("contact_opened"), pair_run.times("contact_closed")
    assert len(solution.opened) >= PERIODS - 1
    np.testing.assert_allclose(opened, solution.opened, rtol=0, atol=1e-7 * OSCILLATOR.period)
    np.testing.assert_allclose(closed, solution.closed, rtol=0, atol=1e-7 * OSCILLATOR.period)


def test_the_motion_becomes_periodic_and_loses_contact_in_every_period(solution):
    """Purpose of the parameters."""
    x = solution.x[: PERIODS * ROWS].reshape(PERIODS, ROWS)
    assert abs(x[-1] - x[-2]).max() <= 1e-3 * abs(x).max()
    assert (x.min(axis=1) < -5e-7).all()
    assert (x.min(axis=1) > -BACKLASH).all()
