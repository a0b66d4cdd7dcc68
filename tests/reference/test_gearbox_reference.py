"""The independent program is right: checked against what can be said without any program."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from gearbox_reference import Gearbox, Setup, solve


@pytest.fixture(scope="module", params=[0.0, 0.3], ids=["frictionless", "friction"])
def solution(request: pytest.FixtureRequest) -> dict[str, Any]:
    return solve(friction=request.param, t_end=5.0)


def test_geometry_is_that_of_the_paper() -> None:
    gearbox = Gearbox(Setup())
    # Recorded from another evaluation of section 7.1: alpha_w, |K_A K_B| and |ab|.
    assert math.degrees(gearbox.alpha_0) == pytest.approx(7.52058, abs=5e-6)
    length = gearbox.distance_0 * math.sin(gearbox.alpha_0)
    assert length == pytest.approx(0.065441, abs=5e-7)
    assert gearbox.base_a * gearbox.pitch_a == pytest.approx(0.062291, abs=5e-7)
    # The same base pitch on both wheels.
    pitch_b = 2 * math.pi / 30
    assert gearbox.base_b * pitch_b == pytest.approx(gearbox.base_a * gearbox.pitch_a, rel=1e-15)


@pytest.mark.parametrize("depth", [1e-15, 3e-9, 1e-5, 1e-3])
def test_johnson_force_satisfies_equation_13(depth: float) -> None:
    gearbox = Gearbox(Setup())
    curvature = 0.065
    line_load = gearbox.johnson(depth, curvature) / gearbox.setup.width
    e_star = gearbox.effective_modulus
    logarithm = math.log(4 * math.pi * e_star * curvature / line_load)
    # Rounding of the logarithm near 4e1 and of the force itself.
    assert line_load / (math.pi * e_star) * (logarithm - 1) == pytest.approx(depth, rel=1e-13)


def test_johnson_force_beyond_limit_15_is_refused() -> None:
    with pytest.raises(ValueError, match="limit"):
        Gearbox(Setup()).johnson(0.04, 0.065)


def test_separation_curvature_is_the_difference_of_involute_functions() -> None:
    gearbox = Gearbox(Setup())
    slider = 1e-3  # large enough for the plain difference to keep ten digits
    base = gearbox.base_a + gearbox.base_b
    alpha = math.acos(base / (gearbox.distance_0 + slider))
    plain = base * (math.tan(alpha) - alpha - math.tan(gearbox.alpha_0) + gearbox.alpha_0)
    assert gearbox.separation_curvature(slider) == pytest.approx(plain, rel=1e-9)


def test_energy_is_conserved(solution: dict[str, Any]) -> None:
    gearbox: Gearbox = solution["gearbox"]
    p = gearbox.setup
    kinetic = (
        gearbox.inertia_a * solution["omega_a"] ** 2
        + gearbox.inertia_b * solution["omega_b"] ** 2
        + gearbox.sliding_mass * solution["slider_rate"] ** 2
    ) / 2
    line_load = solution["elastic_force"] / p.width
    e_star, width = gearbox.effective_modulus, p.width
    curvature = gearbox.distance_0 * math.sin(gearbox.alpha_0)
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.log(4 * math.pi * e_star * curvature / line_load) - 1.5
        contact = np.where(
            line_load > 0, width * line_load**2 / (2 * math.pi * e_star) * logarithm, 0
        )
    spring = p.slider_stiffness * solution["slider"] ** 2 / 2
    residual = kinetic + contact + spring + solution["dissipated"] - solution["load_work"]
    # Measured 1e-14 J; the work of the motor is 1 J.
    assert np.abs(residual).max() < 1e-12


def test_ten_times_tighter_tolerance_changes_nothing_that_matters() -> None:
    grid = np.linspace(0.0, 0.2, 201)
    coarse, fine = (solve(0.3, 0.2, grid, rtol=rtol) for rtol in (1e-10, 1e-11))
    for name in ("h", "normal_force", "omega_a", "omega_b"):
        # Measured 2e-9; evolvent is compared at 1e-6.
        assert np.abs(coarse[name] - fine[name]).max() < 1e-8 * np.abs(fine[name]).max()


def test_the_pinion_turns_one_pitch_between_switches(solution: dict[str, Any]) -> None:
    pitch = 2 * math.pi / 20
    angles = [float(state[0]) for _, name, state in solution["events"] if name == "tooth_switch"]
    angle_start = solution["gearbox"].phi_start
    np.testing.assert_allclose(angles, angle_start - pitch * np.array([1, 2]), rtol=0, atol=1e-13)


def test_wheels_that_part_fly_freely() -> None:
    # The pinion is braked: no force pushes it into the gear, so the two stay as they are.
    free = solve(t_end=0.01, t_eval=[0.0, 0.01], torque_a=1.0)
    inertia = free["gearbox"].inertia_a
    assert free["normal_force"][-1] == 0.0
    assert free["h"][-1] < 0.0
    assert free["omega_a"][-1] == pytest.approx(0.01 / inertia, rel=1e-10)
    assert free["omega_b"][-1] == pytest.approx(0.0, abs=1e-15)
