"""What tooth pairs did: the figure of their loads, and the numbers of the report."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from real_gears import RealPair

from evolvent.figures.pairs import draw_pairs, last_pitches, roll_angle
from evolvent.physics.mesh_summary import mesh_summaries

PITCH = 2 * np.pi / 20


@pytest.fixture(scope="module")
def history() -> xr.Dataset:
    """Ten pitches, a hundred outputs each."""
    return RealPair(penetration=0.0).history(PITCH * np.arange(1005) / 100)


@pytest.fixture
def events() -> xr.Dataset:
    data = [
        (100.0, "pair_entered", 0, 0),
        (160.0, "pair_left", 0, 0),
        (170.0, "pair_entered", 0, 1),  # of the coast flank
        (180.0, "pair_entered", 1, 0),  # of another mesh
        (190.0, "contact_opened", 0, 0),
    ]
    columns = zip(*data, strict=True)
    names = ("time", "kind", "mesh", "flank")
    types = (float, object, int, int)
    return xr.Dataset(
        {
            name: ("event", np.array(column, dtype=kind))
            for name, column, kind in zip(names, columns, types, strict=True)
        }
    )


def _drawn(figure, panel=0):
    return {line.get_label(): line for line in figure.axes[panel].lines}


def test_every_pair_is_drawn_over_the_roll_angle_while_it_is_on_the_path(history):
    figure = draw_pairs(history.isel(time=slice(0, 311)))
    assert figure.axes[0].get_ylabel() == "normal force [N]"
    assert figure.axes[1].get_xlabel() == "roll angle of pinion [°]"
    lines = _drawn(figure)
    assert set(lines) == {
        "sum of all pairs",
        "tooth pairs 0, 3",
        "tooth pairs -1, 2",
        "tooth pair 1",
    }
    total = history["normal_force"].values[:311, 0]
    np.testing.assert_array_equal(lines["sum of all pairs"].get_ydata(), total)
    angle, force = lines["tooth pair 1"].get_data()
    carried = np.isfinite(force)
    assert set(force[carried]) == {110.0}
    # pair 1 enters a pitch after the start and leaves a contact ratio later; 0.18 deg an output
    assert angle[carried][0] == pytest.approx(18.0, abs=0.2)
    ratio = float(history["contact_ratio"][0])
    assert angle[carried][-1] == pytest.approx(18.0 * (1 + ratio), abs=0.2)


def test_the_second_panel_shows_the_contact_pressure_with_its_unit(history):
    figure = draw_pairs(history.isel(time=slice(0, 311)))
    assert figure.axes[1].get_ylabel() == "contact\npressure [MPa]"
    shown = _drawn(figure, 1)["tooth pair 1"].get_ydata()
    assert np.nanmax(shown) == pytest.approx(np.sqrt(110.0))


def test_two_pairs_of_one_line_are_not_joined(history):
    force = _drawn(draw_pairs(history.isel(time=slice(0, 401))))["tooth pairs 0, 3"].get_ydata()
    starts = np.flatnonzero(np.isfinite(force[1:]) & ~np.isfinite(force[:-1]))
    assert starts.size == 1  # of pair 3


def test_pairs_can_be_drawn_over_time(history):
    figure = draw_pairs(history.isel(time=slice(0, 311)), over_time=True)
    assert figure.axes[1].get_xlabel() == "time [s]"
    assert figure.axes[0].get_xlim() == (0.0, 310.0)


def test_entry_and_exit_are_marked_where_they_happened(history, events):
    figure = draw_pairs(history.isel(time=slice(0, 311)), events)
    lines = _drawn(figure)
    assert lines["a pair enters the path"].get_xdata() == pytest.approx([18.0], abs=1e-9)
    assert lines["a pair leaves it"].get_xdata() == pytest.approx([28.8], abs=1e-9)
    below = [text.get_text() for text in figure.legends[-1].get_texts()]
    assert below == ["a pair enters the path", "a pair leaves it"]


def test_loads_of_the_coast_flank_are_drawn_as_such():
    history = RealPair(coast=True).history(PITCH * np.arange(101) / 50)
    assert "pairs of the coast flanks" in _drawn(draw_pairs(history))


def test_pairs_are_told_apart_without_colour(history):
    lines = _drawn(draw_pairs(history.isel(time=slice(0, 311))))
    pairs = [line for label, line in lines.items() if label.startswith("tooth pair")]
    assert len({str(line._unscaled_dash_pattern) for line in pairs}) == 3


def test_every_mesh_has_two_panels(history):
    names = [n for n, v in history.data_vars.items() if "mesh" in v.dims]
    both = xr.concat([history[names]] * 2, dim="mesh").assign_coords(mesh=["first", "second"])
    figure = draw_pairs(history.drop_vars([*names, "mesh"]).merge(both).isel(time=slice(0, 99)))
    assert len(figure.axes) == 4
    titles = [axis.get_legend().get_title().get_text() for axis in figure.axes[::2]]
    assert titles == ["mesh first", "mesh second"]


def test_the_last_pitches_are_those_of_the_fastest_teeth(history):
    shown = last_pitches(history, 2.0)
    rolled = roll_angle(history, 0).values
    assert float(rolled[-1]) > 0
    assert shown["time"].values[[0, -1]].tolist() == [804.0, 1004.0]


def test_the_contact_ratio_seen_is_that_of_the_geometry(history):
    (found,) = mesh_summaries(history)
    assert found.contact_ratio == pytest.approx(float(history["contact_ratio"][0]))
    # 10 pitches with 100 outputs each: every change of the number of pairs is known to one output
    assert found.mean_pairs == pytest.approx(found.contact_ratio, abs=0.01)
    assert found.apart == 0.0
    numbers = history["pair_number"].values[history["pair_normal_force"].values > 0]
    assert found.pairs == np.unique(numbers).size == 12  # -1 to 10


def test_pairs_of_both_flanks_are_counted_each(history):
    """Teeth that go over to their other flanks touch as other pairs, whatever their numbers."""
    angles = PITCH * np.arange(505) / 100
    back = RealPair(coast=True).history(angles)
    later = back.assign_coords(time=back["time"] + float(history["time"][-1]) + 1.0)
    over_time = [name for name, values in history.data_vars.items() if "time" in values.dims]
    parts = [part[over_time] for part in (history, later)]
    both = history.drop_dims("time").merge(xr.concat(parts, dim="time"))
    numbers = [part["pair_number"].values[part["pair_normal_force"].values > 0] for part in parts]
    counts = [np.unique(of_flank).size for of_flank in numbers]
    assert np.intersect1d(*numbers).size > 1  # some have the same numbers
    (found,) = mesh_summaries(both)
    assert counts[0] > counts[1] > 0
    assert found.pairs == sum(counts)


def test_the_efficiency_is_that_of_the_energies(history):
    (found,) = mesh_summaries(history)
    # 0.01 W per newton lost, 2 rad/s times the base radius per newton handed over
    assert found.efficiency == pytest.approx(1 - 0.01 / (2 * RealPair().base[0]), rel=1e-12)


def test_time_without_contact_is_counted(history):
    apart = history.copy(deep=True)
    apart["pairs_in_contact"][250:501] = 0
    (found,) = mesh_summaries(apart)
    # of 1004 intervals 250, and half of one on either side
    assert found.apart == pytest.approx(251 / 1004)
    assert dict(found.texts())["share of time without contact"] == "0.25"


def test_a_history_without_tooth_pairs_has_no_summary(friction_run, history):
    assert mesh_summaries(friction_run.history) == []
    assert mesh_summaries(history.isel(time=[0])) == []
