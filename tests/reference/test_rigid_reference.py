"""The independent program of rigid contact is right: checked without any other program."""

from __future__ import annotations

import math

import numpy as np
import pytest
from gearbox_reference import Setup
from rigid_reference import RigidGearbox, solve_rigid


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_ten_times_tighter_tolerance_changes_nothing_that_matters(friction: float) -> None:
    grid = np.linspace(0.0, 0.5, 51)
    coarse, fine = (solve_rigid(friction, 0.5, grid, rtol=rtol) for rtol in (1e-10, 1e-11))
    for name in ("normal_force", "omega_a", "omega_b", "slider"):
        # evolvent is compared at 1e-6
        assert np.abs(coarse[name] - fine[name]).max() < 1e-8 * np.abs(fine[name]).max()


def test_the_force_at_rest_is_that_of_the_torque_and_the_masses() -> None:
    first = solve_rigid(t_end=1e-3, t_eval=[0.0, 1e-3])
    gearbox = RigidGearbox(Setup())
    a, b = gearbox.base_a, gearbox.base_b
    # Nothing but the pinion is loaded; the slider gives way along the centre line.
    along = math.sin(gearbox.alpha_0)
    mobility = a**2 / gearbox.inertia_a + b**2 / gearbox.inertia_b + along**2 / gearbox.sliding_mass
    assert first["normal_force"][0] == pytest.approx(a / gearbox.inertia_a / mobility, rel=1e-13)


def test_the_steady_force_is_the_torque_over_the_base_radius() -> None:
    last = solve_rigid(t_end=20.0, t_eval=[0.0, 20.0])
    # 9e-7 of the speed is left after 20 s.
    assert last["normal_force"][-1] == pytest.approx(1 / RigidGearbox(Setup()).base_a, rel=1e-5)
    assert last["omega_b"][-1] == pytest.approx(0.15, rel=1e-5)
