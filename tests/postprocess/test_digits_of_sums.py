"""Sums of large numbers are rounded as these are, and an invariant measures them so, no coarser."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from evolvent import check_history
from evolvent.history.recording import recording_of
from evolvent.physics.wheel_torques import largest_mesh_torque

TORQUE = 273.0  # of each mesh of the idler [N m]
BASE_RADIUS = 0.1
INERTIA = 2.0


def verdict(history: xr.Dataset, name: str):
    return {v.invariant.name: v for v in check_history(history)}[name]


def with_an_idler(history: xr.Dataset) -> xr.Dataset:
    """Three wheels in a row that turn evenly: two meshes press the middle one, one each way."""
    few = history.isel(time=slice(100, 110))
    meshes = xr.concat([few, few], dim="mesh", data_vars="minimal")
    per_wheel = [name for name in few.data_vars if "wheel" in few[name].dims]
    wheels = few[per_wheel].isel(wheel=[0, 1, 0]).assign_coords(wheel=["first", "idler", "last"])
    made = meshes.drop_vars([*per_wheel, "wheel"]).merge(wheels)
    flat = {name: made[name] * 0 for name in ("friction_force", "angular_acceleration")}
    force = made["normal_force"] * 0 + TORQUE / BASE_RADIUS
    constants = {
        "driving_wheel": ("mesh", [0, 1]),
        "driven_wheel": ("mesh", [1, 2]),
        "flank": ("mesh", [1, -1]),
        "base_radius": ("wheel", [BASE_RADIUS] * 3),
        "inertia": ("wheel", [INERTIA] * 3),
    }
    made = made.assign(normal_force=force, **flat, **constants)
    load = made["load_torque"] * 0
    load[:, 0], load[:, 2] = -TORQUE, TORQUE
    return made.assign(load_torque=load)


def test_an_idlers_torques_balance_to_the_digits_of_its_meshes(smooth_run):
    history = with_an_idler(smooth_run.history)
    history["normal_force"][5, 1] *= (
        1 + 1e-13
    )  # rounding of either, and all of what is left of both
    assert verdict(history, "torque balance").verdict == "pass"


@pytest.mark.parametrize(("part", "judged"), [(0.9e-6, "pass"), (1.1e-6, "fail")])
def test_an_idlers_torque_is_missed_from_the_bound_on(smooth_run, part, judged):
    history = with_an_idler(smooth_run.history)
    history["angular_acceleration"][5, 1] = part * TORQUE / INERTIA
    assert verdict(history, "torque balance").verdict == judged


@pytest.mark.parametrize(("part", "judged"), [(0.9e-15, "pass"), (1.1e-15, "fail")])
def test_a_rigid_shaft_carries_the_digits_of_an_acceleration_to_all_it_joins(
    smooth_run, part, judged
):
    """A wheel of hardly any torque on the shaft of a heavy one, beside one that speeds up."""
    history = with_an_idler(smooth_run.history)
    heavy, fastest, light = 1e9, 1e3, 1e-12
    shaft = {
        "rigid_shaft": ("shaft", [1]),
        "shaft_wheel_first": ("shaft", [1]),
        "shaft_wheel_second": ("shaft", [2]),
        "shaft_torque": (("time", "shaft"), np.zeros((history.sizes["time"], 1))),
    }
    inertia = ("wheel", [0.0, INERTIA, heavy])
    history = history.assign(normal_force=history["normal_force"] * 0, inertia=inertia, **shaft)
    history["load_torque"][:] = 0.0
    history["angular_acceleration"][:, 0] = fastest
    history["shaft_torque"][3] = light
    history["load_torque"][3, 1] = light + part * (INERTIA + heavy) * fastest
    history["load_torque"][3, 2] = -light
    assert verdict(history, "torque balance").verdict == judged


def test_the_largest_torque_of_a_mesh_is_that_of_one_of_them(smooth_run):
    found = largest_mesh_torque(recording_of(with_an_idler(smooth_run.history)))
    np.testing.assert_allclose(found, [TORQUE] * 3, rtol=1e-15)


@pytest.mark.parametrize(("part", "judged"), [(0.9e-15, "pass"), (1.1e-15, "fail")])
def test_sliding_is_rounded_as_the_fastest_wheels_base_circle_moves(friction_run, part, judged):
    history = friction_run.history
    fastest = float(np.abs(history["angular_velocity"]).max())
    largest = fastest * float(history["base_radius"].max())
    still = history["sliding_velocity"] * 0
    reported = {
        "sliding_velocity_max": ("mesh", [-part * largest]),
        "sliding_velocity_max_time": ("mesh", [1.0]),
    }
    found = verdict(history.assign(sliding_velocity=still, **reported), "extremes")
    assert found.verdict == judged
