"""Each invariant holds for a right solution and breaks as soon as its subject is wrong."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from evolvent import HistoryError, check_history
from evolvent.history.recording import Part, recording_of
from evolvent.physics.applicable import depth_scale
from evolvent.physics.contact_invariants import agreement_of_modes
from evolvent.physics.invariants import DEFAULT_TOLERANCE, INVARIANTS, Verdict
from evolvent.physics.wheel_torques import contact_torque, rotor_inertia, shaft_torque

# A change just beyond the bound of an invariant, and one far enough below it.
BEYOND, WITHIN = 1.1, 0.5


def whole(history: xr.Dataset) -> Part:
    """All rows of a history."""
    return Part(recording_of(history), 0, history.sizes["time"])


def _verdict(history: xr.Dataset, name: str):
    return {v.invariant.name: v for v in check_history(history)}[name]


def _bound(name: str) -> float:
    return {i.name: i.bound(DEFAULT_TOLERANCE) for i in INVARIANTS}[name]


def _changed(history: xr.Dataset, name: str, change: float, **where: int) -> xr.Dataset:
    changed = history.copy(deep=True)
    changed[name][where] += change
    return changed


def _is_reported(verdict: Verdict) -> bool:
    """Whether the independent solution has what an invariant is about: no rigid contact, and it
    tells no modes of tooth pairs, no extremes between its outputs and not what its rates are of.
    """
    name = verdict.invariant.name
    return name not in ("contact modes", "extremes", "rates") and not name.startswith("rigid")


def test_every_invariant_holds_for_the_independent_solution(friction_run):
    verdicts = check_history(friction_run.history)
    assert [v.invariant for v in verdicts] == list(INVARIANTS)
    others = [v for v in verdicts if _is_reported(v)]
    assert len(others) == len(INVARIANTS) - 5
    assert [v.verdict for v in others] == ["pass"] * len(others)


def test_torques_worked_out_from_vectors_balance_to_rounding(friction_run):
    # The independent program has its torques from vector products, so this checks the formula.
    assert _verdict(friction_run.history, "torque balance").worst < 1e-14


@pytest.mark.parametrize(
    ("invariant", "variable", "scale"),
    [
        ("gradient ratio", "gradient_ratio", "ratio"),
        ("transmission error", "transmission_error", "depth"),
        ("transmission error", "gap", "depth"),
        ("transmission error", "separation_curvature", "depth"),
        ("transmission error", "flank_deviation", "depth"),
        ("points on flanks", "tracking_residual_driving", "depth"),
        ("points on flanks", "tracking_residual_driven", "depth"),
        ("points on line of action", "line_distance_driving", "depth"),
        ("points on line of action", "line_distance_driven", "depth"),
    ],
)
@pytest.mark.parametrize("size", [BEYOND, -BEYOND, WITHIN])
def test_a_mesh_invariant_breaks_just_beyond_its_bound(
    friction_run, invariant, variable, scale, size
):
    history = friction_run.history
    unit = 1.5 if scale == "ratio" else float(depth_scale(recording_of(history))[0])
    change = size * _bound(invariant) * unit
    verdict = _verdict(_changed(history, variable, change, time=1234, mesh=0), invariant)
    assert verdict.failed == (abs(size) > 1.0)
    assert verdict.where["time"] == "1.234 s"
    assert verdict.where["mesh"] == "pinion-gear"


@pytest.mark.parametrize("wheel", ["driving", "driven"])
def test_points_off_their_flanks_name_the_wheel_of_the_mesh(friction_run, wheel):
    changed = _changed(friction_run.history, f"tracking_residual_{wheel}", 1e-12, time=5)
    assert _verdict(changed, "points on flanks").where["wheel_of_mesh"] == wheel


@pytest.mark.parametrize(
    "variable", ["kinetic_energy", "potential_energy", "dissipated_energy", "load_work"]
)
@pytest.mark.parametrize("size", [BEYOND, WITHIN])
def test_the_energy_balance_breaks_just_beyond_its_bound(friction_run, variable, size):
    history = friction_run.history
    # The torque of 1 N m does all the work that is put in: 1 J for each radian of the pinion.
    gross = abs(float(history["angle"][-1, 0]))
    change = size * _bound("energy balance") * gross
    verdict = _verdict(_changed(history, variable, change, time=1234), "energy balance")
    assert verdict.failed == (size > 1.0)
    assert verdict.where == {"time": "1.234 s"}


def test_an_unloaded_run_is_measured_by_its_energy_at_the_start(friction_run):
    coasting = friction_run.history.isel(time=slice(2000, 2100)).copy(deep=True)
    coasting["load_torque"][:] = 0.0
    for name in ("potential_energy", "dissipated_energy", "load_work"):
        coasting[name][:] = 0.0
    coasting["kinetic_energy"][:] = 0.25
    assert _verdict(coasting, "energy balance").verdict == "pass"
    coasting["kinetic_energy"][50] += 1.1e-8 * 0.25
    assert _verdict(coasting, "energy balance").worst == pytest.approx(1.1e-8, rel=1e-6)


@pytest.mark.parametrize("variable", ["angular_acceleration", "load_torque"])
@pytest.mark.parametrize("wheel", [0, 1])
@pytest.mark.parametrize("time", [1000, 2000], ids=["approach", "recess"])
@pytest.mark.parametrize("size", [BEYOND, WITHIN])
def test_the_torque_balance_breaks_just_beyond_its_bound(friction_run, variable, wheel, time, size):
    history = friction_run.history
    unit = float(np.abs(contact_torque(whole(history))).max(axis=0)[wheel])
    if variable == "angular_acceleration":
        unit /= float(history["inertia"][wheel])
    change = size * _bound("torque balance") * unit
    changed = _changed(history, variable, change, time=time, wheel=wheel)
    verdict = _verdict(changed, "torque balance")
    assert verdict.failed == (size > 1.0)
    assert verdict.where == {"time": f"{time / 1000:g} s", "wheel": ["pinion", "gear"][wheel]}


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_shaft_that_carries_what_loads_no_longer_do_keeps_the_torque_balance(friction_run, sense):
    """A shaft between both wheels turns its second one; loads against it leave the motion as it is.

    The same shaft with its torque the other way round is missed by twice that.
    """
    history = friction_run.history.copy(deep=True)
    torque = 0.3 * np.cos(history["time"].values)
    history["load_torque"][:, 0] += torque
    history["load_torque"][:, 1] -= torque
    history = history.assign(
        shaft_torque=(("time", "shaft"), sense * torque[:, None]),
        shaft_wheel_first=("shaft", [0]),
        shaft_wheel_second=("shaft", [1]),
        rigid_shaft=("shaft", [0]),
    )
    verdict = _verdict(history, "torque balance")
    if sense > 0:
        # rounding of loads with a torque more, and of the shaft's
        assert verdict.worst < 1e-14
        return
    assert verdict.failed
    unit = float(np.maximum(np.abs(contact_torque(whole(history))).max(axis=0), 0.3).min())
    assert verdict.worst == pytest.approx(2 * 0.3 / unit, rel=1e-12)


def test_friction_left_out_breaks_the_torque_balance(friction_run):
    changed = friction_run.history.copy(deep=True)
    changed["friction_force"][:] = 0.0
    assert _verdict(changed, "torque balance").failed


@pytest.mark.parametrize("step", [0.0, -1e-9])
def test_times_that_do_not_increase_are_found(smooth_run, step):
    times = smooth_run.history["time"].values.copy()
    times[17] = times[16] + step
    verdict = _verdict(smooth_run.history.assign_coords(time=times), "order of times")
    assert verdict.failed
    assert verdict.where == {"time": "0.016 s"}


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_value_that_is_no_number_is_found_and_its_variable_named(smooth_run, value):
    changed = smooth_run.history.copy(deep=True)
    changed["centre_velocity"][7, 1, 0] = value
    verdict = _verdict(changed, "finite values")
    assert verdict.failed
    assert verdict.where == {"variable": "centre_velocity"}


def test_an_invariant_that_is_no_number_is_broken(smooth_run):
    changed = smooth_run.history.copy(deep=True)
    changed["transmission_error"][3] = np.nan
    verdict = _verdict(changed, "transmission error")
    assert verdict.failed
    assert verdict.where["time"] == "0.003 s"


def _in_closed_form(history: xr.Dataset) -> xr.Dataset:
    closed = history.copy(deep=True)
    closed["tracking"][:] = 0
    closed["gradient_ratio"][:] = np.nan
    for name in ("tracking_residual", "line_distance"):
        for side in ("driving", "driven"):
            closed[f"{name}_{side}"][:] = np.nan
    return closed


def test_closed_form_has_no_tracked_points_to_check(smooth_run):
    verdicts = {v.invariant.name: v for v in check_history(_in_closed_form(smooth_run.history))}
    for name in ("gradient ratio", "points on flanks", "points on line of action"):
        assert verdicts[name].verdict == "not applicable"
        assert verdicts[name].reason == "closed form: no contact points are tracked"
    assert verdicts["finite values"].verdict == "pass"
    assert verdicts["transmission error"].verdict == "pass"


def _rigidly(history: xr.Dataset) -> xr.Dataset:
    """Put the flanks where a rigid contact would have them."""
    rigid = history.copy(deep=True)
    rigid["rigid_contact"][:] = 1
    rigid["contact_mode"][:] = 1
    for name in ("gap", "penetration"):
        rigid[name][:] = 0.0
    rigid["transmission_error"] = rigid["separation_curvature"].copy()
    rigid["gap_rate"] = xr.zeros_like(rigid["gap"])
    return rigid


def test_an_elastic_contact_has_no_constraint_to_check(smooth_run):
    for name in ("rigid gap", "rigid gap rate"):
        verdict = _verdict(smooth_run.history, name)
        assert (verdict.verdict, verdict.reason) == ("not applicable", "no contact is rigid")


def test_an_open_rigid_contact_has_none_either(smooth_run):
    opened = _rigidly(smooth_run.history)
    opened["contact_mode"][:] = 0
    opened["gap"][:] = 1e-3
    verdict = _verdict(opened, "rigid gap")
    assert (verdict.verdict, verdict.reason) == (
        "not applicable",
        "no rigid contact is ever closed",
    )


def test_every_invariant_holds_for_a_rigid_contact_that_stays_closed(smooth_run):
    verdicts = check_history(_rigidly(smooth_run.history))
    untold = ("contact modes", "extremes", "rates")
    reported = [v.verdict for v in verdicts if v.invariant.name not in untold]
    assert reported == ["pass"] * (len(INVARIANTS) - 3)


@pytest.mark.parametrize("size", [BEYOND, -BEYOND, WITHIN])
@pytest.mark.parametrize(
    ("invariant", "variable"),
    [
        ("rigid gap", "gap"),
        ("rigid gap rate", "gap_rate"),
        ("transmission error", "transmission_error"),
        ("points on flanks", "tracking_residual_driving"),
    ],
)
def test_a_rigid_contact_is_measured_by_its_reference_penetration(
    smooth_run, invariant, variable, size
):
    rigid = _rigidly(smooth_run.history)
    unit = 3e-9  # reference penetration of the made history [m]
    if variable == "gap_rate":
        radius, inertia = rigid["base_radius"].values, rigid["inertia"].values
        stiffness = float(rigid["reference_force"][0]) / unit
        unit *= float(np.sqrt(stiffness * (radius**2 / inertia).sum()))
    change = size * _bound(invariant) * unit
    verdict = _verdict(_changed(rigid, variable, change, time=123, mesh=0), invariant)
    assert verdict.failed == (abs(size) > 1.0)
    assert verdict.where["time"] == "0.123 s"


def _side_by_side(first: xr.Dataset, second: xr.Dataset) -> xr.Dataset:
    """The meshes of two histories in one, on the same wheels."""
    names = [n for n, v in first.data_vars.items() if "mesh" in v.dims]
    meshes = xr.concat([h[names] for h in (first, second)], dim="mesh")
    return xr.merge([meshes.assign_coords(mesh=["first", "second"]), first.drop_dims("mesh")])


def test_a_mesh_that_never_touches_is_left_out_beside_one_that_does(smooth_run):
    apart = smooth_run.history.copy(deep=True)
    apart["penetration"][:] = 0.0
    both = _side_by_side(apart, smooth_run.history)
    for name in ("transmission error", "points on flanks", "points on line of action"):
        assert _verdict(both, name).verdict == "pass"
    both["line_distance_driven"][5, 1] = 1e-18
    assert _verdict(both, "points on line of action").where["mesh"] == "second"


def test_a_tracked_mesh_beside_a_closed_one_is_still_checked(smooth_run):
    both = _side_by_side(_in_closed_form(smooth_run.history), smooth_run.history)
    assert _verdict(both, "gradient ratio").verdict == "pass"
    assert _verdict(both, "finite values").verdict == "pass"
    both["gradient_ratio"][5, 1] *= 1 + 1e-9
    assert _verdict(both, "gradient ratio").where == {"time": "0.005 s", "mesh": "second"}


TRACKED = ["gradient_ratio"] + [
    f"{name}_{side}"
    for name in ("tracking_residual", "line_distance")
    for side in ("driving", "driven")
]


def test_numbers_over_whole_periods_that_do_not_apply_are_no_missing_values(smooth_run):
    number = ("wheel", [np.nan] * smooth_run.history.sizes["wheel"])
    resting = smooth_run.history.assign(window_centre_acceleration_crest_factor=number)
    assert _verdict(resting, "finite values").verdict == "pass"


def test_points_are_not_checked_while_the_flanks_are_too_far_apart(smooth_run):
    parted = smooth_run.history.copy(deep=True)
    parted["contact_mode"][200:300] = 3
    for name in TRACKED:
        parted[name][200:300] = np.nan
    verdicts = [v for v in check_history(parted) if _is_reported(v)]
    assert [v.verdict for v in verdicts] == ["pass"] * (len(INVARIANTS) - 5)
    parted["gradient_ratio"][300] = np.nan  # where there are tracked points again
    assert _verdict(parted, "gradient ratio").where["time"] == "0.3 s"
    assert _verdict(parted, "finite values").where == {"variable": "gradient_ratio"}


def test_flanks_that_are_always_too_far_apart_have_no_tracked_points(smooth_run):
    parted = smooth_run.history.copy(deep=True)
    parted["contact_mode"][:] = 3
    verdict = _verdict(parted, "points on flanks")
    assert verdict.verdict == "not applicable"
    assert verdict.reason == "the flanks are too far apart to track points on them"


def test_teeth_that_never_touch_have_nothing_to_compare_with(smooth_run):
    apart = smooth_run.history.copy(deep=True)
    for name in ("penetration", "normal_force", "friction_force"):
        apart[name][:] = 0.0
    for name in ("transmission error", "torque balance"):
        assert _verdict(apart, name).verdict == "not applicable"
        assert _verdict(apart, name).reason == "the teeth never touch"


def test_a_history_without_output_has_nothing_to_check(smooth_run):
    verdicts = check_history(smooth_run.history.isel(time=slice(0, 0)))
    assert {v.verdict for v in verdicts} == {"not applicable"}


def test_a_variable_that_is_not_in_the_file_is_named(smooth_run):
    with pytest.raises(HistoryError, match="has no variable `separation_curvature`"):
        check_history(smooth_run.history.drop_vars("separation_curvature"))


def test_contact_torques_of_two_meshes_of_a_wheel_add_up(smooth_run):
    history = smooth_run.history.isel(time=slice(100, 110))
    both = _side_by_side(history, history)
    expected = 2 * contact_torque(whole(history))
    np.testing.assert_allclose(contact_torque(whole(both)), expected, rtol=1e-15)


def test_an_output_beyond_its_extreme_over_the_run_is_found(smooth_run):
    force = smooth_run.history["normal_force"]
    largest = force.max("time").drop_vars("time", errors="ignore")

    def with_largest(value):
        reported = {"normal_force_max": ("mesh", value), "normal_force_max_time": ("mesh", [1.0])}
        return smooth_run.history.assign(reported)

    assert _verdict(smooth_run.history, "extremes").verdict == "not applicable"
    assert _verdict(with_largest(largest.values), "extremes").verdict == "pass"
    assert _verdict(with_largest(largest.values * 2), "extremes").verdict == "pass"
    beyond = _verdict(with_largest(largest.values * (1 - 1e-6)), "extremes")
    assert beyond.verdict == "fail"
    assert beyond.worst == pytest.approx(1e-6, rel=1e-6)
    assert beyond.where["extreme"] == "normal_force_max"


@pytest.mark.parametrize(("below", "verdict"), [(0.0, "pass"), (-1.0, "pass"), (1e-6, "fail")])
def test_an_output_below_its_smallest_value_over_the_run_is_found(friction_run, below, verdict):
    """`below`: how far the smallest output lies under the told one, over the largest size."""
    sliding = friction_run.history["sliding_velocity"]
    assert float(sliding.min()) < 0 < float(sliding.max())
    size = float(np.abs(sliding).max())
    reported = {
        "sliding_velocity_min": ("mesh", [float(sliding.min()) + below * size]),
        "sliding_velocity_min_time": ("mesh", [1.0]),
    }
    found = _verdict(friction_run.history.assign(reported), "extremes")
    assert found.verdict == verdict
    # 1e-9 of 1e-6: rounding of the difference of two values of the same size
    assert found.worst == pytest.approx(max(below, 0.0), rel=1e-9)


def test_a_force_of_hardly_any_load_is_beyond_its_extreme_only_by_more_than_its_digits(smooth_run):
    # of a reference force of 1 a place has digits of 1e-13 or so, of whatever force acts
    history = smooth_run.history
    reference = history["reference_force"].values
    light = history["normal_force"] * 0 + 1e-6 * reference[0]

    def judged(beyond: float) -> str:
        reported = {"normal_force_max": ("mesh", light.max("time").values - beyond * reference)}
        reported |= {"normal_force_max_time": ("mesh", [1.0])}
        return _verdict(history.assign({"normal_force": light, **reported}), "extremes").verdict

    assert judged(0.9e-12) == "pass"
    assert judged(1.1e-12) == "fail"


def test_a_friction_force_that_is_rounding_is_not_beyond_its_extreme(friction_run):
    history = friction_run.history
    normal = float(history["normal_force"].max())

    def off_by(value):
        reported = {
            "friction_force_min": ("mesh", [0.0]),
            "friction_force_min_time": ("mesh", [1.0]),
        }
        rounding = xr.full_like(history["friction_force"], -value)
        return history.assign(friction_force=rounding, **reported)

    assert _verdict(off_by(1e-15 * normal), "extremes").verdict == "pass"
    assert _verdict(off_by(1e-8 * normal), "extremes").verdict == "fail"


OPEN, LOADED, UNLOADED = 0, 1, 2


def _with_pairs(history, modes, depths, forces):
    """The history with two tooth pairs in its mesh that stay as they are."""
    n = history.sizes["time"]
    dims = ("time", "mesh", "pair")
    rows = {
        "pair_contact_mode": modes,
        "pair_penetration": np.array(depths) * float(history["reference_penetration"][0]),
        "pair_normal_force": np.array(forces) * float(history["reference_force"][0]),
    }
    return history.assign({name: (dims, np.tile(row, (n, 1, 1))) for name, row in rows.items()})


def _contradiction(history) -> float:
    """Largest deviation of the modes, over the reference penetration or force."""
    run = recording_of(history)
    return float(np.max(agreement_of_modes(run).values(whole(history))))


@pytest.mark.parametrize(
    ("mode", "depth", "force", "error"),
    [
        (LOADED, 0.5, 0.5, 0.0),
        (LOADED, -0.25, 0.5, 0.25),  # pushes across a gap
        (UNLOADED, 0.5, 0.0, 0.0),
        (UNLOADED, -0.25, 0.0, 0.25),
        (UNLOADED, 0.5, -0.25, 0.25),  # has a force
        (OPEN, -3.0, 0.0, 0.0),
        (OPEN, 0.25, 0.0, 0.25),  # overlaps
        (OPEN, -3.0, 0.25, 0.25),
    ],
)
def test_a_pair_whose_gap_or_force_contradicts_its_mode_is_found(
    smooth_run, mode, depth, force, error
):
    history = _with_pairs(smooth_run.history, [LOADED, mode], [1.0, depth], [1.0, force])
    assert _contradiction(history) == pytest.approx(error, abs=1e-15)


def test_of_coupled_pairs_one_may_overlap_and_be_open(smooth_run):
    history = _with_pairs(smooth_run.history, [LOADED, OPEN], [1.0, 0.25], [1.0, 0.0])
    coupled = history.assign(tooth_coupling=("mesh", np.ones(history.sizes["mesh"], int)))
    assert _contradiction(history) > 0.2
    assert _contradiction(coupled) == 0


def test_a_run_and_check_have_the_same_bounds():
    """What the program says at its end, and what is checked in its history: driver and package."""
    source = Path(__file__).parents[2] / "driver" / "simulate" / "invariant_monitor.c"
    rows = re.findall(r'= \{"([a-z ]+)", ([0-9.e-]+), ([0-9.e-]+)\}', source.read_text())
    of_package = {i.name: (i.least_bound, i.tolerances) for i in INVARIANTS}
    assert len(rows) == 6
    for name, least, tolerances in rows:
        assert of_package[name] == (float(least), float(tolerances)), name


def test_wheels_that_rigid_shafts_join_share_their_inertia_in_whatever_order_they_are_named():
    """0 = 1 = 2 and 3 ~ 4: the second shaft joins a wheel to two that are one already."""
    shafts = {
        "rigid_shaft": ("shaft", [1, 1, 0]),
        "shaft_wheel_first": ("shaft", [1, 0, 3]),
        "shaft_wheel_second": ("shaft", [2, 1, 4]),
    }
    history = xr.Dataset({"inertia": ("wheel", [1.0, 2.0, 4.0, 8.0, 16.0]), **shafts})
    assert rotor_inertia(recording_of(history)).tolist() == [7.0, 7.0, 7.0, 8.0, 16.0]


def test_a_shaft_turns_its_second_wheel_by_what_it_holds_back_its_first() -> None:
    """One torque with two signs; wheel 1 stands on both shafts, and feels their difference."""
    torque = np.array([[3.0, 10.0], [-5.0, 7.0]])
    shafts = {
        "shaft_torque": (("time", "shaft"), torque),
        "shaft_wheel_first": ("shaft", [0, 1]),
        "shaft_wheel_second": ("shaft", [1, 2]),
        "load_torque": (("time", "wheel"), np.zeros((2, 3))),
    }
    felt = shaft_torque(whole(xr.Dataset(shafts, coords={"time": [0.0, 1.0]})))
    expected = np.stack([-torque[:, 0], torque[:, 0] - torque[:, 1], torque[:, 1]], axis=1)
    np.testing.assert_array_equal(felt, expected)
