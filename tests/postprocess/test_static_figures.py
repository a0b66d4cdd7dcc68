"""A static analysis is drawn as it is, and taken for nothing else. Looks were looked at."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from static_curves import RATIO, REACH, share_at, static_curves

from evolvent.errors import HistoryError
from evolvent.figures.static import path_of_pair
from evolvent.figures.table import (
    Run,
    harris,
    load_sharing,
    mesh_stiffness,
    root_stress,
    root_stress_map,
    speeds,
)
from evolvent.figures.table import static_transmission_error as transmission_error
from evolvent.history import HISTORY, STATIC, open_history, open_result, result_kind


@pytest.fixture
def file(tmp_path) -> Path:
    path = tmp_path / "pair-static.h5"
    static_curves().to_netcdf(path, engine="h5netcdf")
    return path


def test_curves_close_the_cycle_in_micrometres():
    static = static_curves()
    panel = transmission_error(Run(static)).axes[0]
    assert panel.get_ylabel() == "transmission error $h$ [µm]"
    assert [line.get_label() for line in panel.lines] == ["10 N m", "20 N m"]
    for line, values in zip(panel.lines, static["transmission_error"].values, strict=True):
        np.testing.assert_allclose(line.get_ydata(), np.append(values, values[0]) * 1e6)
        assert line.get_xdata()[-1] == 1


def test_stiffness_has_a_panel_for_secant_and_tangent():
    labels = [panel.get_ylabel() for panel in mesh_stiffness(Run(static_curves())).axes]
    assert labels == ["secant $F/(h - h_0)$ [N/µm]", "tangent $dF/dh$ [N/µm]"]


@pytest.mark.parametrize("pitches", [1, 2, 7])
def test_a_pair_is_followed_from_place_to_place(pitches: int):
    static = static_curves(pitches=pitches)
    position, share = path_of_pair(static, static["force_share"].values)
    assert (np.diff(position) > 0).all()
    np.testing.assert_allclose(share, np.broadcast_to(share_at(position), share.shape), atol=1e-12)


def test_load_sharing_shows_the_whole_way_and_where_the_path_is():
    panel = load_sharing(Run(static_curves())).axes[0]
    left, right = panel.get_xlim()
    assert left < -REACH + 0.03
    assert right > RATIO + REACH - 0.03
    assert [text.get_text() for text in panel.texts] == ["start of the path", "end"]


def test_harris_map_starts_at_no_torque():
    static = static_curves((5.0, 10.0, 15.0))
    panel = harris(Run(static)).axes[0]
    assert panel.get_xlim() == (0.0, 15.0)
    assert len(panel.lines) == 4
    spread = static["peak_to_peak_transmission_error"] * 1e9
    np.testing.assert_allclose(panel.lines[0].get_ydata(), spread, rtol=1e-12)


def test_root_stress_has_a_column_of_panels_for_each_wheel():
    static = static_curves()
    figure = root_stress(Run(static))
    above, below = figure.axes[:2], figure.axes[2:]
    assert [panel.get_title() for panel in above] == ["wheel pinion", "wheel gear"]
    assert above[0].get_ylabel() == "root stress [MPa]"
    assert "[mm]" in below[0].get_ylabel()
    for wheel, panel in zip(("pinion", "gear"), above, strict=True):
        tension = static["root_stress_max"].sel(wheel=wheel).values * 1e-6
        for line, values in zip(panel.lines[:2], tension, strict=True):
            np.testing.assert_allclose(line.get_ydata(), np.append(values, values[0]))
        assert [line.get_label() for line in panel.lines[:2]] == ["10 N m", "20 N m"]
        for line, values in zip(panel.lines[2:4], tension, strict=True):
            np.testing.assert_allclose(line.get_ydata()[:-1], -1.2 * values)


def test_lines_of_the_arc_end_where_another_tooth_takes_over():
    panel = root_stress(Run(static_curves())).axes[2]
    x, y = panel.lines[0].get_data()
    assert x[np.isnan(y)].tolist() == [pytest.approx(0.525), pytest.approx(1)]
    assert np.nanmax(y) == pytest.approx(1.1)


def test_a_wheel_without_finite_elements_has_no_panel():
    static = static_curves()
    static["root_stress_max"][:, :, 1] = np.nan
    figure = root_stress(Run(static))
    assert [panel.get_title() for panel in figure.axes] == ["wheel pinion", ""]
    nothing = static_curves().drop_dims("wheel")
    with pytest.raises(HistoryError, match=r"nothing for root_stress, .* more than one wheel"):
        root_stress(Run(nothing))


def test_many_torques_come_with_a_bar_of_colours():
    figure = transmission_error(Run(static_curves(tuple(np.arange(1.0, 21.0)))))
    assert not figure.legends
    assert figure.axes[1].get_ylabel() == "torque of the driving wheel [N m]"
    colours = [line.get_color() for line in figure.axes[0].lines]
    assert len(set(colours)) == 20


def test_figures_are_for_their_kind_of_file():
    with pytest.raises(HistoryError, match="nothing for speeds, which shows a history"):
        speeds(Run(static_curves()))
    with pytest.raises(HistoryError, match=r"nothing for harris, .* of more than one torque"):
        harris(Run(static_curves((10.0,))))


def test_kinds_of_files_are_told_apart(file: Path, friction_run):
    assert result_kind(open_result(file, STATIC)) == STATIC
    assert result_kind(open_result(friction_run.path, HISTORY, STATIC)) == HISTORY
    with pytest.raises(HistoryError, match=r"is a static analysis, not a history; .* plot draws"):
        open_history(file)
    with pytest.raises(HistoryError, match="is a history, not a static analysis"):
        open_result(friction_run.path, STATIC)


def test_plot_draws_what_a_file_has(post, file: Path, friction_run):
    code, out, _ = post("plot", file, friction_run.path, "-o", "all")
    assert code == 0
    drawn = [Path(line).stem for line in out.split()]
    static = (
        "static_transmission_error",
        "mesh_stiffness",
        "load_sharing",
        "root_stress",
        "harris",
    )
    assert [name for name in drawn if "static" in name] == [f"pair-static-{n}" for n in static]
    assert "friction-speeds" in drawn


def test_plot_refuses_times_and_quantities_of_histories(post, file: Path):
    code, _, err = post("plot", file, "--from", "1")
    assert (code, "omit --from, --to" in err) == (2, True)
    code, _, err = post("plot", file, "--quantity", "speeds")
    assert (code, "which shows a history" in err) == (3, True)


@pytest.mark.parametrize("command", ["check", "report", "animate"])
def test_commands_for_histories_refuse_it_by_its_kind(post, file: Path, command: str):
    code, _, err = post(command, file)
    assert code == 3
    assert f"{file}: is a static analysis, not a history; evolvent-post plot draws it" in err


def test_root_stress_map_has_tension_and_compression_of_each_wheel_under_the_largest_torque():
    figure = root_stress_map(Run(static_curves((5.0, -20.0, 10.0))))
    panels = np.array(figure.axes[:4]).reshape(2, 2)
    assert [panel.get_title() for panel in panels[0]] == ["wheel pinion", "wheel gear"]
    assert "-20 N m" in figure.get_suptitle().replace("\N{MINUS SIGN}", "-")
    labels = [bar.get_ylabel() for bar in figure.axes[4:]]
    assert [label.endswith("[MPa]") for label in labels] == [True, True]
    for panel in panels.ravel():
        (marked,) = panel.lines
        left, right = panel.get_xlim()
        assert left < marked.get_xdata()[0] < right
