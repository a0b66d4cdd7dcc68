"""The picture of branches of orbits."""

from __future__ import annotations

import numpy as np
from orbits_results import folded_orbits

from evolvent.figures.orbits import UNSTABLE, draw_orbits


def test_picture_tells_stable_from_unstable_and_marks_where_that_changes() -> None:
    panel, factor = draw_orbits(folded_orbits()).axes
    for axes in (panel, factor):
        drawn = [
            (str(line.get_label()), np.asarray(line.get_xdata()).tolist()) for line in axes.lines
        ]
        assert drawn == [
            ("period 1, stable", [1.0, 2.0, 3.0, 3.5]),
            ("period 1, unstable", [3.5, 3.0, 2.5]),
            ("period 1, stable", [2.5, 2.0]),
            ("period 2, stable", [2.5, 3.0]),
            ("fold", [3.5]),
            ("period doubling", [2.5]),
        ]
    styles = [line.get_linestyle() for line in panel.lines[:3]]
    assert styles == ["-", "--", "-"]
    assert UNSTABLE != "-"
    assert panel.lines[0].get_color() == panel.lines[1].get_color() != panel.lines[3].get_color()
    np.testing.assert_allclose(panel.lines[0].get_ydata(), [1, 2, 3, 4])
