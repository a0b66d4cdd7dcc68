"""The picture of branches of orbits."""

from __future__ import annotations

import numpy as np
from orbits_results import folded_orbits

from evolvent.figures.orbits import UNSTABLE, draw_orbits


def test_picture_tells_stable_from_unstable_and_marks_where_that_changes() -> None:
    panel, factor, periods = draw_orbits(folded_orbits()).axes
    for axes in (panel, factor):
        drawn = [
            (str(line.get_label()), np.asarray(line.get_xdata()).tolist()) for line in axes.lines
        ]
        assert drawn == [
            ("period 1, stable", [1.0, 2.0, 3.0, 3.5]),
            ("period 1, stable", [2.5, 2.0]),
            ("period 1, unstable", [3.5, 3.0, 2.5]),
            ("period 2, stable", [2.5, 3.0]),
            ("fold", [3.5]),
            ("period doubling", [2.5]),
        ]
    styles = [line.get_linestyle() for line in panel.lines[:3]]
    assert styles == ["-", "-", "--"]
    assert UNSTABLE != "-"
    assert panel.lines[0].get_color() == panel.lines[2].get_color() != panel.lines[3].get_color()
    np.testing.assert_allclose(panel.lines[0].get_ydata(), [1, 2, 3, 4])
    # orbits of two periods lie on those of one, thinner; below the periods stand apart
    assert panel.lines[3].get_linewidth() < panel.lines[0].get_linewidth()
    assert panel.lines[3].get_zorder() > panel.lines[0].get_zorder()
    heights = [set(np.asarray(line.get_ydata()).tolist()) for line in periods.lines]
    assert heights == [{0.0}, {0.0}, {0.0}, {1.0}]
    assert [text.get_text() for text in periods.get_yticklabels()] == ["1", "2"]


def test_fold_at_a_touch_has_a_mark_of_its_own() -> None:
    orbits = folded_orbits()
    orbits["orbit_kind"].values[3] = 6
    panel = draw_orbits(orbits).axes[0]
    drawn = {str(line.get_label()): line for line in panel.lines}
    mark = drawn["fold with grazing of the mesh"]
    assert "fold" not in drawn
    assert np.asarray(mark.get_xdata()).tolist() == [3.5]
    assert mark.get_markerfacecolor() == "white"  # open, so that it is another one in grey too
