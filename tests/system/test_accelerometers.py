"""Accelerometers in a history: free vibration of a mounted housing, against closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj

from system.cases import unloaded_pair
from system.runs import Run, Runs
from system.test_integrators import IDA

MASS, INERTIA = 300.0, 20.0
STIFFNESS, TURN_STIFFNESS = 4e6, 3e5
SPEED, SPIN = 0.02, 0.5  # at the start, along x and about x
HEIGHT, DEPTH = 0.3, 0.1  # y and z of the accelerometers


def vibrating() -> dict[str, Any]:
    """Return a housing whose centre of mass, wheels and mount are on the x axis."""
    case = unloaded_pair("closed_form", duration=0.2, output_interval=1e-3, tolerance=1e-11)
    point = [0.0, HEIGHT, DEPTH]
    case["housing"] = {
        **{"kind": "mounted", "mass": MASS, "inertia": [INERTIA, 35.0, 40.0]},
        "mount": {
            "stiffness": [STIFFNESS] * 3,
            "rotational_stiffness": [TURN_STIFFNESS] * 3,
        },
        "velocity": [SPEED, 0.0, 0.0],
        "angular_velocity": [SPIN, 0.0, 0.0],
        "accelerometers": [
            {"name": "along", "point": point, "direction": [7.0, 0.0, 0.0]},
            {"name": "round", "point": point, "direction": [0.0, 0.0, 0.1]},
        ],
    }
    return case


@pytest.fixture(scope="module")
def run(runs: Runs) -> Run:
    result = runs(vibrating(), IDA)
    assert result.exit_code == 0, result.messages
    return result


def test_a_housing_on_springs_swings_to_and_fro(run: Run) -> None:
    h = run.history
    omega = np.sqrt(STIFFNESS / (MASS + float(h["mass"].sum())))
    reported = h["accelerometer_acceleration"].sel(accelerometer="along").values
    expected = -SPEED * omega * np.sin(omega * h["time"].values)
    # seven oscillations by steps with errors of 1e-11 of the scales
    np.testing.assert_allclose(reported, expected, rtol=0, atol=1e-8 * SPEED * omega)


def test_a_housing_on_torsion_springs_is_a_pendulum(run: Run) -> None:
    """The moment is that of a pendulum, K sin theta, with Jacobi's solution."""
    h = run.history
    inertia = INERTIA + float(h["transverse_inertia"].sum())
    omega = np.sqrt(TURN_STIFFNESS / inertia)
    half = SPIN / (2 * omega)  # sin of half the largest angle
    sn, cn, dn, _ = ellipj(omega * h["time"].values, half**2)
    rate, moment = 2 * half * omega * cn, -(omega**2) * 2 * half * sn * dn
    reported = h["accelerometer_acceleration"].sel(accelerometer="round").values
    expected = moment * HEIGHT - rate**2 * DEPTH
    size = np.abs(expected).max()
    np.testing.assert_allclose(reported, expected, rtol=0, atol=1e-8 * size)
    assert np.abs(rate**2 * DEPTH).max() > 1e-4 * size  # the centripetal part is significant


def test_the_history_names_them(run: Run) -> None:
    reported = run.history["accelerometer_acceleration"]
    assert reported.dims == ("time", "accelerometer")
    assert list(reported["accelerometer"].values) == ["along", "round"]
    assert reported.attrs["units"] == "m s-2"
