"""Example of docs/guides/operating_points.md: a motor, a pair with compliant teeth, a machine."""

from __future__ import annotations

import numpy as np
import pytest

EXAMPLE = "motor-driven.yaml"
CONSTANT = "wheels.machine.loads=[{kind: torque, value: 87.68}]"


def test_the_speed_settles_where_the_torques_balance(runs):
    """The power of the motor is that of the machine plus losses; the flanks never separate."""
    history = runs(EXAMPLE).history
    end = history.sel(time=slice(0.1, None))
    power = (end["load_torque"] * end["angular_velocity"]).mean("time")
    given, taken = float(power.sel(wheel="motor")), -float(power.sel(wheel="machine"))
    lost = sum(
        float(variable.mean("time").sum())
        for variable in end.data_vars.values()
        if variable.attrs.get("units") == "W"
    )
    # not over whole periods, and the kinetic energy of the torsional mode is still decaying
    assert abs(given - taken - lost) <= 1e-4 * given
    assert 0.005 * given < lost < 0.02 * given
    speed = float(end["angular_velocity"].sel(wheel="motor").mean())
    assert speed == pytest.approx(152.9 - (given / speed - 49.0) / 11.7, rel=1e-6)
    assert speed == pytest.approx(152.9 - 0.42 / 11.7, rel=1e-5)  # as stated on the page
    assert float(history["gap"].max()) < 0
    factor = float(end["normal_force"].max() / end["normal_force"].mean())
    assert 1.1 < factor < 1.25  # recorded: 1.175


def test_a_prescribed_speed_is_infinite_inertia(runs):
    """Effective mass of the mesh: of both wheels, or of the free one."""
    short = "simulation.duration=1e-3"
    free = runs(EXAMPLE, CONSTANT, short).history
    wheels = free.sel(wheel=["pinion", "gear"])
    inverse = (wheels["base_radius"] ** 2 / wheels["inertia"]).values
    held = {
        "motor": ("wheels.motor.loads=[{kind: speed, value: 152.864}]", inverse.sum()),
        "pinion": ("wheels.pinion.loads=[{kind: speed, value: 152.864}]", inverse[1]),
    }
    np.testing.assert_allclose(free["reference_mass"], 1 / inverse.sum(), rtol=1e-12)
    for wheel, (setting, expected) in held.items():
        more = () if wheel == "motor" else ("wheels.motor.loads=[]",)
        run = runs(EXAMPLE, CONSTANT, short, setting, *more)
        np.testing.assert_allclose(run.history["reference_mass"], 1 / expected, rtol=1e-12)
