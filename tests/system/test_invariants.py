"""Invariants of a run at all times, evaluated independently from the written history."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import xarray as xr

from system.runs import FRICTION, FRICTIONLESS, TRACKED, TRACKINGS, Run, tracking

CASES = (FRICTIONLESS, FRICTION)


def largest_penetration(history: xr.Dataset) -> float:
    return float(history["penetration"].max())


def separation(history: xr.Dataset) -> Any:
    """R (inv alpha - inv alpha_0) [m] for an axis that moves along the centre line.

    Its derivative to the centre distance is sin(alpha): by the midpoint rule, whose error is below
    1e-20 for displacements of nanometres.
    """
    base = float(history["base_radius"].sum())
    start = float(np.diff(history["centre"].sel(axis="x"))[0])
    moved = history["centre_displacement"].sel(wheel="gear", axis="x").values
    return moved * np.sqrt(1 - (base / (start + moved / 2)) ** 2)


def transmission_error(history: xr.Dataset) -> Any:
    """Lag [m] by (19), from the deviations of the angles; constant centre line direction."""
    lag = (history["base_radius"] * history["angle_deviation"]).sum("wheel").values
    return -float(history["flank"][0]) * lag


def check_tracking(history: xr.Dataset) -> None:
    """Check the invariants of tracked points."""
    base = history["base_radius"].values
    ratio = history["gradient_ratio"].values * base[0] / base[1]
    assert np.abs(ratio + 1).max() <= 1e-12
    bound = 1e-10 * largest_penetration(history)
    penetration = -history["gap"][:, 0].values
    lag = transmission_error(history)
    assert np.abs(lag - history["transmission_error"][:, 0]).max() <= bound
    assert np.abs(lag - penetration - separation(history)).max() <= bound
    for quantity in ("tracking_residual", "line_distance"):
        for side in ("driving", "driven"):
            assert np.abs(history[f"{quantity}_{side}"]).max() <= bound, f"{quantity}_{side}"


@pytest.mark.parametrize("kind", TRACKED)
@pytest.mark.parametrize("case", CASES)
def test_points_stay_on_flanks_and_on_the_line_of_action(runs, case, kind):
    check_tracking(runs(case, tracking(kind)).history)


# One test per run: 500 s take a third of a minute. The bounds are the same for each duration.
@pytest.mark.parametrize("duration", [100.0, pytest.param(500.0, marks=pytest.mark.long)])
@pytest.mark.parametrize("kind", TRACKED)
def test_nothing_drifts_over_a_hundred_seconds_and_more(runs, kind, duration):
    settings = (f"simulation.duration={duration}", "simulation.output_interval=0.05")
    history = runs(FRICTION, tracking(kind), *settings).history
    assert float(history["time"][-1]) == duration
    check_tracking(history)
    check_energy(history, 10.0)


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize("case", CASES)
def test_contact_points_lie_on_the_common_tangent_of_the_base_circles(runs, case, kind):
    # Positions in the housing have the rounding of the housing: a few units in the last place.
    rounding = 16 * np.finfo(float).eps * 0.5
    history = runs(case, tracking(kind)).history
    base = history["base_radius"].values
    centre = (history["centre"] + history["centre_displacement"]).transpose("wheel", "time", "axis")
    axle_a, axle_b = centre.values
    distance = np.linalg.norm(axle_b - axle_a, axis=1)
    alpha = np.arccos(base.sum() / distance)
    sigma = float(history["flank"][0])
    across = np.column_stack((np.cos(alpha), sigma * np.sin(alpha)))
    along = np.column_stack((np.sin(alpha), -sigma * np.cos(alpha)))
    point_a = history["contact_point_driving"][:, 0].values
    point_b = history["contact_point_driven"][:, 0].values
    from_a = point_a - axle_a - base[0] * across
    from_b = point_b - axle_b + base[1] * across
    assert np.abs((from_a * across).sum(1)).max() <= rounding
    assert np.abs((from_b * across).sum(1)).max() <= rounding
    # The radius of curvature of an involute grows by r_b per radian of rotation; the angle of the
    # whole run and arccos near 1 have their own errors.
    turned = -sigma * history["angle"].sel(wheel="pinion").values
    pitches = history["tooth_pair"][:, 0].values
    rho = float(history["rho_start_driving"][0]) - pitches * float(history["base_pitch"][0])
    rho = rho + base[0] * (turned + alpha - alpha[0])
    assert np.abs((from_a * along).sum(1) - rho).max() <= 10 * rounding
    between = ((point_b - point_a) * along).sum(1)
    assert np.abs(between - history["gap"][:, 0].values).max() <= rounding


def contact_torque(history: xr.Dataset, wheel: int) -> Any:
    """Torque of the contact on a wheel [N m]: normal force and friction with its arm."""
    arm = history[f"friction_arm_{('driving', 'driven')[wheel]}"][:, 0].values
    normal, friction = (history[f"{kind}_force"][:, 0].values for kind in ("normal", "friction"))
    radius = float(history["base_radius"][wheel])
    return float(history["flank"][0]) * (normal * radius + friction * arm)


@pytest.mark.parametrize("wheel", [0, 1], ids=["pinion", "gear"])
@pytest.mark.parametrize("kind", TRACKINGS)
def test_torques_balance_at_every_output(runs, kind, wheel):
    history = runs(FRICTION, tracking(kind)).history
    contact = contact_torque(history, wheel)
    inertia = float(history["inertia"][wheel])
    acceleration = history["angular_acceleration"][:, wheel].values
    left = inertia * acceleration - history["load_torque"][:, wheel].values - contact
    approach = history["sliding_velocity"][:, 0].values > 0
    for part in (approach, ~approach):
        assert part.sum() > 1000
        assert np.abs(left[part]).max() <= 1e-6 * np.abs(contact).max()


def derivative(values: Any, interval: float) -> Any:
    """Central difference of eighth order; the four values at either end are NaN."""
    result = np.full_like(values, np.nan)
    n = len(values)
    weights = (4 / 5, -1 / 5, 4 / 105, -1 / 280)
    result[4:-4] = sum(
        weight * (values[4 + k : n - 4 + k] - values[4 - k : n - 4 - k])
        for k, weight in enumerate(weights, 1)
    )
    return result / interval


def smooth(run: Run, margin: float) -> Any:
    """Mask of the outputs that are farther than a margin [s] from every event, start and end."""
    time = run.history["time"].values
    corners = np.concatenate((run.events["time"].values, time[[0, -1]]))
    return np.abs(time[:, None] - corners).min(axis=1) > margin


@pytest.mark.parametrize("wheel", [0, 1], ids=["pinion", "gear"])
@pytest.mark.parametrize("kind", TRACKINGS)
def test_torques_balance_with_the_acceleration_that_the_speeds_show(runs, kind, wheel):
    interval = 0.01
    run = runs(FRICTION, tracking(kind), f"simulation.output_interval={interval}")
    history = run.history
    contact = contact_torque(history, wheel)
    acceleration = derivative(history["angular_velocity"][:, wheel].values, interval)
    inertia = float(history["inertia"][wheel])
    left = inertia * acceleration - history["load_torque"][:, wheel].values - contact
    calm = smooth(run, 0.15)  # oscillations after an event have decayed; the stencil covers 0.04
    approach = history["sliding_velocity"][:, 0].values > 0
    for part in (calm & approach, calm & ~approach):
        assert part.sum() > 100
        assert np.abs(left[part]).max() <= 1e-6 * np.abs(contact).max()


def check_energy(history: xr.Dataset, least_input: float) -> None:
    """Check that energy is conserved, relative to the work put in."""
    power = history["load_torque"] * history["angular_velocity"]
    gross = float(power.clip(min=0).sum("wheel").integrate("time"))
    assert gross > least_input  # [J]
    stored = history["kinetic_energy"] + history["potential_energy"]
    balance = stored + history["dissipated_energy"] - history["load_work"]
    assert float(np.abs(balance - balance[0]).max()) <= 1e-8 * gross


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize("case", CASES)
def test_energy_balances(runs, case, kind):
    check_energy(runs(case, tracking(kind)).history, 0.5)


@pytest.mark.parametrize("kind", TRACKINGS)
@pytest.mark.parametrize("case", CASES)
def test_the_work_of_the_loads_is_the_integral_of_their_power(runs, case, kind):
    history = runs(case, tracking(kind)).history
    power = (history["load_torque"] * history["angular_velocity"]).sum("wheel")
    work = float(history["load_work"][-1])
    # The error of the trapezoidal rule over a millisecond is 1e-6.
    assert float(power.integrate("time")) == pytest.approx(work, rel=1e-5)
