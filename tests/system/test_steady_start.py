"""The steady start: slow modes at their mean, fast modes on the quasi-static path."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from system.edrive import OUTPUT_TORQUE, TEETH, edrive
from system.runs import Runs

long = pytest.mark.long
EVERY_STIFFNESS = pytest.mark.parametrize(
    "stiffness", [1500.0, 15e3, pytest.param(5e3, marks=long), pytest.param(150e3, marks=long)]
)
EVERY_POSITION = pytest.mark.parametrize(
    "initial",
    [
        {},
        {"position": 0.65},
        *(pytest.param({"position": x}, marks=long) for x in (0.1, 0.4, 0.9)),
    ],
    ids=str,
)
KINEMATIC = {
    "motor": 1.0,
    "p1": 1.0,
    "g1": -TEETH["p1"] / TEETH["g1"],
    "p2": -TEETH["p1"] / TEETH["g1"],
    "g2": TEETH["p1"] * TEETH["p2"] / (TEETH["g1"] * TEETH["g2"]),
    "wheels": TEETH["p1"] * TEETH["p2"] / (TEETH["g1"] * TEETH["g2"]),
}


@pytest.mark.parametrize("stiffness", [1500.0, 150e3])
@pytest.mark.parametrize("position", [0.1, 0.7])
def test_modes_name_the_mean_speeds_behind_a_soft_shaft(
    evolvent: Callable[..., subprocess.CompletedProcess[str]],
    tmp_path: Path,
    stiffness: float,
    position: float,
) -> None:
    """The disc does not follow the quasi-static path, whose slope would turn it backwards."""
    case = tmp_path / "case.yaml"
    case.write_text(json.dumps(edrive(stiffness)))
    done = evolvent("modes", case, "--json", "--mesh-position", str(position))
    assert done.returncode == 0, done.stderr
    speeds = json.loads(done.stdout)["state"]["wheels"]
    for wheel, ratio in KINEMATIC.items():
        shown = speeds[wheel]["angular_velocity"]
        assert shown == pytest.approx(ratio * speeds["motor"]["angular_velocity"], rel=1e-3)


@EVERY_STIFFNESS
@EVERY_POSITION
def test_inertias_behind_a_soft_shaft_start_with_the_mean_speed(
    runs: Runs, stiffness: float, initial: dict[str, Any]
) -> None:
    """Shaft torque, wheel speeds and dynamic factors of the first revolution equal later ones."""
    history = runs(edrive(stiffness, **initial)).history
    mean = float(history.angular_velocity.sel(wheel="motor").mean())
    for wheel, ratio in KINEMATIC.items():
        start = float(history.angular_velocity.sel(wheel=wheel)[0])
        assert start == pytest.approx(ratio * mean, rel=1e-3)
    torque = history.shaft_torque.sel(shaft="output")
    # the settled torque varies by 4 N m behind the stiffest shaft
    assert float(abs(torque - OUTPUT_TORQUE).max()) < 5e-3 * OUTPUT_TORQUE
    settled = runs(
        edrive(stiffness, position=0.3),
        "simulation.duration=0.4",
        "simulation.metrics.from=0.3",
    ).history
    np.testing.assert_allclose(
        history.window_dynamic_factor, settled.window_dynamic_factor, rtol=5e-3
    )


def test_the_start_is_continuous_from_slow_to_fast_modes(runs: Runs) -> None:
    """Over the speed, from modes below the mesh frequency to above: half steps, half errors."""

    def errors(speeds: np.ndarray) -> np.ndarray:
        found = []
        for speed in speeds:
            case = edrive(15e3, position=0.4)
            del case["simulation"]["metrics"]
            case["simulation"] |= {"duration": 1e-6, "output": {"interval": 1e-6}}
            case["wheels"][0]["loads"][0]["speed"] = float(speed)
            found.append(runs(case).history.transmission_error[0].values)
        return np.array(found)

    fine = errors(np.linspace(200.0, 2400.0, 23))
    steps = [abs(np.diff(fine[::stride], axis=0)).max() for stride in (1, 2)]
    assert steps[0] < 0.7 * steps[1]
    assert np.ptp(fine, axis=0).max() > 3 * steps[0]
