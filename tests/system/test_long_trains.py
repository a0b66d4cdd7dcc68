"""Rows of many wheels: they run, and results found mesh by mesh equal those found at once."""

from __future__ import annotations

import json
from typing import Any

import pytest
import xarray as xr

from evolvent.physics.extremes import Extreme, recorded_extremes
from system.trains import row

FRICTION = {"law": "coulomb", "coefficient": 0.05, "regularisation_velocity": 1e-3}
BEARING = {"kind": "bearing", "stiffness": [2e8, 3e8], "damping": [2e3, 3e3], "mass": 1}


def bearing_row(n: int, **simulation: Any) -> dict[str, Any]:
    """Row of n wheels in bearings, with friction."""
    case = row(n, **simulation)
    case["wheels"] = [wheel | {"support": BEARING} for wheel in case["wheels"]]
    case["meshes"] = [mesh | {"friction": FRICTION} for mesh in case["meshes"]]
    return case


def unit(history: xr.Dataset, extreme: Extreme) -> float:
    """Return the largest value of the output in all meshes."""
    extremes = [e.value for e in recorded_extremes(history) if e.output == extreme.output]
    return max(float(abs(value).max()) for value in extremes)


def test_a_row_of_200_wheels_runs_in_the_memory_of_an_ordinary_process(runs):
    """Its Jacobian has 1202 rows: a full one would exceed the stack of a process."""
    steady = {"initial": {"kind": "steady"}}
    run = runs(bearing_row(200, duration=1e-3, output_interval=5e-4, tolerance=1e-6, **steady))
    assert run.exit_code == 0, run.messages
    assert run.history.sizes["wheel"] == 200
    assert float(run.history["normal_force"].min()) > 0  # the load is transmitted through all of it
    assert run.history.attrs["invariants"] == "held"  # checked during the run


@pytest.mark.parametrize("wheels", [5, 14])
def test_extremes_of_each_mesh_do_not_depend_on_how_many_there_are(runs, wheels):
    """First meshes of a row with undisturbed ends: they move as those of a shorter one.

    Up to eight meshes are evaluated at once, more one by one.
    """
    histories = []
    for output in (1e-4, 2e-6):
        case = bearing_row(wheels, duration=6e-4, output_interval=output, tolerance=1e-8)
        case["simulation"]["integrator"] = "radau"
        histories.append(runs(case).history)
    coarse, fine = histories
    for extreme in recorded_extremes(coarse):
        values = fine[extreme.output]
        others = [dim for dim in values.dims if dim != "mesh"]
        sampled = values.max(others) if extreme.is_largest else values.min(others)
        beyond = (extreme.value - sampled).values * (1 if extreme.is_largest else -1)
        beyond /= unit(coarse, extreme)
        # outputs are on the same curves: they exceed no extreme, and approach each of them within
        # (2 pi f dt)**2/8 of a vibration of 6 kHz, and the slope times dt at a jump of the curve
        assert beyond.min() >= -1e-6, extreme.value.name
        assert beyond.max() <= 0.02, extreme.value.name


def test_integrators_agree_in_a_long_row(runs):
    case = bearing_row(30, duration=4e-4, output_interval=1e-5, tolerance=1e-8)
    radau, ida = (
        runs(json.loads(json.dumps(case)), f"simulation.integrator={name}").history
        for name in ("radau", "ida")
    )
    for name in ("angular_velocity", "normal_force", "centre_displacement", "kinetic_energy"):
        largest = float(abs(radau[name]).max())
        difference = float(abs(radau[name] - ida[name]).max())
        assert difference <= 1e-4 * largest, name  # errors of IDA at this tolerance, at events
    for one, other in zip(recorded_extremes(radau), recorded_extremes(ida), strict=True):
        difference = abs(one.value - other.value).values.max()
        assert difference <= 1e-4 * unit(radau, one), one.value.name
