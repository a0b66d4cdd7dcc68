"""Figures show the right data with units, and hide nothing. How they look was looked at."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from real_gears import RealPair, no_events
from signal_results import signal_result
from static_curves import static_curves

from evolvent import HistoryError, open_events
from evolvent.figures.over_time import MAX_POINTS, PEAK
from evolvent.figures.style import MAX_MARKS, save
from evolvent.figures.table import (
    FIGURES,
    Drawing,
    Run,
    normal_force,
    penetration,
    speeds,
    transmission_error,
)
from evolvent.history import HISTORY, STATIC


@pytest.fixture
def events(friction_run) -> xr.Dataset:
    return open_events(friction_run.path)


def _lines(figure: Figure, panel: int = 0) -> dict[str, np.ndarray]:
    return {
        line.get_label(): line.get_ydata()
        for line in figure.axes[panel].lines
        if not line.get_label().startswith("_")
    }


def _texts(figure: Figure) -> list[str]:
    return [text.get_text() for legend in figure.legends for text in legend.get_texts()]


def _data(row: Drawing) -> xr.Dataset:
    """Something with the variables of a figure; the values do not matter here."""
    if row.of == STATIC:
        return static_curves()
    if row.of != HISTORY:
        return signal_result(row.of)
    history = RealPair().history(np.linspace(0.0, 1.0, 31))
    for name in set(row.needs) - set(history):  # of a mesh
        history[name] = history["normal_force"]
    return history


@pytest.mark.parametrize("row", FIGURES.values(), ids=list(FIGURES))
def test_every_figure_of_the_table_draws_what_has_its_variables_and_names_one_that_is_missing(row):
    run = Run(_data(row), no_events(), "gears")
    figure = row(run)
    figure.draw_without_rendering()
    drawn = [line for line in figure.axes[0].lines if len(line.get_ydata())]
    assert drawn or figure.axes[0].collections
    assert row.text
    for name in row.needs:
        with pytest.raises(HistoryError, match=f"has no variable `{name}`"):
            row(Run(run.history.drop_vars(name)))


def test_penetration_figure_shows_both_lengths_in_nanometres(friction_run):
    history = friction_run.history
    figure = penetration(Run(history))
    assert figure.axes[0].get_ylabel() == "length [nm]"
    assert figure.axes[0].get_xlabel() == "time [s]"
    lines = _lines(figure)
    for label, name in (
        (r"transmission error $\Delta$", "transmission_error"),
        ("penetration $h$", "penetration"),
    ):
        np.testing.assert_allclose(lines[label], history[name][:, 0] * 1e9, rtol=1e-12)


def test_a_part_of_a_run_marks_the_extremes_in_it_only(friction_run):
    history = friction_run.history
    time, depth = history["time"].values, history["penetration"].values
    reported = history.assign(
        penetration_max=("mesh", depth.max(axis=0) * 3), penetration_max_time=("mesh", [time[2]])
    )
    marked = penetration(Run(reported))
    assert _texts(marked)[-1] == PEAK
    part = penetration(Run(reported.isel(time=slice(10, None))))
    part.draw_without_rendering()  # one far outside of the panel left no room for it
    assert PEAK not in _texts(part)
    assert part.axes[0].get_ylim()[1] < marked.axes[0].get_ylim()[1] / 2


def test_transmission_errors_of_several_runs_come_with_their_labels(friction_run, smooth_run):
    runs = [friction_run.history, smooth_run.history]
    figure = transmission_error(Run(runs[0], label="f = 0.3"), Run(runs[1], label="f = 0"))
    assert figure.axes[0].get_ylabel() == r"transmission error $\Delta$ [nm]"
    assert _texts(figure) == ["f = 0.3", "f = 0"]
    for line, history in zip(_lines(figure).values(), runs, strict=True):
        np.testing.assert_allclose(line, history["transmission_error"][:, 0] * 1e9, rtol=1e-12)


def test_normal_force_and_speeds_have_their_units(friction_run):
    force = normal_force(Run(friction_run.history))
    turning = speeds(Run(friction_run.history))
    assert force.axes[0].get_ylabel() == "normal force $F_n$ [N]"
    assert turning.axes[0].get_ylabel() == r"speed $\omega$ [rpm]"
    assert _texts(turning) == ["pinion", "gear"]


def test_curves_differ_by_dashes_and_lightness(friction_run):
    both = friction_run.history["angular_velocity"]
    many = xr.concat([both, 2 * both], dim="wheel")
    history = xr.Dataset({"angular_velocity": many.assign_coords(wheel=list("abcd"))})
    lines = speeds(Run(history)).axes[0].lines
    assert len({str(line._unscaled_dash_pattern) for line in lines}) == 4
    red_green_blue = np.array(
        [[int(line.get_color()[i : i + 2], 16) for i in (1, 3, 5)] for line in lines]
    )
    grey = np.sort(red_green_blue @ [0.299, 0.587, 0.114])
    assert np.diff(grey[[0, 1]]) > 40  # the first two, of 255, are the ones most often together


def test_every_mesh_has_a_panel(friction_run):
    history = friction_run.history
    names = [n for n, v in history.data_vars.items() if "mesh" in v.dims]
    both = xr.concat([history[names]] * 2, dim="mesh").assign_coords(mesh=["first", "second"])
    figure = penetration(Run(both))
    assert [axis.get_title(loc="left") for axis in figure.axes] == ["mesh first", "mesh second"]


def test_events_are_marked_where_they_happened(friction_run, events):
    figure = normal_force(Run(friction_run.history, events))
    marks = {line.get_label(): line.get_xdata() for line in figure.axes[0].lines}
    for label, kind in (("tooth switch", "tooth_switch"), ("sliding ended", "sliding_ended")):
        expected = events["time"].values[events["kind"].values == kind]
        np.testing.assert_array_equal(marks[label], expected)
    assert {"tooth switch", "sliding began", "sliding ended"} <= set(_texts(figure))


def test_events_outside_the_shown_time_leave_the_axis_alone(friction_run, events):
    history = friction_run.history.isel(time=slice(500, 1001))
    axis = normal_force(Run(history, events)).axes[0]
    assert axis.get_xlim() == (0.5, 1.0)
    assert [line.get_label() for line in axis.lines] == ["pinion-gear"]


def test_events_of_another_mesh_are_not_marked(friction_run, events):
    elsewhere = events.assign(mesh=events["mesh"] + 1)
    figure = penetration(Run(friction_run.history, elsewhere))
    assert len(figure.axes[0].lines) == 2


def test_events_too_many_to_mark_are_counted_instead(friction_run):
    n = MAX_MARKS + 1
    events = xr.Dataset(
        {
            "time": ("event", np.linspace(0.1, 2.9, n)),
            "kind": ("event", np.array(["tooth_switch"] * n, dtype=object)),
            "mesh": ("event", np.zeros(n, dtype=int)),
        }
    )
    figure = normal_force(Run(friction_run.history, events))
    assert _texts(figure) == ["pinion-gear", "too many to mark: 41 of tooth switch"]
    drawn = [line for line in figure.axes[0].lines if len(line.get_xdata())]
    assert [line.get_label() for line in drawn] == ["pinion-gear"]


def test_events_too_many_to_mark_are_counted_over_all_meshes(friction_run):
    n = MAX_MARKS + 1
    events = xr.Dataset(
        {
            "time": ("event", np.tile(np.linspace(0.1, 2.9, n), 2)),
            "kind": ("event", np.array(["sliding_began"] * 2 * n, dtype=object)),
            "mesh": ("event", np.repeat([0, 1], n)),
        }
    )
    history = friction_run.history
    names = [n for n, v in history.data_vars.items() if "mesh" in v.dims]
    both = xr.concat([history[names]] * 2, dim="mesh").assign_coords(mesh=["first", "second"])
    assert _texts(normal_force(Run(both, events))) == ["too many to mark: 82 of sliding began"]


def test_a_long_run_is_thinned_without_losing_its_peaks():
    n = 100_000
    values = np.sin(np.linspace(0.0, 3000.0, n))
    values[54_321] = 7.0
    values[77] = -9.0
    force = xr.DataArray(values[:, None], dims=("time", "mesh"), attrs={"units": "N"})
    history = xr.Dataset(
        {"normal_force": force}, coords={"time": np.linspace(0.0, 500.0, n), "mesh": ["m"]}
    )
    line = normal_force(Run(history)).axes[0].lines[0]
    assert len(line.get_ydata()) <= MAX_POINTS + 2
    assert line.get_ydata().max() == 7.0
    assert line.get_ydata().min() == -9.0
    assert line.get_xdata()[[0, -1]].tolist() == [0.0, 500.0]


def test_a_history_of_one_output_can_be_drawn(smooth_run, tmp_path):
    save(speeds(Run(smooth_run.history.isel(time=[0]))), tmp_path / "one.png")
    assert (tmp_path / "one.png").stat().st_size > 0


@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_the_same_data_give_the_same_file(smooth_run, tmp_path, ending):
    for name in ("one", "two"):
        save(penetration(Run(smooth_run.history)), tmp_path / f"{name}.{ending}")
    assert (tmp_path / f"one.{ending}").read_bytes() == (tmp_path / f"two.{ending}").read_bytes()


def test_nothing_is_clipped_by_the_edge(friction_run, events):
    figure = penetration(Run(friction_run.history, events))
    figure.draw_without_rendering()
    needed = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    assert needed.x0 >= 0
    assert needed.y0 >= 0
    assert needed.x1 <= width
    assert needed.y1 <= height
