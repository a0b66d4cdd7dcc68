"""The picture of a response."""

from __future__ import annotations

import math

import numpy as np
import pytest
from response_results import JUMP, backlash_response

from evolvent.figures.response import draw_response


def test_picture_shows_both_ways_and_marks_jumps_and_what_does_not_repeat():
    response = backlash_response()
    panel, factor, period = draw_response(response).axes
    lines = {str(line.get_label()): line for line in panel.lines}
    rpm = 30 / math.pi
    x = response["parameter"].values * rpm
    deviations = response["transmission_error_standard_deviation"].values[:, :, 0] * 1e6
    for line, expected in zip((lines["up"], lines["down"]), deviations, strict=True):
        np.testing.assert_allclose(line.get_xdata(), x, rtol=1e-12)
        np.testing.assert_allclose(line.get_ydata(), expected, rtol=1e-12)
    assert lines["up"].get_linestyle() == "-" != lines["down"].get_linestyle()
    np.testing.assert_allclose(lines["up, not periodic"].get_xdata(), x[3:4], rtol=1e-12)
    assert "down, not periodic" not in lines
    for axes in (panel, factor, period):
        mark = axes.lines[-1]
        assert mark.get_xdata()[0] == pytest.approx(sum(JUMP) / 2 * rpm)
        assert mark.get_color() == lines["down"].get_color()
    assert panel.get_xlim() == pytest.approx((x[0], x[-1]))  # the first value is on the left
