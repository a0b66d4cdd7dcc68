"""Runs from the steady start of flanks with deviations: whole trains, both integrators."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from system.real_cases import real_pair, torque, viscous
from system.runs import Runs

TIPS = (66.0e-3, 96.0e-3)  # diameters of the gears of 20 and 30 teeth [m]
INTEGRATORS = pytest.mark.parametrize("integrator", ["radau", "ida"])


def relieved(shape: str, rotation: str, *, speed: float, bearings: bool = False) -> dict[str, Any]:
    """Pair of tip-relief.yaml without pitch errors, so that the motion becomes periodic."""
    sign = 1 if rotation == "clockwise" else -1
    loads = (torque(-100.0 * sign), viscous(100.0 * 1.5**2 / speed))
    support = {"kind": "bearing", "mass": 1, "stiffness": [3e8, 3e8], "damping": [3e3, 3e3]}
    wheels = [
        {
            "tip_relief": {"amount": 12e-6, "diameter": tip - 4.4e-3, "shape": shape},
            **({"support": support} if bearings else {}),
            **load,
        }
        for tip, load in zip(TIPS, loads, strict=True)
    ]
    pitch = 2 * np.pi / 20 / speed
    return real_pair(
        (20, 30),
        wheels=(wheels[0], wheels[1]),
        mesh={
            "driving_rotation": rotation,
            "backlash": 1e-4,
            "contact": {"law": "johnson"},
            "damping": {"law": "linear", "coefficient": 3000},
        },
        duration=float(12 * pitch),
        output_interval=float(pitch / 400),
        initial={"kind": "steady"},
    )


@INTEGRATORS
@pytest.mark.parametrize("shape", ["linear", "parabolic"])
@pytest.mark.parametrize("rotation", ["clockwise", "counterclockwise"])
@pytest.mark.parametrize("bearings", [False, True])
def test_a_steady_start_vibrates_no_more_than_the_motion_it_comes_to(
    runs: Runs, integrator: str, shape: str, rotation: str, bearings: bool
) -> None:
    """Below resonance: the first two mesh periods against the last four."""
    case = relieved(shape, rotation, speed=20.0, bearings=bearings)
    run = runs(case, f"simulation.integrator={integrator}")
    assert run.exit_code == 0
    h = run.history["penetration"].isel(mesh=0).values
    force = run.history["normal_force"].isel(mesh=0).values
    for values in (h, force):
        later = values[8 * 400 :]
        early = values[: 2 * 400]
        swing = np.ptp(later)
        # the motion repeats to a hundredth of its range
        assert early.max() < later.max() + 0.02 * swing
        assert early.min() > later.min() - 0.02 * swing


@INTEGRATORS
@pytest.mark.parametrize("accuracy", [1, 5, 9])
@pytest.mark.parametrize("rotation", ["clockwise", "counterclockwise"])
def test_every_class_starts_steadily_with_both_integrators(
    runs: Runs, integrator: str, accuracy: int, rotation: str
) -> None:
    case = relieved("parabolic", rotation, speed=75.0)
    for i, wheel in enumerate(case["wheels"]):
        wheel["accuracy"] = {"class": accuracy, "seed": 3 + i}
        wheel["eccentricity"] = {"amount": 5e-6, "phase": 40.0}
        wheel["profile_crowning"] = 2e-6
        wheel["root_relief"] = {"amount": 3e-6, "roll_angle": 12.0 + 3 * i}
    run = runs(case, f"simulation.integrator={integrator}", "simulation.duration=0.002")
    assert run.exit_code == 0
    force = run.history["normal_force"].isel(mesh=0).values
    # the pinion's 100 N m on the base radius of 28.19 mm, except for the slopes in the lever arms
    assert force[0] == pytest.approx(100 / 28.19e-3, rel=0.03)


def test_both_integrators_start_from_the_same_state(runs: Runs) -> None:
    case = relieved("linear", "clockwise", speed=75.0, bearings=True)
    first = [
        runs(case, f"simulation.integrator={integrator}").history.isel(time=0)
        for integrator in ("radau", "ida")
    ]
    for name in ("penetration", "normal_force", "angular_velocity", "centre_velocity"):
        np.testing.assert_array_equal(first[0][name], first[1][name])


@INTEGRATORS
def test_two_stages_with_relief_start_steadily(runs: Runs, integrator: str) -> None:
    run = runs(
        "two-stage-gears.yaml",
        "simulation.initial={kind: steady}",
        "simulation.duration=0.002",
        f"simulation.integrator={integrator}",
        "wheels.pinion-1.tip_relief={amount: 1.0e-5, diameter: 0.054, shape: linear}",
        "wheels.pinion-2.tip_relief={amount: 1.0e-5, diameter: 0.073, shape: parabolic}",
        *(
            f"wheels.{wheel}.accuracy={{class: 6, seed: {seed}}}"
            for seed, wheel in enumerate(("pinion-1", "gear-1", "pinion-2", "gear-2"))
        ),
    )
    assert run.exit_code == 0
    # the motor's 5 N m times the transmission ratio, less what friction of 0.05 loses in two
    # meshes, 1.3 %; the speeds differ by the slopes of relieved and erroneous flanks
    ratio = 47 / 20 * 53 / 23
    start = run.history.isel(time=0)
    torque_ratio = float(
        start.load_torque.sel(wheel="drum") / -start.load_torque.sel(wheel="motor")
    )
    assert 0.98 * ratio < torque_ratio < 0.99 * ratio
    speeds = start.angular_velocity
    speed_ratio = float(speeds.sel(wheel="motor") / speeds.sel(wheel="drum"))
    assert abs(speed_ratio) == pytest.approx(ratio, rel=2e-3)
