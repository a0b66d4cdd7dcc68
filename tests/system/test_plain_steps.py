"""A sweep in plain steps, by an independent oscillator."""

from __future__ import annotations

import copy

import pytest

from system.oscillator_alone import Oscillator, falls, steps


@pytest.mark.parametrize(
    ("omega", "known"), [(0.7, 0.363006711), (1.3, 0.182425960), (2.0, 0.652445783)]
)
def test_oscillator_alone_has_the_figures_of_another_program(omega: float, known: float) -> None:
    """The values used by test_respond."""
    motion = Oscillator()
    period = motion.settle(omega, 0.0, 2000)
    assert period in ({2, 4, 8} if omega == 2.0 else {1})
    assert motion.deviation(omega, 0.0, period) == pytest.approx(known, abs=1e-9)


def test_flanks_that_part_but_do_not_come_clear_touch_where_their_force_returns() -> None:
    """For x + 2 z v, zero at first: after -2 (v + 2 z)."""
    motion = Oscillator()
    pieces: list[tuple[float, ...]] = []
    motion.x, motion.v, motion.touches = 0.0054, -0.09, False
    motion.pitch(0.435, 0.0, pieces)
    assert pieces[0][0] == pytest.approx(0.06, rel=1e-12)
    assert pieces[1][2:] == (pytest.approx(0.0018), pytest.approx(-0.03), True)


@pytest.mark.parametrize("position", [0.0, 0.5])
def test_in_small_steps_the_motion_ends_where_respond_says(position: float) -> None:
    """0.4115, independent of the position in the pitch at which the speed changes."""
    values = [*steps(1.0, 0.46), *steps(0.459, 0.414, 0.001), *steps(0.41395, 0.411, 0.00005)]
    *_, (before, after, _) = falls(values, position)
    assert 0.4113 <= after < before <= 0.4117


def test_by_the_same_rule_the_way_up_is_the_told_one() -> None:
    """A jump from 0.4975 at 0.750 to 1.3310 at 0.755, period 2 from 1.850."""
    up = dict(Oscillator().follow(steps(0.755, 0.7)[::-1], 0.0, 300))
    assert (up[0.75], up[0.755]) == pytest.approx((0.4975, 1.3310), abs=5e-5)
    up = dict(Oscillator().follow(steps(1.85, 1.82)[::-1], 0.0, 300))
    assert up[1.845] < 0.1 < 0.8 < up[1.85]


def test_where_the_second_pair_comes_it_falls_as_told_after_a_multiple_of_four_pitches() -> None:
    """The motion of period 2 has period 4 and 8 there: another count changes its position.

    The first line of the other program's table, down: falls at 0.825 to 1.0698.
    """
    (end,) = falls(steps(2.4, 0.82), 0.0, 300)
    assert end == (0.83, 0.825, pytest.approx(1.0698, abs=5e-5))
    assert falls(steps(2.4, 0.85), 0.0, 301)[0][:2] == (0.855, 0.85)


def test_at_the_second_fall_a_billionth_decides_between_three_motions() -> None:
    """The second line, between 0.440 and 0.435 to 0.5246, is one of three results of that step.

    In one of both pitches of the period; in the other the motion continues.
    """
    motion = Oscillator()
    assert falls(steps(0.8, 0.44), 0.0, 256, motion) == []
    ends = []
    for tries in (200, 40):
        found = set()
        for i in range(tries):
            one = copy.copy(motion)
            one.x += i * 1e-9 / tries
            ((_, deviation),) = one.follow([0.435], 0.0, 200)
            found.add(round(deviation, 1 if deviation > 1 else 4))
        ends.append(found)
        motion.pitch(0.44, 0.0)
    goes_on, mixed = sorted(ends, key=len)
    assert goes_on == {4.6}
    assert mixed >= {0.5246, 1.1, 4.6}
