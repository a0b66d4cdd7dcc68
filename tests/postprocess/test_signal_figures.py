"""Pictures of spectra, order maps and Campbell's."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from signal_results import campbell_of_two_modes, map_of_run_up, spectrum_of_orders

from evolvent import HistoryError
from evolvent.figures.campbell import draw_campbell, spread
from evolvent.figures.order_map import DARK, draw_order_maps
from evolvent.figures.spectrum import FEW, draw_spectra


def grey(colour) -> float:
    return float(np.dot(to_rgb(colour), [0.299, 0.587, 0.114]))


FIGURES = {
    "stems": lambda: draw_spectra([("one", spectrum_of_orders())]),
    "curve": lambda: draw_spectra([("one", spectrum_of_orders(60))]),
    "several": lambda: draw_spectra(
        [("without relief", spectrum_of_orders()), ("with relief", spectrum_of_orders(5, 0.3))]
    ),
    "map": lambda: draw_order_maps([("", map_of_run_up())]),
    "maps": lambda: draw_order_maps([("one", map_of_run_up()), ("two", map_of_run_up())]),
    "frequencies": lambda: draw_order_maps([("", map_of_run_up())], True, True),
    "campbell": lambda: draw_campbell(campbell_of_two_modes()),
}


@pytest.mark.parametrize("draw", FIGURES.values(), ids=list(FIGURES))
def test_nothing_is_clipped_and_every_axis_has_a_label_with_its_unit(draw):
    figure = draw()
    figure.draw_without_rendering()
    needed = figure.get_tightbbox()
    width, height = figure.get_size_inches()
    slack = 0.02  # inches
    assert min(needed.x0, needed.y0) >= -slack
    assert needed.x1 <= width + slack
    assert needed.y1 <= height + slack
    for axis in figure.axes[-1:]:
        assert "[" in axis.get_ylabel()
        assert axis.get_xlabel() or axis.get_ylabel().startswith("amplitude")


def test_lines_of_few_stand_as_high_as_they_are_in_prefixed_units():
    found = spectrum_of_orders()
    assert found.sizes["order"] < FEW
    (marks,) = draw_spectra([("", found)]).axes[0].lines
    heights = dict(zip(np.round(marks.get_xdata(), 6), marks.get_ydata(), strict=True))
    assert heights == pytest.approx({1.0: 500.0, 2.0: 200.0, 5.0: 30.0}, rel=1e-9)


def test_several_spectra_differ_by_marks_and_lightness_and_are_named():
    figure = FIGURES["several"]()
    marks = [line for line in figure.axes[0].lines if len(line.get_xdata())]
    assert len({line.get_marker() for line in marks}) == 2
    assert abs(np.diff([grey(line.get_markeredgecolor()) for line in marks])[0]) > 0.15
    names = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    assert names == ["without relief", "with relief"]


def test_darker_is_more_in_an_order_map_also_in_grey():
    lightness = [grey(DARK(x)) for x in np.linspace(0.0, 1.0, 50)]
    assert (np.diff(lightness) < 0).all()


def test_maps_beside_each_other_have_one_scale():
    figure = FIGURES["maps"]()
    scales = [axis.collections[0].norm.vmax for axis in figure.axes[:2]]
    assert scales[0] == scales[1]
    assert [axis.get_title(loc="left") for axis in figure.axes[:2]] == ["one", "two"]


def test_a_map_is_over_speed_unless_the_speed_turns_round():
    found = map_of_run_up()
    assert draw_order_maps([("", found)]).axes[0].get_xlabel() == "speed of pinion [rpm]"
    assert draw_order_maps([("", found)], over_time=True).axes[0].get_xlabel() == "time [ms]"
    back = found.assign(speed=("time", np.abs(np.linspace(-9, 7, found.sizes["time"]))))
    assert draw_order_maps([("", back)]).axes[0].get_xlabel() == "time [ms]"


def test_crossings_are_marked_where_orders_meet_modes():
    result = campbell_of_two_modes()
    axis = draw_campbell(result).axes[0]
    (marks,) = [line for line in axis.lines if line.get_marker() == "o"]
    np.testing.assert_allclose(marks.get_xdata(), result["crossing_speed"] * 30 / np.pi)
    np.testing.assert_allclose(marks.get_ydata(), result["crossing_frequency"] / 1000)


def test_labels_of_orders_keep_apart_near_where_they_belong():
    positions = [0.1, 0.11, 0.12, 0.5, 0.98, 0.99]
    found = spread([(position, "") for position in positions], 0.05)
    assert (np.diff(found) >= 0.05 - 1e-12).all()
    assert found[:3] == pytest.approx([0.06, 0.11, 0.16])
    assert found[3] == 0.5
    assert abs(np.array(found) - positions).max() < 0.05


def test_what_does_not_belong_into_one_picture_is_refused():
    one = spectrum_of_orders()
    for other, match in (
        (one.assign_attrs(order_of="wheel gear"), "mesh pinion-gear, wheel gear"),
        (one.assign_attrs(quantity="normal_force"), "normal_force, transmission_error"),
    ):
        with pytest.raises(HistoryError, match=match):
            draw_spectra([("", one), ("", other)])
    maps = map_of_run_up()
    with pytest.raises(HistoryError, match="different quantities"):
        draw_order_maps([("", maps), ("", maps.assign_attrs(quantity="gap"))])
