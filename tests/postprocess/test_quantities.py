"""Any variable in a picture: which panels, which lines, of which names, in which units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from real_gears import RealPair, no_events
from synthetic import write_history
from test_pictures import two_stages

from evolvent import HistoryError
from evolvent.figures.on_path import draw_on_path, passes, path_of
from evolvent.figures.quantities import X, draw_quantities
from evolvent.figures.table import Run, speeds


def titles(figure: Figure) -> list[str]:
    return [axes.get_title(loc="left") for axes in figure.axes if axes.get_visible()]


def legend(figure: Figure) -> list[str]:
    return [text.get_text() for found in figure.legends for text in found.get_texts()]


@pytest.fixture
def history() -> xr.Dataset:
    return two_stages()


def test_wheels_that_turn_alike_are_one_line_with_both_names(history):
    alike = history.copy()
    # on one shaft; then the ratio of the teeth, and the same less a thousandth of the height
    speed = history["angular_velocity"].isel(wheel=0).values
    ramp = np.linspace(0.0, 1.0, speed.size)
    columns = [100 * ramp, 60 * ramp, 60 * ramp + 0.05, 0 * ramp]
    alike["angular_velocity"] = (("time", "wheel"), np.stack(columns, axis=1))
    alike["angular_velocity"].attrs = {"units": "rad s-1"}
    figure = speeds(Run(alike))
    assert legend(figure) == ["motor", "gear-1, pinion-2", "drum"]
    assert len(figure.axes) == 1
    apart = alike.copy()
    apart["angular_velocity"] = alike["angular_velocity"] + [0.0, 0.0, 1.0, 0.0]
    assert legend(speeds(Run(apart))) == ["motor", "gear-1", "pinion-2", "drum"]


def test_speeds_that_are_far_from_each_other_have_a_panel_each(history):
    figure = speeds(Run(history))
    assert titles(figure) == ["motor", "gear-1, pinion-2", "drum"]
    assert all(np.ptp(axes.get_ylim()) < 5.0 for axes in figure.axes)  # rpm: how each moves


def test_meshes_have_a_row_each_with_one_unit(history):
    figure = draw_quantities([Run(history)], ["normal_force"])
    assert titles(figure) == ["mesh first", "mesh second"]
    assert {axes.get_ylabel() for axes in figure.axes} == {"normal force $F_n$ [kN]"}
    for mesh, axes in enumerate(figure.axes):
        drawn = axes.lines[0].get_ydata()
        np.testing.assert_allclose(drawn, history["normal_force"][:, mesh] / 1000, rtol=1e-12)


def test_quantities_of_one_unit_share_panels_and_others_do_not(history):
    names = ["normal_force", "friction_loss", "coast"]
    history["coast"] = 0.1 * history["normal_force"]
    history["coast"].attrs["units"] = "N"
    figure = draw_quantities([Run(history)], names)
    assert [axes.get_ylabel() for axes in figure.axes] == ["force [kN]"] * 2 + [
        "friction loss [W]"
    ] * 2
    assert legend(figure)[:2] == ["normal force $F_n$", "coast"]


def test_a_choice_keeps_what_was_chosen(history):
    figure = draw_quantities([Run(history)], ["normal_force"], {"mesh": ["second"]})
    assert len(figure.axes) == 1
    assert legend(figure) == ["second"]
    figure = draw_quantities(
        [Run(history)], ["centre_displacement"], {"wheel": ["drum", "motor"], "axis": ["y"]}
    )
    assert titles(figure) == ["drum", "motor"]
    assert legend(figure) == ["y"]


def test_runs_with_the_same_names_lie_on_top_of_each_other(history):
    figure = draw_quantities([Run(history, label="a"), Run(history, label="b")], ["normal_force"])
    assert titles(figure) == ["mesh first", "mesh second"]
    assert legend(figure) == ["a", "b"]
    assert [len(axes.lines) for axes in figure.axes] == [2, 2]


def test_runs_with_other_names_lie_beside_each_other(history):
    other = RealPair().history(np.linspace(0.0, 1.0, 31))
    figure = draw_quantities([Run(history, label="a"), Run(other, label="b")], ["normal_force"])
    assert titles(figure) == ["a\nmesh first", "b\nmesh pinion-gear", "a\nmesh second"]
    boxes = [axes.get_position() for axes in figure.axes if axes.get_visible()]
    assert boxes[0].x0 < boxes[1].x0
    labels = [axes.get_ylabel() for axes in figure.axes if axes.get_visible()]
    assert labels == [
        "normal force $F_n$ [kN]",
        "normal force $F_n$ [N]",
        "normal force $F_n$ [kN]",
    ]


def test_over_the_roll_angle_lines_and_events_stand_where_the_wheel_was():
    angles = np.linspace(0.0, 1.0, 101)
    history = RealPair().history(angles)
    events = xr.Dataset(
        {
            "time": ("event", [25.0]),
            "kind": ("event", np.array(["contact_opened"], dtype=object)),
            "mesh": ("event", [0]),
        }
    )
    (axes,) = draw_quantities([Run(history, events)], ["normal_force"], over=X.ROLL_ANGLE).axes
    assert axes.get_xlabel() == "roll angle of the driving wheel [°]"
    line, mark = axes.lines
    rolled = -history["angle"].values[:, 0]
    np.testing.assert_allclose(line.get_xdata(), np.degrees(rolled), rtol=1e-12)
    assert mark.get_xdata() == pytest.approx(np.degrees(rolled[25]))


def test_places_whose_pairs_never_carry_load_are_left_out():
    history = RealPair(penetration=0.0).history(2 * np.pi / 20 * np.arange(505) / 100)
    figure = draw_quantities([Run(history)], ["pair_normal_force"])
    assert legend(figure) == ["drive_0", "drive_1", "drive_2"]


def test_what_holds_between_outputs_is_drawn_in_steps(history):
    figure = draw_quantities([Run(history)], ["pairs_in_contact"])
    assert figure.axes[0].lines[0].get_drawstyle() == "steps-post"


def test_a_gap_stays_a_gap_however_long_the_run():
    n = 50_000
    values = np.sin(np.linspace(0.0, 100.0, n))
    values[20_000:20_100] = np.nan
    force = xr.DataArray(values[:, None], dims=("time", "mesh"), attrs={"units": "N"})
    long = xr.Dataset(
        {"normal_force": force}, coords={"time": np.linspace(0, 5.0, n), "mesh": ["m"]}
    )
    x, y = draw_quantities([Run(long)], ["normal_force"]).axes[0].lines[0].get_data()
    assert np.isnan(y[(x > 2.0) & (x < 2.01)]).any()


@pytest.mark.parametrize(
    ("names", "chosen", "message"),
    [
        (["normal_froce"], {}, "did you mean normal_force"),
        (["force"], {}, "did you mean .*pair_normal_force"),
        (["contact_ratio"], {}, "is not a variable over time"),
        (["normal_force"], {"mesh": ["third"]}, "has no mesh `third`; there is first, second"),
        (["normal_force"], {"wheel": ["motor"]}, "has no wheel, so none can be selected"),
        (["all_of_them"], {}, "14 panels, but at most 12"),
        (["nothing"], {}, "has no value"),
    ],
)
def test_what_cannot_be_drawn_is_refused_with_the_remedy(history, names, chosen, message):
    many = history["angle"].isel(wheel=[0] * 14).drop_vars("wheel").rename(wheel="spot")
    history["all_of_them"] = many.expand_dims(axis=2, dim={"side": 1})
    history["nothing"] = history["normal_force"] * np.nan
    with pytest.raises(HistoryError, match=message) as refused:
        draw_quantities([Run(history)], names, chosen)
    assert refused.value.code == 2


def test_the_path_of_contact_is_marked_by_roll_angles_of_the_geometry():
    pair = RealPair()
    path = path_of(pair.history(np.linspace(0.0, 1.0, 11)), 0)
    base = pair.base[0]
    assert path.start == pytest.approx(pair.path[0] / base)
    assert path.end == pytest.approx(pair.path[1] / base)  # tan of the pressure angle at the tip
    # At the pitch point both flanks roll without sliding: rho_A omega_A = rho_B omega_B.
    rho = path.pitch_point * base
    assert rho / pair.teeth[0] == pytest.approx((pair.length - rho) / pair.teeth[1])
    single = np.array(path.single) * base
    assert single == pytest.approx([pair.path[1] - pair.pitch, pair.path[0] + pair.pitch])


def test_each_pass_of_a_pair_lies_within_the_path_and_has_its_force():
    pair = RealPair(penetration=0.0)
    history = pair.history(2 * np.pi / 20 * np.arange(505) / 100)
    found = passes(history, "pair_normal_force", 0)
    assert len(found) == 7  # five pitches, and the pairs on the path at both ends
    path = path_of(history, 0)
    for angle, force in found:
        assert (np.diff(angle) > 0).all()
        assert angle.min() >= path.start - 1e-12
        assert angle.max() <= path.end + 1e-12
        assert len(set(force)) == 1  # 100, 110 or 120 N, by the number of the pair


def test_beyond_the_path_only_what_carries_load_is_shown():
    history = RealPair(penetration=0.0).history(2 * np.pi / 20 * np.arange(505) / 100)
    (axes,) = draw_on_path([("", history)], ["pair_normal_force"]).axes
    path = path_of(history, 0)
    low, high = axes.get_xlim()
    assert low == pytest.approx(np.degrees(path.start), abs=1.0)
    assert high == pytest.approx(np.degrees(path.end), abs=1.0)
    assert [text.get_text() for text in axes.texts] == ["A", "C", "E", "B", "D"]


@pytest.fixture
def stages_file(tmp_path) -> Path:
    return write_history(tmp_path / "stages.h5", two_stages(), no_events())


@pytest.mark.parametrize(
    ("arguments", "names"),
    [
        (["normal_force"], ["stages-normal_force"]),
        (
            ["normal_force,friction_loss", "speeds"],
            ["stages-normal_force-friction_loss", "stages-speeds"],
        ),
        (["pair_normal_force", "--over", "path"], ["stages-pair_normal_force-over-path"]),
        (["path", "--mesh", "first"], ["stages-path"]),
        (["normal_force", "--mesh", "second", "--over", "roll-angle"], ["stages-normal_force"]),
        (["pairs", "--over", "time"], ["stages-pairs"]),
        (["centre_displacement", "--select", "wheel=drum"], ["stages-centre_displacement"]),
    ],
)
def test_plot_draws_what_is_asked_for(post, stages_file, arguments, names):
    quantities, options = [], []
    for text in arguments:
        (options if text.startswith("--") or options else quantities).append(text)
    asked = [word for name in quantities for word in ("--quantity", name)]
    code, out, err = post("plot", stages_file, *asked, *options)
    assert (code, err) == (0, "")
    assert out.split() == [f"{name}.png" for name in names]


@pytest.mark.parametrize("text", ["50000 ms", "5e4ms", "50", "5e7us", "5e7 µs", "5e1 s"])
def test_times_are_taken_in_the_units_that_axes_show(post, stages_file, text):
    code, _, err = post("plot", stages_file, "--quantity", "normal_force", "--from", text)
    assert (code, err) == (0, "")
    code, _, _ = post("plot", stages_file, "--from", text, "--to", "49.5", "--quantity", "speeds")
    assert code == 2


@pytest.mark.parametrize("text", ["soon", "25 mm", "ms", "1 2 s"])
def test_what_is_no_time_is_wrong_usage(post, stages_file, text):
    code, out, err = post("plot", stages_file, "--from", text)
    assert (code, out) == (2, "")
    assert "is not a time, such as 0.025 or 25ms" in err


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--quantity", "normal_froce"], "did you mean normal_force, pair_normal_force"),
        (["--quantity", "pares"], "did you mean pairs"),
        (["--quantity", "teeth"], "`teeth` is not a variable over time"),
        (["--quantity", "pairs,normal_force"], "pairs is a separate figure"),
        (
            ["--quantity", "pairs", "--mesh", "first"],
            "draw its variables instead: --quantity pair_",
        ),
        (["--quantity", "normal_force", "--over", "path"], "is not of tooth pairs"),
        (
            ["--quantity", "angle", "--over", "roll-angle"],
            "is not of a mesh, so it has no roll angle",
        ),
        (["--quantity", "path", "--mesh", "third"], "has no mesh `third`; there is first, second"),
        (["--quantity", "pair_normal_force", "--over", "path", "--pair", "drive_0"], "--mesh only"),
    ],
)
def test_plot_refuses_what_cannot_be_drawn_in_one_line(post, stages_file, arguments, message):
    code, out, err = post("plot", stages_file, *arguments)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert message in err


def test_plot_lists_all_variables_of_a_file(post, stages_file):
    code, out, _ = post("plot", stages_file, "--list")
    assert code == 0
    for name in ("normal_force", "pair_contact_pressure", "angular_velocity"):
        assert f"\n {name} " in out


def test_a_run_with_a_window_for_its_numbers_shows_that_window(post, tmp_path):
    history = two_stages().assign(window_begin=100.0, window_end=200.0)
    file = write_history(tmp_path / "steady.h5", history, no_events())
    for options, reported in (([], True), (["--whole"], False), (["--from", "50"], False)):
        code, _, err = post("plot", file, "--quantity", "normal_force", *options)
        assert code == 0
        assert (
            "shows the window of its numbers, 100 to 200 s; --whole shows all" in err
        ) is reported
