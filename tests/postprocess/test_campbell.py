"""Where orders meet natural frequencies."""

from __future__ import annotations

import numpy as np
import pytest

from evolvent.signals.campbell import Excitation, crossings

MESH = [Excitation("mesh", "m", n, 19.0) for n in (1, 2)]


def test_constant_frequencies_meet_orders_where_they_divide():
    speed = np.array([10.0, 2000.0])
    found = crossings(speed, np.array([[1000.0, 3000.0]] * 2), MESH)
    expected = sorted(2 * np.pi * f / (19 * n) for f in (1000.0, 3000.0) for n in (1, 2))
    assert [c.speed for c in found] == pytest.approx(expected, rel=1e-12)
    for one in found:
        assert one.frequency == pytest.approx((1000.0, 3000.0)[one.mode], rel=1e-12)


def test_a_frequency_that_changes_with_the_speed_is_met_on_its_way():
    speed = np.linspace(100.0, 500.0, 5)
    natural = 300.0 + 2.0 * speed
    (found,) = crossings(speed, natural[:, None], MESH[:1])
    assert found.speed == pytest.approx(300.0 / (19 / (2 * np.pi) - 2.0), rel=1e-12)


@pytest.mark.parametrize("at", [0, 2, 4])
def test_a_meeting_at_a_speed_of_the_grid_counts_once(at):
    speed = np.linspace(100.0, 500.0, 5)
    natural = np.full((5, 1), 19.0 * speed[at] / (2 * np.pi))
    (found,) = crossings(speed, natural, MESH[:1])
    assert found.speed == pytest.approx(speed[at], rel=1e-12)


def test_missing_modes_and_orders_out_of_range_meet_nothing():
    speed = np.array([10.0, 20.0])
    assert crossings(speed, np.array([[np.nan, 1e6]] * 2), MESH) == []
