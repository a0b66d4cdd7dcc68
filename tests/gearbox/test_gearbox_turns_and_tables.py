"""Whole revolutions of the reference wheel, and knots of tables."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.gearbox import LOADED, OPEN, Event, Gearbox, State
from kernel.gearbox_cases import (
    PAIRS,
    branch,
    chain,
    in_mode,
    moved,
    paper_gearbox,
    prescribed,
    press,
    worst,
)
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEED,
    SPEEDS,
    TABLE,
    load,
    mesh,
    wheel,
)
from kernel.housing import Pair
from kernel.kernel import Kernel

EVERY_PAIR = pytest.mark.parametrize("pair", PAIRS.values(), ids=PAIRS.keys())
TRACKINGS = pytest.mark.parametrize("tracking", [CLOSED_FORM, ALGEBRAIC, DIFFERENTIAL])
KNEE = 1e-3
FRICTION = (0.3, KNEE)


def is_consistent(gearbox: Gearbox, state: State) -> bool:
    return bool((state.yp == gearbox.derivative(state)).all())


@EVERY_PAIR
@TRACKINGS
@pytest.mark.parametrize("turns", [-2, -1, 1, 2])
def test_whole_turns_are_taken_off_the_reference_angle_and_nothing_else_changes(
    kernel: Kernel, pair: Pair, tracking: str, turns: int
):
    random = np.random.default_rng(7)
    gearbox = pair.gearbox(kernel, tracking=tracking, friction=FRICTION)
    state = in_mode(gearbox, random, (LOADED, 0))
    gearbox.mode(state)[2] = branch(gearbox, state)
    index = gearbox.index("reference_angle")
    theta = state.y[index] % (2 * np.pi) - (2 * np.pi if turns < 0 else 0)
    state.integers[0] += round((state.y[index] - theta) / (2 * np.pi))
    state.y[index] = theta + 2 * np.pi * turns
    state.integers[0] -= turns
    after, events = gearbox.apply(state, "revolution")
    assert events == [Event("revolution", -1, -1, -1)]
    assert after.integers[0] == state.integers[0] + turns
    assert after.y[index] == pytest.approx(theta, abs=4e-15)
    old, new = gearbox.outputs(state), gearbox.outputs(after)
    for name, values in old.items():
        if name in ("reference_angle", "reference_turns"):
            continue
        if "residual" in name or "distance" in name:  # only rounding, before and after
            assert tracking == CLOSED_FORM or abs(new[name][0]) < 1e-16
            continue
        # theta is rounded to 1e-15, and so are the points; torques and friction depend on these
        tolerance = 1e-12 * abs(values) + 1e-11 * abs(values).max()
        assert worst(np.nan_to_num(new[name] - values), tolerance) <= 1, name
    for name in ("tooth_pair", "angular_velocity", "angle_deviation"):
        np.testing.assert_array_equal(new[name], old[name])


def test_the_root_of_the_turns_is_zero_after_two_either_way(kernel: Kernel):
    gearbox = paper_gearbox(kernel)
    state = gearbox.start()
    for theta, sign in ((0.0, 1), (4 * np.pi, 0), (-4 * np.pi, 0), (13.0, -1), (-13.0, -1)):
        state.y[0] = theta
        value = gearbox.roots(state)[-1]
        assert np.sign(round(value, 14)) == sign
    assert gearbox.root_directions(state)[-1] == -1


def test_any_event_past_a_turn_takes_it_off(kernel: Kernel):
    """Theta is large only in between; less than a revolution remains, up to rounding."""
    gearbox = paper_gearbox(kernel)
    just = [
        (side * np.nextafter(4 * np.pi, x), 2 * side) for side in (1, -1) for x in (0, 4 * np.pi)
    ]
    for theta, turns in ((6.0, 0), (-6.0, 0), (7.0, 1), (-7.0, -1), *just):
        state = gearbox.start()
        press(gearbox, state, 0, OPEN)
        state.y[0] = theta
        after, events = gearbox.apply(state, "forward")
        assert after.integers[0] == turns
        assert [e.name for e in events] == ["tooth_switch"] + ["revolution"] * (turns != 0)
        assert abs(after.y[0]) < 2 * np.pi


@TRACKINGS
def test_knots_of_tables_come_in_their_order_and_leave_the_torque_continuous(
    kernel: Kernel, tracking: str
):
    gearbox = prescribed(kernel, tracking)  # knots at 0, 1 and at 0, 0.2, 3
    state = gearbox.start(SPEEDS, speeds=[0.0, 0.0])
    assert state.integers[-2:].tolist() == [1, 1]  # that at the start has passed
    times = []
    for _ in range(3):
        t = gearbox.next_time_event(state)
        times.append(t)
        state.t = t
        after, events = gearbox.apply(state, time_event=True)
        assert events == [Event("table_knot", -1, -1, -1)]
        assert moved(gearbox, after, state) <= 1
        assert is_consistent(gearbox, after)
        old, new = gearbox.outputs(state), gearbox.outputs(after)
        assert new["load_torque"][0] == pytest.approx(old["load_torque"][0], rel=1e-15)
        state = after
    assert times == [0.2, 1.0, 3.0]
    assert gearbox.next_time_event(state) == np.inf
    assert state.integers[-2:].tolist() == [2, 3]
    assert gearbox.outputs(state)["load_torque"][0] == -10.0  # constant after the last knot
    assert state.yp[gearbox.index("reference_speed")] == 0


@pytest.mark.parametrize("t", [-0.5, 0.05, 0.15, 0.7, 2.9, 4.0])
def test_tables_are_straight_between_their_knots_and_constant_beyond(kernel: Kernel, t: float):
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    times, torques, speeds = [0.0, 0.2, 3.0], [-20.0, -5.0, -10.0], [1.0, 2.0, 5.0]
    loads = [
        load(0, TABLE, table=list(zip(times, torques, strict=True))),
        load(1, SPEED, table=list(zip(times, speeds, strict=True))),
    ]
    gearbox = Gearbox(kernel, wheels, loads, [mesh(kernel)])
    speed = np.interp(t, times, speeds)
    state = gearbox.start(SPEEDS, speeds=[-1.5 * speed, speed], t=t)
    outputs = gearbox.outputs(state)
    assert outputs["load_torque"][0] == pytest.approx(np.interp(t, times, torques), rel=1e-14)
    slopes = [0.0, *(np.diff(speeds) / np.diff(times)), 0.0]
    assert state.yp[gearbox.index("reference_speed")] == pytest.approx(
        slopes[np.searchsorted(times, t)], rel=1e-14
    )


def test_a_start_between_knots_counts_those_that_have_passed(kernel: Kernel):
    gearbox = chain(kernel, 2, CLOSED_FORM)  # knots at 0, 0.5, 2
    for t, passed, following in ((-1.0, 0, 0.0), (0.0, 1, 0.5), (0.7, 2, 2.0), (2.0, 3, np.inf)):
        state = gearbox.start(t=t)
        assert state.integers[-1] == passed
        assert gearbox.next_time_event(state) == following
    assert paper_next(kernel) == np.inf


def paper_next(kernel: Kernel) -> float:
    gearbox = paper_gearbox(kernel)
    return gearbox.next_time_event(gearbox.start())


def test_knots_at_the_same_time_are_passed_together(kernel: Kernel):
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    tables = [load(i, TABLE, table=[(0.0, 0.0), (0.5, 1.0), (1.0 + i, 0.0)]) for i in (0, 1)]
    gearbox = Gearbox(kernel, wheels, tables, [mesh(kernel)])
    state = gearbox.start()
    state.t = gearbox.next_time_event(state)
    after, events = gearbox.apply(state, time_event=True)
    assert [e.name for e in events] == ["table_knot"]
    assert after.integers[-2:].tolist() == [2, 2]
    assert gearbox.next_time_event(after) == 1.0
