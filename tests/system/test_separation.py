"""Contacts that close, open, stay open or are overloaded."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import lambertw

from system.cases import pair, unloaded_pair
from system.runs import TRACKED, TRACKINGS, Run

APPROACH = 1e-4  # relative speed along the line of action [m/s]
BASE_A, BASE_B = (radius * math.cos(1.05 * math.atan(2 * math.pi / 50)) for radius in (0.2, 0.3))
EFFECTIVE_MODULUS = 2e11 / (2 * (1 - 0.3**2))  # [Pa]


@pytest.fixture(params=TRACKINGS)
def kind(request):
    return request.param


# ---- two unloaded wheels -------------------------------------------------------------------------


def collide(runs, kind: str, gap: float) -> Run:
    """The pinion approaches the gear at rest, without dissipation."""
    speeds = {"pinion": -APPROACH / BASE_A, "gear": 0.0}
    case = unloaded_pair(
        kind,
        duration=0.05,
        output_interval=1e-5,
        tolerance=1e-11,  # at the default of 1e-9 energy is conserved to 4e-8 only
        initial={"kind": "speeds", "speeds": speeds, "gaps": {"pinion-gear": gap}},
    )
    return runs(case)


def reduced_mass(run: Run) -> float:
    """Effective mass [kg] along the line of action for the relative speed."""
    inertia = run.history["inertia"].values
    return 1 / float(BASE_A**2 / inertia[0] + BASE_B**2 / inertia[1])


@pytest.mark.parametrize("gap", [0.0, 1e-6])
def test_an_elastic_contact_keeps_energy(runs, kind, gap):
    run = collide(runs, kind, gap)
    approach_energy = reduced_mass(run) * APPROACH**2 / 2
    history = run.history
    energy = history["kinetic_energy"] + history["potential_energy"]
    assert float(history["potential_energy"].max()) > 0.99 * approach_energy
    assert float(np.abs(energy - energy[0]).max()) <= 1e-8 * approach_energy


@pytest.mark.parametrize("gap", [0.0, 1e-6])
def test_an_elastic_contact_reverses_the_relative_speed(runs, kind, gap):
    speed = collide(runs, kind, gap).history["angular_velocity"].values
    approach = -(BASE_A * speed[:, 0] + BASE_B * speed[:, 1])
    assert approach[0] == pytest.approx(APPROACH, rel=1e-14)
    assert approach[-1] == pytest.approx(-APPROACH, rel=1e-8)


def duration_of_contact(mass: float) -> float:
    """Time [s] from contact to separation of an elastic contact: twice the integral of dh/h'."""
    rho = 0.5 * math.sin(1.05 * math.atan(2 * math.pi / 50))  # h adds 1e-7 of it
    scale = math.pi * EFFECTIVE_MODULUS

    def potential(h: float) -> float:
        line = -scale * h / lambertw(-math.e * h / (4 * rho), -1).real
        return 0.1 * line**2 / (2 * scale) * (math.log(4 * scale * rho / line) - 1.5)

    energy = mass * APPROACH**2 / 2
    low, high = 1e-9, 1e-7
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if potential(middle) < energy else (low, middle)

    def integrand(u: float) -> float:  # h = low (1 - u^2) removes the singularity
        h = low * (1 - u * u)
        return 2 * low * u / math.sqrt(2 * (energy - potential(h)) / mass)

    return 2 * quad(integrand, 1e-6, 1 - 1e-12, epsrel=1e-10)[0]


def test_an_elastic_contact_lasts_as_long_as_its_potential_says(runs, kind):
    run = collide(runs, kind, 1e-6)
    (closed,), (opened,) = run.times("contact_closed"), run.times("contact_opened")
    assert closed == pytest.approx(1e-6 / APPROACH, rel=1e-9)  # the gap at constant speed
    # The quadrature omits 1e-6 of its range.
    assert opened - closed == pytest.approx(duration_of_contact(reduced_mass(run)), rel=1e-5)


# ---- flanks apart --------------------------------------------------------------------------------


def test_flanks_that_never_touch_leave_the_pinion_free(runs, kind):
    case = pair(0.0, kind)
    case["wheels"][0]["loads"][0]["value"] = 1.0
    run = runs(case)
    assert run.exit_code == 0
    assert "the flanks of mesh 'pinion-gear' never touched" in run.messages
    assert "never touched" in run.history.attrs["status_message"]
    history, inertia = run.history, float(run.history["inertia"][0])
    time = history["time"].values
    speed, angle = (history[name].values for name in ("angular_velocity", "angle"))
    np.testing.assert_allclose(speed[:, 0], time / inertia, rtol=1e-12)
    np.testing.assert_allclose(angle[:, 0], time**2 / inertia / 2, rtol=1e-8, atol=1e-12)
    assert np.abs(speed[:, 1]).max() <= 1e-13 * speed[-1, 0]
    assert float(history["gap"][-1, 0]) == pytest.approx(BASE_A * angle[-1, 0], rel=1e-8)
    back = run.times("tooth_switch_back")
    expected = np.sqrt(2 * inertia * math.pi / 10 * np.arange(1, back.size + 1))
    assert back.size > 10
    np.testing.assert_allclose(back, expected, rtol=1e-8)


@pytest.mark.parametrize("tracked", TRACKED)
def test_tracking_ends_with_an_event_when_the_flanks_are_far_apart(runs, tracked):
    case = pair(0.0, tracked)
    case["wheels"][0]["loads"][0]["value"] = 1.0
    run = runs(case)
    (apart,) = run.times("flanks_apart")
    later = run.history.sel(time=slice(apart, None))
    assert later.sizes["time"] > 1000
    assert np.all(later["contact_mode"] == 3)
    assert np.all(np.isnan(later["gradient_ratio"]))


def test_a_run_that_loses_contact_says_when(runs, kind):
    case = pair(0.0, kind)
    case["wheels"][0]["loads"] = [{"kind": "table", "time": [0, 1, 1.1], "torque": [-1, -1, 1]}]
    run = runs(case)
    assert run.exit_code == 0
    said = re.search(
        r"mesh 'pinion-gear' lost contact at t = (\S+) s and did not regain it", run.messages
    )
    assert said
    (opened,) = run.times("contact_opened")
    assert float(said[1]) == pytest.approx(opened, rel=1e-8)  # printed with nine digits
    after = run.history.sel(time=slice(opened, None))
    assert np.all(after["in_contact"] == 0)
    assert np.all(after["normal_force"] == 0)


def test_flanks_that_rattle_are_not_lost(runs):
    run = runs("rattle.yaml", "simulation.duration=0.239")
    assert not run.history["in_contact"].values[-1].any()  # the run ends without contact
    assert len(run.times("contact_closed")) > 10
    assert "warning" not in run.messages


@pytest.mark.parametrize("support", ["fixed", "slider"])
def test_energy_balances_while_wheels_bounce(runs, kind, support):
    case = pair(0.0, kind, duration=2.5, output_interval=1e-4)
    if support == "fixed":
        case["wheels"][1]["support"] = {"kind": "fixed"}
    table = {"time": [0, 1, 1.01, 1.2, 1.21], "torque": [-1, -1, 1, 1, -1]}
    case["wheels"][0]["loads"] = [{"kind": "table", **table}]
    run = runs(case)
    changes = [name for name in run.events["kind"].values if name.startswith("contact_")]
    assert changes == ["contact_opened", "contact_closed"] * (len(changes) // 2) + changes[-1:]
    assert len(changes) >= 6
    history = run.history
    power = history["load_torque"] * history["angular_velocity"]
    gross = float(power.clip(min=0).sum("wheel").integrate("time"))
    stored = history["kinetic_energy"] + history["potential_energy"]
    balance = stored + history["dissipated_energy"] - history["load_work"]
    assert float(np.abs(balance - balance[0]).max()) <= 1e-8 * gross


# ---- a load beyond the model ---------------------------------------------------------------------


def test_an_overload_ends_the_run_at_the_limit_of_the_johnson_force(runs, kind):
    case = pair(0.0, kind, duration=0.1, output_interval=1e-6)
    case["wheels"][0]["loads"] = [{"kind": "table", "time": [0, 1e-3], "torque": [0, -3e10]}]
    run = runs(case)
    assert run.exit_code == 4
    said = re.search(
        r": t = (\S+) s: mesh 'pinion-gear': penetration h = (\S+) m exceeds the limit .* = (\S+) m"
        " of the Johnson",
        run.messages,
    )
    assert said
    time, value, limit = (float(number) for number in said.groups())
    last = run.history.isel(time=-1)
    assert run.history.sizes["time"] > 50
    assert run.history.attrs["status"] == "failed"
    assert float(last["time"]) <= time * (1 + 1e-8)
    assert time - float(last["time"]) <= 2e-6
    assert np.all(np.isfinite(run.history["penetration"]))
    assert np.all(np.diff(run.history["penetration"][:, 0]) > 0)
    distance = 0.5 + float(last["centre_displacement"].sel(wheel="gear", axis="x"))
    rho = math.sqrt(distance**2 - (BASE_A + BASE_B) ** 2) + float(last["penetration"][0])
    assert limit == pytest.approx(4 * rho / math.e**2, rel=1e-4)  # the last step before the limit
    assert value == pytest.approx(limit, rel=1e-4)
