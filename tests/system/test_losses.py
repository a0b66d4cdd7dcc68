"""Losses over runs: their integrals, with those of events, equal the dissipated energy.

Every variable in watts is included, with every entry of the tables of damping laws and supports;
tests/analysis/test_losses.py tests single states, to rounding.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from kernel.kernel import DAMPING, Kernel
from load_samples import SUPPORTS
from system.cases import pair, rigid
from system.pushing_cases import pushing_case
from system.runs import Run
from system.test_integrators import IDA
from system.test_loads import loaded
from system.test_tables import names, row

ROWS = 20000


def fine(case: dict[str, Any], duration: float) -> dict[str, Any]:
    case["simulation"] |= {"duration": duration, "output_interval": duration / ROWS}
    return case


def losses(run: Run) -> dict[str, Any]:
    """Power losses over time, each the sum over all wheels, meshes or shafts."""
    assert run.exit_code == 0, run.messages
    return {
        str(name): variable.values.reshape(variable.sizes["time"], -1).sum(axis=1)
        for name, variable in run.history.data_vars.items()
        if variable.attrs.get("units") == "W"
    }


def check_integral(run: Run, error: float = 1e-4) -> dict[str, float]:
    """Check the integrals, by trapezia between the outputs; return them."""
    time = run.history["time"].values
    lost = {name: float(np.trapezoid(power, time)) for name, power in losses(run).items()}
    sides = run.events["dissipated_energy"].values
    jumps = sides[:, 1] - sides[:, 0]
    total = run.history["dissipated_energy"].values
    size = sum(abs(energy) for energy in lost.values()) + np.abs(jumps).sum()
    assert size > 0
    # friction jumps at events between outputs: half a row's loss each
    assert abs(sum(lost.values()) + jumps.sum() - (total[-1] - total[0])) <= error * size, lost
    return lost


def test_with_every_damping_law_the_integrals_are_the_energy(runs, kernel: Kernel) -> None:
    for seed, name in enumerate(names(kernel, DAMPING)):
        case = fine(pushing_case(kernel, row(damping=name), seed), 1e-3)
        run = runs(case)
        lost = check_integral(run)
        assert (lost["contact_damping_loss"] > 0) == (name != "none"), name
        for power in ("contact_damping_loss", "friction_loss", "support_damping_loss"):
            values = losses(run)[power]
            assert values.min() >= -1e-9 * max(values.max(), 1e-12), (name, power)


@pytest.mark.parametrize("name", SUPPORTS)
def test_with_every_support_they_are(runs, name: str) -> None:
    case = loaded("torque")
    case["wheels"][1]["support"] = dict(SUPPORTS[name])
    lost = check_integral(runs(fine(case, 0.02)))
    assert (lost["support_damping_loss"] > 0) == (name != "fixed")


def test_in_a_mounted_housing_they_are(runs) -> None:
    case = fine(pair(0.1), 0.02)
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": -50.0, "against": "housing"}]
    dampers = {"stiffness": [1e6] * 3, "damping": [500.0] * 3, "rotational_damping": [200.0] * 3}
    inertia = {"mass": 30.0, "inertia": [2.0, 3.5, 4.0]}
    turning = {"velocity": [0.02, 0.01, 0.0], "angular_velocity": [0.05, 0.0, 0.1]}
    case["housing"] = {"kind": "mounted", **inertia, **turning, "mount": dampers}
    lost = check_integral(runs(case, IDA))
    assert lost["mount_damping_loss"] > 0.1 * sum(lost.values())


def test_impacts_of_a_rigid_contact_are_jumps(runs) -> None:
    case = fine(rigid(pair(0.1), restitution=0.4), 0.05)
    case["simulation"]["initial"] = {"kind": "rest", "gaps": {"pinion-gear": 1e-6}}
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": -50.0}]
    run = runs(case, IDA)
    lost = check_integral(run)
    assert lost["contact_damping_loss"] == lost["curvature_loss"] == 0
    impacts = run.events["kind"].values == "impact"
    sides = run.events["dissipated_energy"].values[impacts]
    assert impacts.sum() > 2
    assert (sides[:, 1] > sides[:, 0]).all()


def test_the_acceleration_of_an_axle_is_the_rate_of_its_velocity(runs) -> None:
    """By differences of fourth order in intervals without events; zero for a fixed axis."""
    case = loaded("torque")
    case["wheels"][1]["support"] = dict(SUPPORTS["bearing"])
    run = runs(fine(case, 0.02))
    h = run.history
    time, interval = h["time"].values, 0.02 / ROWS
    velocity, reported = (h[name].values for name in ("centre_velocity", "centre_acceleration"))
    assert (reported[:, 0] == 0).all()
    rate = (8 * (velocity[3:-1] - velocity[1:-3]) - (velocity[4:] - velocity[:-4])) / (
        12 * interval
    )
    events = run.events["time"].values
    smooth = np.array(
        [not ((events > t - 3 * interval) & (events < t + 3 * interval)).any() for t in time[2:-2]]
    )
    assert smooth.sum() > 0.9 * ROWS
    size = np.abs(reported[:, 1]).max()
    # differences of velocities that are interpolated to 1e-9 or better of their scale
    difference = np.abs(rate - reported[2:-2])[smooth]
    assert np.quantile(difference, 0.99) <= 1e-5 * size
