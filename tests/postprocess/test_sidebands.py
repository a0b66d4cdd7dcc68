"""Sidebands of known modulations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import jv
from signal_histories import by_angle

from evolvent.errors import HistoryError
from evolvent.signals.sampling import last_periods, read_record
from evolvent.signals.sidebands import phase, sidebands
from evolvent.signals.turning import find_mesh, wheels_of

ROWS = 16
COMMON = 19 * 34  # pitches until the same teeth meet again


def found(signal, pitches: int = COMMON, n: int = 2, k: int = 2, wheels=("pinion", "gear")):
    xi = np.arange(0, pitches + 1, 1 / ROWS)
    history = by_angle("pitch", "pinion-gear", ROWS, xi, signal(xi))
    mesh = find_mesh(history, "pinion-gear")
    record = read_record(history, history["transmission_error"][:, 0], mesh)
    record = last_periods(record, "x.h5", pitches)
    chosen = [w for w in wheels_of(history, "pinion-gear") if w.name in wheels]
    return {
        (s.mesh_order, s.wheel, s.wheel_order): s
        for s in sidebands(record, "x.h5", chosen, mesh, n, k)
    }


@pytest.mark.parametrize("pitches", [COMMON, 2 * COMMON, 100, 71])
def test_amplitude_modulation_by_both_wheels_is_told_apart_and_exact(pitches):
    def signal(xi):
        pinion = 0.2 * np.cos(2 * np.pi * xi / 19 - 0.5)
        gear = 0.05 * np.cos(2 * np.pi * 2 * xi / 34 + 1.0)
        return 1e-5 + 5e-7 * (1 + pinion + gear) * np.cos(2 * np.pi * xi - 0.3)

    bands = found(signal, pitches)
    first = bands[1, "pinion", 1]
    assert abs(first.carrier) == pytest.approx(5e-7, rel=1e-9)
    assert phase(first.carrier) == pytest.approx(0.3, abs=1e-9)
    assert abs(first.lower) == pytest.approx(5e-8, rel=1e-9)
    assert phase(first.lower) == pytest.approx(0.3 - 0.5, abs=1e-8)
    assert phase(first.upper) == pytest.approx(0.3 + 0.5, abs=1e-8)
    assert first.amplitude_modulation == pytest.approx(0.2, rel=1e-9)
    assert first.phase_modulation < 1e-9
    assert first.spacing == pytest.approx(1 / 19, rel=1e-15)
    assert bands[1, "gear", 2].amplitude_modulation == pytest.approx(0.05, rel=1e-8)
    for key in ((1, "pinion", 2), (1, "gear", 1)):
        assert bands[key].amplitude_modulation < 1e-9


def test_phase_modulation_gives_bessel_functions():
    def signal(xi):
        return 5e-7 * np.cos(2 * np.pi * xi - 0.3 + 0.1 * np.cos(2 * np.pi * xi / 34 - 0.8))

    one = found(signal)[1, "gear", 1]
    assert one.amplitude_modulation < 1e-9
    assert one.phase_modulation == pytest.approx(2 * jv(1, 0.1) / jv(0, 0.1), rel=1e-9)
    assert one.phase_modulation == pytest.approx(0.1, rel=0.1**2 / 8 * 1.1)  # as it is documented


def test_a_large_order_of_a_wheel_leaks_into_no_sideband():
    def signal(xi):
        runout = 2e-5 * np.cos(2 * np.pi * xi / 19 - 0.2)
        return runout + 5e-7 * np.cos(2 * np.pi * xi) + 1e-7 * np.cos(2 * np.pi * 2 * xi)

    for band in found(signal, 71).values():
        # 2e-5 at a rounding of 1e-16 and a condition of 1e2
        assert max(abs(band.lower), abs(band.upper)) < 1e-9 * 5e-7 * 40


def test_sidebands_that_meet_those_of_the_next_order_are_refused():
    with pytest.raises(HistoryError, match="choose at most 9 by --sides"):
        found(np.cos, 20, k=10, wheels=("pinion",))


def test_lines_that_are_too_close_for_the_record_are_refused_with_its_length():
    with pytest.raises(HistoryError, match=r"too few to separate lines .* for 162 pitches, or"):
        found(np.cos, 36, k=4)
