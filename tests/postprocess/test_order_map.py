"""Order maps of run-ups: each window has the lines of its place."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from signal_histories import START, by_angle, signal_history

from evolvent.commands.post.waterfall import make_map
from evolvent.signals.selection import select

LENGTH = 4


def order_map(history: xr.Dataset, order_of: str | None = None, **more) -> xr.Dataset:
    options = {"length": LENGTH, "hop": None, "shape": None, "highest": None, **more}
    return make_map(history, select(history, "transmission_error", {}), order_of, *options.values())


def stepped(xi: np.ndarray) -> np.ndarray:
    """Order 1 and order 3, which grows from window to window of 4 pitches."""
    growing = 1e-8 * (1 + (xi + 1e-9) // LENGTH)
    return 5e-7 * np.cos(2 * np.pi * xi - 0.2) + growing * np.cos(2 * np.pi * 3 * xi + 1.0)


def test_windows_by_angle_are_exact_and_follow_a_change():
    xi = np.arange(0, 40, 1 / 16)
    found = order_map(by_angle("pitch", "pinion-gear", 16, xi, stepped(xi)), hop=LENGTH)
    assert dict(found.sizes) == {"time": 10, "order": 33}
    np.testing.assert_allclose(found["order"], np.arange(33) / 4, rtol=1e-12)
    np.testing.assert_allclose(found["amplitude"].sel(order=1), 5e-7, rtol=1e-9)
    np.testing.assert_allclose(
        found["amplitude"].sel(order=3), 1e-8 * np.arange(1, 11), rtol=0, atol=1e-9 * 5e-7
    )
    np.testing.assert_allclose(found["phase"].sel(order=1), 0.2, atol=1e-9)
    np.testing.assert_allclose(found["phase"].sel(order=3), -1.0, atol=1e-7)


def test_a_run_up_by_time_has_constant_orders_and_its_speed():
    time = np.linspace(0.0, 1.0, 40001)
    turns = 5.0 * time + 20.0 * time**2  # 47 rows a pitch at the end
    xi = 19 * turns + START
    signal = 5e-7 * np.cos(2 * np.pi * xi - 0.2) + 1e-7 * np.cos(2 * np.pi * 2 * xi + 1.0)
    found = order_map(signal_history(time, turns, signal), "pinion-gear")
    # 23 rows a period of order 2: the spline takes 1e-11
    np.testing.assert_allclose(found["amplitude"].sel(order=1), 5e-7, rtol=1e-9)
    np.testing.assert_allclose(found["amplitude"].sel(order=2), 1e-7, rtol=1e-9)
    np.testing.assert_allclose(found["phase"].sel(order=2), -1.0, atol=1e-8)
    # the mean speed of a window is that at its middle: the speed grows evenly
    speed = 2 * np.pi * (5.0 + 40.0 * found["time"])
    np.testing.assert_allclose(found["speed"], speed, rtol=1e-9)
    np.testing.assert_allclose(
        found["frequency"], found["speed"] * 19 / (2 * np.pi) * found["order"], rtol=1e-12
    )


def test_orders_of_a_wheel_are_in_windows_of_its_turns():
    time = np.linspace(0.0, 1.0, 20001)
    turns = 10.0 * time
    history = signal_history(time, turns, 2e-6 * np.cos(2 * np.pi * turns * 19 / 34 - 0.9))
    found = order_map(history, "gear", length=1)
    assert found.sizes["time"] == 5
    np.testing.assert_allclose(found["amplitude"].sel(order=1), 2e-6, rtol=1e-9)
    np.testing.assert_allclose(found["phase"].sel(order=1), 0.9, atol=1e-9)
    np.testing.assert_allclose(found["speed"], 2 * np.pi * 10 * 19 / 34, rtol=1e-9)


def test_a_resonance_shows_at_its_frequency_in_the_map():
    time = np.linspace(0.0, 1.0, 40001)
    turns = 5.0 * time + 20.0 * time**2
    signal = 1e-7 * np.cos(2 * np.pi * 600.0 * time)
    found = order_map(signal_history(time, turns, signal), "pinion-gear", shape="hann")
    top = found["amplitude"][:, 1:].argmax("order") + 1
    frequency = found["frequency"].values[np.arange(found.sizes["time"]), top]
    width = found["frequency"].values[:, 1]
    late = found["speed"].values * 19 / (2 * np.pi) > 150.0  # lines up to order 4 there
    assert (abs(frequency - 600.0) <= width)[late].all()


@pytest.mark.parametrize(("hop", "windows"), [(1, 37), (2, 19), (4, 10)])
def test_windows_overlap_as_asked(hop, windows):
    xi = np.arange(0, 40, 1 / 16)
    history = by_angle("pitch", "pinion-gear", 16, xi, stepped(xi))
    assert order_map(history, hop=hop).sizes["time"] == windows
