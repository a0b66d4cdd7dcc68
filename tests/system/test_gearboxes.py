"""Gearboxes other than the paper's: other directions, supports, loads, more wheels."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import simpson

from evolvent import check_history
from system.cases import pair, train
from system.runs import TRACKED, TRACKINGS, Run

FORCES_AND_LAGS = ("gap", "transmission_error", "normal_force", "friction_force")
ENERGIES = ("kinetic_energy", "potential_energy", "dissipated_energy", "load_work")


@pytest.fixture(params=TRACKINGS)
def kind(request):
    return request.param


def difference(one: xr.DataArray, other: xr.DataArray, sign: float = 1.0) -> float:
    """Largest difference over the largest value."""
    largest = float(np.abs(one).max())
    return float(np.abs(one.values - sign * other.values).max()) / largest if largest else 0.0


def broken_invariants(run: Run) -> list[str]:
    return [verdict.invariant.name for verdict in check_history(run.history) if verdict.failed]


# ---- directions ----------------------------------------------------------------------------------


def test_the_mirror_image_has_the_mirrored_history(runs, kind):
    case = pair(0.3, kind)
    case["meshes"][0]["driving_rotation"] = "counterclockwise"
    case["wheels"][0]["loads"][0]["value"] = 1.0
    image, original = runs(case), runs(pair(0.3, kind))
    assert float(image.history["flank"][0]) == -1.0
    for name in (*FORCES_AND_LAGS, *ENERGIES):
        assert difference(original.history[name], image.history[name]) <= 1e-12, name
    for name in ("angle", "angular_velocity", "load_torque"):
        assert difference(original.history[name], image.history[name], -1.0) <= 1e-12, name
    for side in ("driving", "driven"):
        point = original.history[f"contact_point_{side}"] * xr.DataArray([1, -1], dims="axis")
        assert difference(point, image.history[f"contact_point_{side}"]) <= 1e-12
    assert image.events["kind"].values.tolist() == original.events["kind"].values.tolist()


@pytest.mark.parametrize("angle", [37.0, 180.0, -90.0])
def test_the_direction_of_the_centre_line_does_not_matter(runs, kind, angle):
    case = pair(0.3, kind)
    case["meshes"][0]["centre_line_angle"] = angle
    case["wheels"][1]["support"]["direction"] = angle
    turned, original = runs(case), runs(pair(0.3, kind))
    # Different rounding leads to different steps; the bound is well below the integration error.
    for name in (*FORCES_AND_LAGS, *ENERGIES, "angular_velocity"):
        assert difference(original.history[name], turned.history[name]) <= 1e-8, name
    assert turned.events["kind"].values.tolist() == original.events["kind"].values.tolist()
    chi = math.radians(angle)
    rotation = np.array([[math.cos(chi), math.sin(chi)], [-math.sin(chi), math.cos(chi)]])
    moved = original.history["centre_displacement"].sel(wheel="gear").values @ rotation
    gear = turned.history["centre_displacement"].sel(wheel="gear").values
    assert np.abs(gear - moved).max() <= 1e-8 * np.abs(moved).max()
    assert broken_invariants(turned) == []


def test_equal_bearings_hold_an_axle_alike_in_every_direction(runs, kind):
    histories = []
    for angle in (0.0, 37.0):
        case = pair(0.3, kind, duration=2)
        stiff = {"kind": "bearing", "mass": 10.0, "stiffness": [1e9, 1e9], "damping": [1e5, 1e5]}
        case["wheels"][1]["support"] = stiff
        case["meshes"][0]["centre_line_angle"] = angle
        run = runs(case)
        assert broken_invariants(run) == []
        histories.append(run.history)
    for name in (*FORCES_AND_LAGS, *ENERGIES, "angular_velocity"):
        assert difference(histories[0][name], histories[1][name]) <= 1e-8, name
    distances = [np.hypot(*h["centre_displacement"][:, 1].values.T) for h in histories]
    assert np.abs(distances[0] - distances[1]).max() <= 1e-8 * distances[0].max()


# ---- the third example ---------------------------------------------------------------------------


def test_no_invariant_is_broken_under_a_heavy_load(runs, kind):
    run = runs("pair-23-41.yaml", f"meshes.0.tracking={kind}")
    assert run.exit_code == 0
    assert run.times("tooth_switch").size > 50
    assert broken_invariants(run) == []


# ---- three wheels --------------------------------------------------------------------------------


def test_a_train_runs_and_no_invariant_is_broken(runs, kind):
    run = runs(train(0.1, kind))
    assert run.exit_code == 0
    assert set(run.events["mesh"].values[run.events["kind"].values == "tooth_switch"]) == {0, 1}
    assert float(np.abs(run.history["friction_force"]).max("time").min()) > 1.0  # [N], in each mesh
    assert broken_invariants(run) == []


@pytest.mark.parametrize("tracked", TRACKED)
def test_a_train_does_the_same_in_every_tracking(runs, tracked):
    run, closed_form = runs(train(0.1, tracked)), runs(train(0.1, "closed_form"))
    for name in ("gap", "angular_velocity"):
        assert difference(closed_form.history[name], run.history[name]) <= 1e-6, name
    assert run.events["kind"].values.tolist() == closed_form.events["kind"].values.tolist()


def test_the_steady_state_of_a_train_is_that_of_statics(runs, kind):
    history = runs(train(0.0, kind, initial={"kind": "steady"})).history
    force = 5.0 / (0.05 * math.cos(math.radians(20)))  # [N]: the idler transmits it
    speeds = np.array([-((47 / 20) ** 2), 47 / 31 * 47 / 20, -47 / 20]) * 5.0 / 2.0
    np.testing.assert_allclose(history["normal_force"], force, rtol=1e-9)
    np.testing.assert_allclose(history["angular_velocity"] - speeds, 0, atol=1e-9 * abs(speeds[0]))
    # Both contacts load the idler: the first along its line of action, the second against its own.
    last = history.isel(time=-1)
    pushed = force * (line_of_action(last, 0) - line_of_action(last, 1))
    spring = np.array([2e8, 3e8]) * last["centre_displacement"].sel(wheel="idler").values
    np.testing.assert_allclose(spring, pushed, rtol=1e-9)


def line_of_action(state: xr.Dataset, mesh: int) -> np.ndarray:
    """Direction of the force on the driven wheel of a mesh, with displaced axes."""
    axles = (state["centre"] + state["centre_displacement"]).transpose("wheel", "axis").values
    driving, driven = (int(state[f"{side}_wheel"][mesh]) for side in ("driving", "driven"))
    line = axles[driven] - axles[driving]
    base = float(state["base_radius"][[driving, driven]].sum())
    alpha = math.acos(base / float(np.hypot(*line)))
    angle = math.atan2(line[1], line[0])
    turned = angle + float(state["flank"][mesh]) * (alpha - math.pi / 2)
    return np.array([math.cos(turned), math.sin(turned)])


# ---- loads ---------------------------------------------------------------------------------------


def test_a_prescribed_speed_is_kept_and_its_torque_reported(runs, kind):
    case = pair(0.3, kind, duration=2)
    knots = {"time": [0, 0.5, 1.0], "speed": [0, -1, -0.8]}
    case["wheels"][0]["loads"] = [{"kind": "speed", **knots}]
    run = runs(case)
    history = run.history
    time = history["time"].values
    expected = np.interp(time, knots["time"], knots["speed"])
    np.testing.assert_allclose(history["angular_velocity"][:, 0], expected, atol=1e-12)
    assert {0.5, 1.0} <= set(run.times("table_knot").tolist())
    assert broken_invariants(run) == []  # the torques and energies, with the reported torque
    # Long after the last knot the gear hardly accelerates: quasi-static.
    last = history.isel(time=-1)
    contact = float(last["normal_force"][0] * last["base_radius"][0])
    contact += float(last["friction_force"][0] * last["friction_arm_driving"][0])
    assert float(last["load_torque"][0]) == pytest.approx(-contact, rel=1e-9)


def test_a_prescribed_speed_needs_the_torque_of_statics(runs, kind):
    case = pair(0.0, kind, duration=1, initial={"kind": "steady"})
    case["wheels"][0]["loads"] = [{"kind": "speed", "value": -1.0}]
    history = runs(case).history
    torque = -10 * (2 / 3) ** 2  # the power of the gear's 10 N m s/rad at 1/1.5 rad/s
    np.testing.assert_allclose(history["load_torque"][:, 0], torque, rtol=1e-9)
    work = float(history["load_work"][-1])
    gear_work = -10 * (2 / 3) ** 2
    assert work == pytest.approx(-torque + gear_work, abs=1e-8)


def test_a_table_of_torques_is_followed_from_knot_to_knot(runs, kind):
    case = pair(0.0, kind, duration=2)
    knots = {"time": [0.1, 0.5, 1.0, 1.2], "torque": [0, -10, -10, -2]}
    case["wheels"][0]["loads"] = [{"kind": "table", **knots}]
    run = runs(case)
    history = run.history
    time = history["time"].values
    expected = np.interp(time, knots["time"], knots["torque"])
    np.testing.assert_allclose(history["load_torque"][:, 0], expected, rtol=0, atol=1e-13)
    np.testing.assert_allclose(run.times("table_knot"), knots["time"], rtol=1e-14)
    power = (history["load_torque"] * history["angular_velocity"]).sum("wheel").values
    # Simpson's rule from knot to knot: the error is due to contact vibrations after each knot.
    pieces = np.searchsorted(time, [0, *knots["time"], 2.0]).tolist()
    work = sum(simpson(power[a : b + 1], x=time[a : b + 1]) for a, b in pairwise(pieces))
    assert float(history["load_work"][-1]) == pytest.approx(work, rel=1e-6)
    assert broken_invariants(run) == []


def test_several_loads_on_a_wheel_add_up(runs, kind):
    case = pair(0.0, kind, duration=1)
    half = {"kind": "torque", "value": -0.5}
    case["wheels"][0]["loads"] = [half, half]
    case["wheels"][1]["loads"] = [{"kind": "viscous", "coefficient": c} for c in (4.0, 6.0)]
    split, whole = runs(case).history, runs(pair(0.0, kind, duration=1)).history
    for name in ("gap", "angular_velocity", "load_torque", "load_work"):
        assert difference(whole[name], split[name]) <= 1e-9, name


# ---- many revolutions ----------------------------------------------------------------------------


def test_many_revolutions_are_counted(runs, kind):
    case = pair(0.1, kind, duration=2, output_interval=1e-2)
    case["wheels"][0]["loads"][0]["value"] = -200.0
    run = runs(case)
    history = run.history
    turns = history["reference_turns"].values
    assert turns[-1] <= -5
    assert float(np.abs(history["reference_angle"]).max()) <= 2 * math.pi
    assert run.times("revolution").size == -turns[-1]
    teeth = history["teeth"].values
    reference = history["reference_angle"].values + 2 * math.pi * turns
    ratios = np.array([1.0, -teeth[0] / teeth[1]])  # the reference wheel is the first
    angle = reference[:, None] * ratios + history["angle_deviation"].values
    np.testing.assert_allclose(history["angle"], angle, rtol=1e-13, atol=1e-13)
    passed = -history["angle"].values[:, 0] * teeth[0] / (2 * math.pi)
    assert history["tooth_pair"].values[:, 0].tolist() == np.floor(passed).tolist()
    assert broken_invariants(run) == []


def test_the_wheels_turn_in_the_ratio_of_their_teeth(runs, kind):
    case = pair(0.1, kind, duration=2, output_interval=1e-2)
    case["wheels"][0]["loads"][0]["value"] = -200.0
    history = runs(case).history
    lag = history["base_radius"].values @ history["angle"].values.T
    # The sum of two arcs of many metres: the remainder is the transmission error, and rounding.
    np.testing.assert_allclose(-lag, history["transmission_error"][:, 0], rtol=0, atol=1e-13)


@pytest.mark.parametrize("knot", [1.4, 0.3 - 1e-16, 0.7 + 1e-16])
def test_a_knot_within_rounding_of_an_output_is_at_the_same_time(runs, knot):
    """1400 intervals of 1 ms are not exactly 1.4 s; IDA rejects a step that short."""
    case = pair(0.0, duration=1.5)
    table = {"time": [0.0, knot, knot + 0.01], "torque": [-1.0, -1.0, -1.0]}
    case["wheels"][0]["loads"] = [{"kind": "table", **table}]
    run = runs(case)
    assert run.exit_code == 0, run.messages
    assert run.history.sizes["time"] == 1501
    np.testing.assert_allclose(run.times("table_knot"), [knot, knot + 0.01], rtol=1e-14)
