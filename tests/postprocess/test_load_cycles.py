"""Rainflow counts, S-N lines, damage, and extremes between outputs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evolvent.physics.between_outputs import with_extremes
from evolvent.physics.load_cycles import Cycles, SNLine, count_cycles, sn_line, turning_points

ASTM = [-2, 1, -3, 5, -1, 3, -4, 4, -2]  # ASTM E1049-85, section 5.4.4 and its figure
MPA = 1e6


def counts(cycles: Cycles) -> dict[float, float]:
    """Number of cycles of each range."""
    found: dict[float, float] = {}
    for size, count in zip(cycles.ranges, cycles.counts, strict=True):
        found[float(size)] = found.get(float(size), 0.0) + float(count)
    return found


def line(**changed: object) -> SNLine:
    block = {
        "stress_type": "range",
        "cycles": [1e4, 1e6],
        "stress": [800 * MPA, 400 * MPA],
        "slope_above": 5,
        "slope_below": "none",
    }
    return sn_line(block | changed)


def test_the_example_of_astm_e1049_has_its_counts() -> None:
    assert counts(count_cycles(ASTM, repeats=False)) == {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}


def test_a_repeating_history_has_no_half_cycles() -> None:
    """The same section, for a history that repeats: each range twice a half."""
    assert counts(count_cycles(ASTM, repeats=True)) == {3: 1.0, 4: 1.0, 7: 1.0, 9: 1.0}


@given(st.lists(st.integers(-9, 9), min_size=2, max_size=30), st.integers(0, 29))
@settings(max_examples=80, deadline=None)
def test_the_count_does_not_depend_on_where_a_period_is_cut(values: list[int], shift: int) -> None:
    turned = values[shift % len(values) :] + values[: shift % len(values)]
    assert counts(count_cycles(values, repeats=True)) == counts(count_cycles(turned, repeats=True))


def test_a_sine_has_one_cycle_a_period() -> None:
    x = 3.0 + 2.0 * np.sin(2.0 * np.pi * np.arange(4000) / 400)
    cycles = count_cycles(x, repeats=True)
    assert cycles.counts.sum() == 10.0
    assert cycles.ranges == pytest.approx(np.full(cycles.ranges.size, 4.0), rel=1e-12)
    assert cycles.means == pytest.approx(np.full(cycles.means.size, 3.0), rel=1e-12)


def test_constant_and_single_values_have_no_cycles() -> None:
    for values in ([], [1.0], [2.0, 2.0, 2.0]):
        for repeats in (True, False):
            if values or not repeats:
                assert count_cycles(values, repeats=repeats).ranges.size == 0
    assert counts(count_cycles([1.0, 4.0], repeats=False)) == {3.0: 0.5}
    assert turning_points([1, 1, 2, 2, 1, 1]).tolist() == [1, 2, 1]


def test_an_s_n_line_meets_its_points_and_its_slopes() -> None:
    below = line(slope_below=20)
    assert below.cycles_to_failure([800 * MPA, 400 * MPA]) == pytest.approx([1e4, 1e6], rel=1e-12)
    # linear in logarithms: the geometric mean of the stresses has that of the cycles
    middle = np.sqrt(800.0 * 400.0) * MPA
    assert below.cycles_to_failure(middle) == pytest.approx(1e5, rel=1e-12)
    assert below.cycles_to_failure(1600 * MPA) == pytest.approx(1e4 / 2**5, rel=1e-12)
    assert below.cycles_to_failure(200 * MPA) == pytest.approx(1e6 * 2**20, rel=1e-12)
    assert line().cycles_to_failure(399.9 * MPA) == np.inf
    assert line().cycles_to_failure(0.0) == np.inf


def test_damage_is_the_miner_sum() -> None:
    cycles = Cycles(np.array([800.0, 400.0, 100.0]) * MPA, np.zeros(3), np.array([3.0, 0.5, 1e9]))
    assert line().damage(cycles) == pytest.approx(3 / 1e4 + 0.5 / 1e6, rel=1e-12)


def test_amplitudes_are_half_ranges() -> None:
    halved = line(stress_type="amplitude", stress=[400 * MPA, 200 * MPA])
    ranges = np.geomspace(300, 2000, 30) * MPA
    assert halved.cycles_to_failure(ranges) == pytest.approx(line().cycles_to_failure(ranges))


LOADS = st.lists(st.floats(-1e9, 1e9, allow_subnormal=False), min_size=3, max_size=25)


@given(LOADS, st.integers(0, 24), st.floats(1.0, 2.0), st.booleans())
@settings(max_examples=120, deadline=None)
def test_damage_does_not_fall_when_an_overload_is_added(
    values: list[float], at: int, overload: float, repeats: bool
) -> None:
    sn = line(slope_below=9)
    more = list(values)
    more.insert(at % len(values), overload * max(map(abs, values)) + 1.0)
    before, behind = (sn.damage(count_cycles(v, repeats=repeats)) for v in (values, more))
    assert behind >= before * (1 - 1e-9)


# --- extremes between outputs


def test_the_extremes_of_a_smooth_signal_do_not_depend_on_the_outputs() -> None:
    """Vertices of parabolas: at most 3 h^4/128 for a sine with outputs at the distance h."""
    none = np.zeros(0)
    for n in (24, 48, 96):
        for offset in (0.0, 0.3, 0.5, 0.77):
            t = (np.arange(n) + offset) / n
            x = np.sin(2 * np.pi * t)[:, None]
            found = with_extremes(t, x, none, 1.0)
            assert np.ptp(found) / 2 == pytest.approx(1.0, abs=3 / 128 * (2 * np.pi / n) ** 4)


@pytest.mark.parametrize(("corner", "is_near"), [(0.505, True), (0.515, True), (0.51, False)])
def test_a_corner_at_an_event_near_an_output_is_reached(corner: float, *, is_near: bool) -> None:
    """Of either side; in the middle between two outputs the larger one remains."""
    t = np.linspace(0.0, 1.0, 51)

    def signal(t: np.ndarray) -> np.ndarray:
        return np.where(t < corner, t**2, corner**2 - 2 * (t - corner))[:, None]

    found = with_extremes(t, signal(t), np.array([corner])).max()
    outputs = signal(t).max()
    assert outputs < corner**2 * (1 - 1e-3)
    assert found == pytest.approx(corner**2 if is_near else outputs, rel=1e-12)
    assert with_extremes(t, signal(t), np.zeros(0)).max() < corner**2 * (1 - 1e-3)


def test_a_step_at_an_event_is_not_smoothed() -> None:
    t = np.linspace(0.0, 1.0, 41)
    x = np.where(t < 0.51, 1.0, 3.0)[:, None]
    found = with_extremes(t, x, np.array([0.51]))
    assert sorted(set(found[:, 0])) == [1.0, 3.0]


def test_a_period_is_cut_anywhere_between_outputs() -> None:
    def signal(t: np.ndarray) -> np.ndarray:
        return (np.sin(2 * np.pi * t) + 0.4 * np.cos(6 * np.pi * t))[:, None]

    expected = None
    for start in (0.0, 0.13, 0.25, 0.61):
        t = start + np.linspace(0.0, 1.0, 201)[1:] + 0.0021
        found = count_cycles(with_extremes(t, signal(t), np.zeros(0), 1.0)[:, 0], repeats=True)
        ranges = np.sort(found.ranges)
        expected = ranges if expected is None else expected
        assert ranges == pytest.approx(expected, rel=1e-4)
