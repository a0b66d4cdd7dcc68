"""Loads from case to history: every kind in both integrators; harmonic torques by closed forms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from evolvent import check_history
from load_samples import SAMPLES
from system.cases import pair, unloaded_pair
from system.runs import Run
from system.test_integrators import IDA, RADAU, TIGHT, check_both

INTEGRATORS = pytest.mark.parametrize("integrator", [IDA, RADAU], ids=["ida", "radau"])
INERTIA = 1.0


def loaded(name: str) -> dict[str, Any]:
    """Return a pair with an additional load on its driving wheel, without loss of contact."""
    sample = SAMPLES[name]
    case = pair(0.1, duration=0.2, tolerance=1e-11)
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": -9.0}, dict(sample)]
    if sample["kind"] == "speed":
        speed = sample["value"] if "value" in sample else sample["speed"][0]
        speeds = {"pinion": speed, "gear": -speed / 1.5}
        case["simulation"]["initial"] = {"kind": "speeds", "speeds": speeds}
    return case


@pytest.mark.parametrize("name", SAMPLES)
def test_both_integrators_do_the_same_with_every_load_and_keep_the_energy(runs, name):
    case = loaded(name)
    ida, radau = runs(case, IDA), runs(case, RADAU)
    check_both(ida, radau, runs(case, RADAU, TIGHT))
    assert "energy balance" in {verdict.invariant.name for verdict in check_history(radau.history)}


def harmonic(**fields: float) -> dict[str, Any]:
    return {"kind": "harmonic", **fields}


def apart(*loads: dict[str, Any], **simulation: Any) -> dict[str, Any]:
    """Return two wheels without contact, each under a load."""
    case = unloaded_pair("closed_form", **simulation)
    for wheel, load in zip(case["wheels"], loads, strict=True):
        wheel["inertia"] = INERTIA
        wheel["loads"] = [load]
    initial = case["simulation"].setdefault("initial", {"kind": "rest"})
    initial["gaps"] = {"pinion-gear": 1e-4}
    return case


def column(run: Run, name: str, wheel: int) -> Any:
    assert run.exit_code == 0, run.messages
    assert not (run.history["normal_force"].values > 0).any()
    return run.history[name].values[:, wheel]


@INTEGRATORS
@pytest.mark.parametrize("max_step", ["0.02", "1e-4"])
def test_a_free_wheel_under_a_torque_over_time_moves_as_the_integral_of_the_cosine(
    runs, integrator, max_step
):
    """The longest step is the period, after which the torque repeats, or a small fraction of it."""
    omega, amplitude = 2 * np.pi * 50.0, 5.0
    load = harmonic(amplitude=amplitude, frequency=50.0, phase=90.0)
    still = harmonic(amplitude=0.0, order=1.0)
    case = apart(load, still, duration=0.2, output_interval=1e-3, tolerance=1e-11)
    run = runs(case, integrator, f"simulation.max_step={max_step}")
    t = run.history["time"].values
    speed, angle = amplitude / (INERTIA * omega), amplitude / (INERTIA * omega**2)
    # a hundred thousand step tolerances in 0.2 s, of the scale of a speed reached in a second
    np.testing.assert_allclose(
        column(run, "angular_velocity", 0), speed * np.sin(omega * t), rtol=0, atol=1e-6 * speed
    )
    np.testing.assert_allclose(
        column(run, "angle", 0), angle * (1 - np.cos(omega * t)), rtol=0, atol=1e-6 * angle
    )


@INTEGRATORS
def test_the_speed_of_free_wheels_under_a_torque_by_order_follows_from_their_angle(
    runs, integrator
):
    """Energy: J phi'^2/2 + A/n cos(n phi + p) is constant, over many revolutions.

    The torque on the second wheel keeps its speed proportional, so that the flanks stay apart.
    """
    amplitude, order, phase, start, ratio = 40.0, 4.5, 25.0, 12.0, 20 / 30
    loads = [
        harmonic(amplitude=amplitude, order=order, phase=phase),
        harmonic(amplitude=ratio * amplitude, order=order / ratio, phase=-phase),
    ]
    initial = {"kind": "speeds", "speeds": {"pinion": start, "gear": -ratio * start}}
    case = apart(*loads, duration=6, output_interval=0.01, tolerance=1e-11, initial=initial)
    gap = runs(case, integrator, "simulation.duration=0.01").history["angle"].values[0, 1]
    loads[1]["phase"] -= np.degrees(order / ratio * gap)
    run = runs(case, integrator)
    angle, speed = column(run, "angle", 0), column(run, "angular_velocity", 0)
    p = np.radians(phase)
    gained = amplitude / order * (np.cos(p) - np.cos(order * angle + p))
    assert angle[-1] > 2 * np.pi * 10
    assert np.ptp(gained) > 0.2 * start**2 / 2  # it changes the speed significantly
    np.testing.assert_allclose(speed, np.sqrt(start**2 + 2 * gained / INERTIA), rtol=1e-7)
    torque = amplitude * np.sin(order * angle + p)
    np.testing.assert_allclose(column(run, "load_torque", 0), torque, rtol=0, atol=1e-9 * amplitude)


@pytest.mark.parametrize("by", ["frequency", "order"])
def test_a_steady_start_is_that_of_the_mean_torque(runs, by):
    case = pair(0.0, duration=0.01, initial={"kind": "steady", "position": 0.0})
    steady = runs(case)
    case["wheels"][0]["loads"] = [harmonic(mean=-1.0, amplitude=0.5, phase=90.0, **{by: 3.0})]
    run = runs(case)
    first, expected = run.history.isel(time=0), steady.history.isel(time=0)
    for name in ("angular_velocity", "penetration", "normal_force"):
        np.testing.assert_array_equal(first[name].values, expected[name].values)
    assert first["load_torque"].values[0] == -0.5


# ---- the drive ----


def drive(speed: float, torque: float, slope: float) -> dict[str, Any]:
    return {"kind": "drive", "speed": speed, "torque": torque, "slope": slope}


@INTEGRATORS
def test_a_free_wheel_comes_to_the_speed_of_a_drive_without_torque_as_an_exponential(
    runs, integrator
):
    slope, torque = -40.0, 6.0
    loads = [drive(12.0, torque, slope), drive(-8.0, -2 / 3 * torque, slope)]
    run = runs(apart(*loads, duration=0.2, output_interval=1e-3, tolerance=1e-11), integrator)
    t = run.history["time"].values
    for wheel, sense in ((0, 1.0), (1, -2 / 3)):
        end = sense * (12.0 - torque / slope)
        expected = end * (1 - np.exp(slope / INERTIA * t))
        # errors of steps are 1e-11 of the scale of a speed reached in a second
        np.testing.assert_allclose(
            column(run, "angular_velocity", wheel), expected, rtol=0, atol=1e-8 * abs(end)
        )
    gained = run.history["kinetic_energy"].values
    work = run.history["load_work"].values
    np.testing.assert_allclose(work, gained, rtol=0, atol=1e-8 * gained[-1])


@pytest.mark.parametrize("slope", [-0.1, -5.0, -1e4])
@pytest.mark.parametrize("against", ["torque", "viscous"])
def test_a_steady_start_finds_the_speed_at_which_a_drive_balances_the_load(runs, slope, against):
    """The speed stays there: it is a straight line, the force that of the torque."""
    speed, torque, ratio, coefficient, resisting = -7.0, -0.6, 20 / 30, 0.3, -1.5
    case = pair(0.0, duration=0.05, tolerance=1e-11, initial={"kind": "steady"})
    if against == "viscous":
        load = {"kind": "viscous", "coefficient": coefficient}
        expected = (torque - slope * speed) / (coefficient * ratio**2 - slope)
    else:
        load = {"kind": "torque", "value": resisting}
        expected = speed + (ratio * resisting - torque) / slope
    case["wheels"][0]["loads"] = [drive(speed, torque, slope)]
    case["wheels"][1]["loads"] = [load]
    h = runs(case).history
    found = h["angular_velocity"].values
    assert found[0, 0] == pytest.approx(expected, rel=1e-12)
    np.testing.assert_allclose(found, found[0] * np.ones_like(found), rtol=1e-9)
    force = np.abs(h["load_torque"].values[0, 0]) / h["base_radius"].values[0]
    np.testing.assert_allclose(h["normal_force"].values[:, 0], force, rtol=1e-7)


@pytest.mark.parametrize("against", [[{"kind": "torque", "value": -1.5}], []], ids=["load", "none"])
def test_the_nominal_load_of_a_drive_is_that_of_its_operating_point(runs, against):
    """At standstill its torque would be ten thousand times as large."""
    case = pair(0.0, duration=0.01)
    case["wheels"][0]["loads"] = [drive(-7.0, -1.0, -1.5e3)]
    case["wheels"][1]["loads"] = against
    h = runs(case).history
    expected = 1.0 / float(h["base_radius"][0])
    assert float(h["reference_force"][0]) == pytest.approx(expected, rel=1e-6)


# ---- the loss ----

SEAL = {"kind": "loss", "speed": [1.0, 4.0], "torque": [0.5, 3.5]}


def spun_down(t: Any, start: float) -> Any:
    """Speed of a free wheel of inertia 1 under SEAL from a speed above 4 rad/s.

    J omega' = -3.5 down to 4 rad/s, then -(0.5 + omega - 1) down to 1 rad/s, then -omega/2.
    """
    first = (start - 4.0) / 3.5
    second = first + np.log(3.5 / 0.5)
    return np.select(
        [t <= first, t <= second],
        [start - 3.5 * t, 0.5 + 3.5 * np.exp(-(t - first))],
        np.exp(-(t - second) / 2),
    )


@INTEGRATORS
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("tolerance", ["1e-9", "1e-12"])
def test_a_free_wheel_comes_to_rest_under_a_loss_as_in_closed_form(
    runs, integrator, tolerance, sign
):
    """Through both knots; its kinetic energy is dissipated, and no work is done."""
    start, ratio = sign * 6.0, -2 / 3
    # the second wheel has the same speed, by its ratio, so that the flanks stay apart
    second = {**SEAL, "speed": [x * 2 / 3 for x in SEAL["speed"]]}
    second["torque"] = [x * 2 / 3 for x in SEAL["torque"]]
    initial = {"kind": "speeds", "speeds": {"pinion": start, "gear": ratio * start}}
    case = apart(SEAL, second, duration=8, output_interval=0.01, initial=initial)
    run = runs(case, integrator, f"simulation.tolerance={tolerance}")
    speed = column(run, "angular_velocity", 0)
    expected = sign * spun_down(run.history["time"].values, abs(start))
    # the knots are steps of their own size: some hundred tolerances of the scale of a speed
    np.testing.assert_allclose(speed, expected, rtol=0, atol=1e4 * float(tolerance) * abs(start))
    h = run.history
    assert not h["load_work"].values.any() or np.abs(h["load_work"].values).max() < 1e-12
    total = h["kinetic_energy"].values + h["dissipated_energy"].values
    np.testing.assert_allclose(total, total[0], rtol=1e-9)
    assert h["kinetic_energy"].values[-1] < 0.1 * total[0]
    power = np.abs(column(run, "load_torque", 0) * speed)
    np.testing.assert_allclose(column(run, "load_loss", 0), power, rtol=1e-13)


@INTEGRATORS
def test_a_gearbox_with_losses_keeps_the_energy_and_is_its_own_mirror_image(runs, integrator):
    """A motor against two losses from a steady start; balance, rates and the mirror image."""

    def made(sign: int) -> Run:
        case = pair(0.0, duration=0.5, tolerance=1e-11, initial={"kind": "steady"})
        case["meshes"][0]["driving_rotation"] = "clockwise" if sign < 0 else "counterclockwise"
        loss = {"kind": "loss", "speed": [0.5, 2.0, 50.0], "torque": [0.4, 0.9, 3.0]}
        case["wheels"][0]["loads"] = [{"kind": "torque", "value": sign * 3.0}, SEAL]
        case["wheels"][1]["loads"] = [loss]
        case["wheels"][1]["support"] = {"kind": "fixed"}
        return runs(case, integrator)

    one, other = made(-1), made(1)
    for run in (one, other):
        assert run.exit_code == 0, run.messages
        assert [v.invariant.name for v in check_history(run.history) if v.failed] == []
    speeds = one.history["angular_velocity"].values
    torques = [np.interp(abs(speeds[0, 0]), [0, 1, 4], [0, 0.5, 3.5])]
    torques.append(np.interp(abs(speeds[0, 1]), [0, 0.5, 2, 50], [0, 0.4, 0.9, 3.0]))
    assert torques[0] + 2 / 3 * torques[1] == pytest.approx(3.0, rel=1e-6)
    np.testing.assert_allclose(other.history["angular_velocity"].values, -speeds, rtol=1e-9)
    np.testing.assert_allclose(
        other.history["dissipated_energy"].values,
        one.history["dissipated_energy"].values,
        rtol=1e-7,
    )
    lost = one.history["load_loss"].sum("wheel").values
    assert lost[-1] == pytest.approx(3.0 * abs(speeds[-1, 0]), rel=1e-5)
