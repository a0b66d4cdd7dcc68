"""Differences of two histories: found, scaled and placed."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from evolvent import HistoryError, compare_histories


def _row(result: xr.Dataset, name: str) -> tuple[float, float, str]:
    row = result.sel(variable=name)
    return float(row["absolute"]), float(row["relative"]), str(row["where"].item())


def test_a_history_does_not_differ_from_itself(friction_run):
    result = compare_histories(friction_run.history, friction_run.history)
    assert set(result["variable"].values) == set(friction_run.history.data_vars) - {"tracking"}
    assert float(result["absolute"].max()) == 0.0
    assert result.attrs["n_times"] == 3001


def test_the_largest_difference_is_found_where_it_is(friction_run):
    other = friction_run.history.copy(deep=True)
    other["angular_velocity"][100, 0] += 1e-3
    other["angular_velocity"][1234, 1] -= 2e-3
    largest = float(np.abs(other["angular_velocity"]).max())
    absolute, relative, where = _row(
        compare_histories(friction_run.history, other), "angular_velocity"
    )
    assert absolute == pytest.approx(2e-3, rel=1e-12)
    assert relative == pytest.approx(2e-3 / largest, rel=1e-12)
    assert where == "t = 1.234 s, gear"


def test_static_variables_and_integers_are_compared(friction_run):
    other = friction_run.history.copy(deep=True)
    other["base_radius"][1] *= 1.01
    other["tooth_pair"][2000] += 1
    result = compare_histories(friction_run.history, other)
    assert _row(result, "base_radius")[2] == "gear"
    assert _row(result, "tooth_pair")[0] == 1.0


def test_a_value_missing_in_one_only_is_an_infinite_difference(smooth_run):
    other = smooth_run.history.copy(deep=True)
    other["gradient_ratio"][7] = np.nan
    result = compare_histories(smooth_run.history, other)
    assert _row(result, "gradient_ratio") == (np.inf, np.inf, "t = 0.007 s, pinion-gear")
    assert _row(compare_histories(other, other), "gradient_ratio")[0] == 0.0


def test_tracked_points_are_not_compared_with_none(smooth_run):
    closed = smooth_run.history.copy(deep=True)
    closed["gradient_ratio"][:] = np.nan
    closed["tracking"][:] = 0
    result = compare_histories(smooth_run.history, closed)
    assert result.attrs["only_in_first"] == "gradient_ratio"
    assert compare_histories(closed, smooth_run.history).attrs["only_in_second"] == "gradient_ratio"
    assert float(result["absolute"].max()) == 0.0


def test_a_mesh_in_closed_form_beside_a_tracked_one_is_left_out(smooth_run):
    ratio = xr.concat([smooth_run.history["gradient_ratio"]] * 2, dim="mesh")
    names = {"mesh": ["first", "second"]}
    tracked = smooth_run.history.drop_dims("mesh").assign(gradient_ratio=ratio.assign_coords(names))
    mixed = tracked.copy(deep=True)
    mixed["gradient_ratio"][:, 0] = np.nan
    mixed["gradient_ratio"][3, 1] += 1e-3
    absolute, _, where = _row(compare_histories(tracked, mixed), "gradient_ratio")
    assert absolute == pytest.approx(1e-3, rel=1e-9)
    assert where == "t = 0.003 s, second"


def test_a_difference_from_nothing_but_zeros_is_the_whole_value(smooth_run):
    other = smooth_run.history.copy(deep=True)
    other["friction_force"][7] = 0.5  # all zero in the first
    assert _row(compare_histories(smooth_run.history, other), "friction_force")[:2] == (0.5, 1.0)


def test_grids_with_times_in_common_are_compared_on_these(friction_run):
    coarse = friction_run.history.isel(time=slice(None, None, 4))
    for pair in ((friction_run.history, coarse), (coarse, friction_run.history)):
        result = compare_histories(*pair)
        assert result.attrs["times"] == "the 751 times that both have"
        assert float(result["absolute"].max()) == 0.0


def test_times_that_differ_by_rounding_are_the_same(friction_run):
    history = friction_run.history
    rounded = history.assign_coords(time=history["time"].values * (1 + 4e-16))
    assert compare_histories(history, rounded).attrs["n_times"] == 3001


def test_other_grids_are_interpolated_and_the_result_says_so(friction_run):
    history = friction_run.history.isel(time=slice(100, 201))
    linear = history.copy(deep=True)
    linear["normal_force"][:, 0] = 2.0 + 3.0 * linear["time"].values
    shifted = linear.isel(time=slice(None, -1)).copy(deep=True)
    shifted = shifted.assign_coords(time=shifted["time"].values + 0.0003)
    shifted["normal_force"][:, 0] = 2.0 + 3.0 * shifted["time"].values
    result = compare_histories(linear, shifted)
    assert "interpolated" in result.attrs["times"]
    # A straight line is interpolated to the rounding of its values.
    assert _row(result, "normal_force")[0] < 1e-14
    assert _row(result, "tooth_pair")[0] == 0.0


def test_whole_numbers_between_two_times_are_those_of_the_time_before(friction_run):
    """A pair that comes in at an output has not come in between the output before and that one."""
    first = friction_run.history.isel(time=slice(100, 201)).copy(deep=True)
    times = first["time"].values
    second = first.isel(time=slice(None, -1)).assign_coords(time=times[:-1] + 0.0003)
    second = second.copy(deep=True)
    comes = 50  # output of the second history, 0.3 ms behind that of the first
    first["tooth_pair"][:, 0] = 4 + (times > times[comes])
    second["tooth_pair"][:, 0] = 4 + (np.arange(100) >= comes)
    result = compare_histories(first, second)
    assert "interpolated" in result.attrs["times"]
    assert _row(result, "tooth_pair")[0] == 0.0
    second["tooth_pair"][comes - 1, 0] = 5
    absolute, _, where = _row(compare_histories(first, second), "tooth_pair")
    assert (absolute, where) == (1.0, f"t = {times[comes]:.6g} s, pinion-gear")


def test_runs_of_different_length_are_compared_where_both_are(friction_run):
    short = friction_run.history.isel(time=slice(0, 1001))
    assert compare_histories(friction_run.history, short).attrs["n_times"] == 1001


def test_variables_of_one_history_only_are_listed(smooth_run):
    less = smooth_run.history.drop_vars(["gap", "sliding_velocity"])
    result = compare_histories(smooth_run.history, less)
    assert result.attrs["only_in_first"] == "gap, sliding_velocity"
    assert result.attrs["only_in_second"] == ""
    assert "gap" not in result["variable"].values


def test_unlike_runs_are_refused(smooth_run):
    renamed = smooth_run.history.assign_coords(wheel=["sun", "planet"])
    with pytest.raises(HistoryError, match=r"wheel names are sun, planet, .* are pinion, gear"):
        compare_histories(smooth_run.history, renamed)


def test_runs_without_common_time_are_refused(friction_run):
    early = friction_run.history.isel(time=slice(0, 100))
    late = friction_run.history.isel(time=slice(200, 300))
    with pytest.raises(HistoryError, match="no time in common"):
        compare_histories(early, late)


@pytest.mark.parametrize("swap", [False, True])
def test_a_history_without_output_is_refused(smooth_run, swap):
    pair = [smooth_run.history, smooth_run.history.isel(time=slice(0, 0))]
    with pytest.raises(HistoryError, match="has no output"):
        compare_histories(*(reversed(pair) if swap else pair))


def test_numbers_of_a_whole_run_are_compared(smooth_run):
    """They have no dimension, as those over whole periods have none of a gearbox."""
    one = smooth_run.history.assign(number_periods=((), 8.0))
    two = smooth_run.history.assign(number_periods=((), 9.0))
    assert _row(compare_histories(one, two), "number_periods") == (1.0, 1 / 9, "")
    assert _row(compare_histories(one, one), "number_periods")[0] == 0.0


def _by_pitch(history: xr.Dataset, rows: list[int], kinds: list[int], of: str) -> xr.Dataset:
    """Make a history with outputs by position of some rows, which stand at whole positions."""
    some = history.isel(time=rows)
    position = [row / 10 for row in rows]
    return some.assign(
        output_position=("time", position), output_kind=("time", kinds)
    ).assign_attrs(output_per="pitch", output_number=1, output_of=of)


def test_outputs_by_position_are_compared_where_both_were_at_whatever_times(friction_run):
    history = friction_run.history
    one = _by_pitch(history, [10, 20, 30, 40, 47], [0, 0, 0, 0, 1], "pinion-gear")
    late = one.assign_coords(time=one["time"].values * 1.3)
    same = compare_histories(one, late)
    assert same.attrs["times"] == "the 4 positions that both have"
    assert float(same["absolute"].max()) == 0.0
    # another motion: it turned back, came again, and went less far
    other = _by_pitch(history, [10, 20, 25, 30], [0, 0, 2, 0], "pinion-gear")
    other = other.assign_coords(time=other["time"].values * 1.3)
    result = compare_histories(one, other)
    assert result.attrs["times"] == "the 3 positions that both have"
    assert _row(result, "angular_velocity")[0] == 0.0


def test_outputs_by_positions_of_others_are_compared_over_time(friction_run):
    history = friction_run.history
    one = _by_pitch(history, [10, 20, 30], [0, 0, 0], "pinion-gear")
    for other in (_by_pitch(history, [10, 20, 30], [0, 0, 0], "another"), history):
        result = compare_histories(one, other)
        assert "times" in result.attrs["times"]
        assert float(result.sel(variable="angular_velocity")["absolute"]) < 1e-9
