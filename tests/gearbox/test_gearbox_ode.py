"""Interface of a gearbox for the integrator, and its single steps."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import LOADED, OPEN, UNLOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import PAIRS, chain, in_mode, prescribed
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.housing_description import (
    HARMONIC,
    HOUSING_FIXED,
    MOUNTED,
    PRESCRIBED,
    RATE,
    housing,
    term,
)
from kernel.kernel import INVALID_INPUT, Kernel
from kernel.radau import EVENT, LANES, STEP, STOP, Radau, model, serves
from kernel.shaft_cases import stirred, two_stages

MODES = {
    "open": (OPEN, 0),
    "sticking": (LOADED, 0),
    "sliding": (LOADED, -1),
    "unloaded": (UNLOADED, 0),
}
MAKERS: dict[str, Callable[[Kernel], Gearbox]] = {
    "pair with a prescribed speed": lambda kernel: prescribed(kernel, CLOSED_FORM, 1),
    "four wheels": lambda kernel: chain(kernel, 4, CLOSED_FORM, sigma=-1),
    "ring": lambda kernel: chain(kernel, 4, CLOSED_FORM, sigma=1, closed=True),
}


def neighbours(gearbox: Gearbox, state: State, random: np.random.Generator) -> list[State]:
    """Return eight neighbouring states of one mode, the given one first."""
    scale = gearbox.scales()[0]
    states = [state.copy() for _ in range(LANES)]
    for moved in states[1:]:
        moved.y += 0.01 * scale * random.normal(size=len(scale))
        moved.t += 1e-3 * random.random()
    return states


def check_model(gearbox: Gearbox, state: State) -> None:
    """Compare rates and Jacobian with those of the residual."""
    states = neighbours(gearbox, state, np.random.default_rng(4))
    rates, jacobian = model(gearbox, states)
    scale, row = gearbox.scales()
    for lane, one in enumerate(states):
        expected = gearbox.derivative(one)
        # the order of sums may differ: rounding of the forces, whose differences are the rates
        bound = 1e-12 * np.abs(expected / row).max()
        np.testing.assert_allclose(rates[lane] / row, expected / row, rtol=1e-12, atol=bound)
    state.yp[:] = 0
    np.testing.assert_array_equal(jacobian, -gearbox.jacobian(state, 0.0))
    assert np.abs(jacobian * scale).max() > 0


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES.keys())
@pytest.mark.parametrize("maker", MAKERS.values(), ids=MAKERS.keys())
def test_the_sparse_jacobian_and_the_rates_in_lanes_are_those_of_the_gearbox(
    kernel: Kernel, maker: Callable[[Kernel], Gearbox], mode: tuple[int, int]
):
    gearbox = maker(kernel)
    check_model(gearbox, in_mode(gearbox, np.random.default_rng(3), mode, 1e-6))


HOUSINGS = {
    "fixed": None,
    "gravity": housing(HOUSING_FIXED, gravity=[1.0, -9.0, 2.0]),
    "prescribed": housing(
        PRESCRIBED, terms=[term(0, HARMONIC, 1e-4, frequency=40.0), term(5, RATE, 0.3)]
    ),
}


@pytest.mark.parametrize("driven_by", ["torque", "motor", "gear", "drum"])
@pytest.mark.parametrize("moved", HOUSINGS.values(), ids=HOUSINGS.keys())
def test_the_jacobian_of_shafts_and_moving_supports_has_all_its_entries(
    kernel: Kernel, moved: Block | None, driven_by: str
):
    gearbox = two_stages(kernel, housing=moved, driven_by=driven_by, against_housing=True)
    check_model(gearbox, stirred(gearbox, np.random.default_rng(5)))


def test_a_mounted_housing_is_refused(kernel: Kernel):
    mounted = housing(MOUNTED, mass=20.0, inertia=[1.0, 1.0, 1.0])
    with pytest.raises(GearboxError, match="accelerations of a mounted housing are coupled"):
        serves(two_stages(kernel, housing=mounted))


@pytest.mark.parametrize("tracking", [ALGEBRAIC, DIFFERENTIAL])
def test_tracked_points_are_refused_at_their_mesh(kernel: Kernel, tracking: str):
    gearbox = chain(kernel, 3, tracking, sigma=1)
    with pytest.raises(GearboxError, match="algebraic states") as refused:
        serves(gearbox)
    assert (refused.value.code, refused.value.field) == (INVALID_INPUT, "tracking")
    gearbox.start()
    with pytest.raises(GearboxError, match="choose integrator ida"):
        Radau(gearbox)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"tolerance": 1e-14}, "tolerance 1E-14 is not in"),
        ({"tolerance": np.nan}, "tolerance"),
        ({"max_step": 0.0}, "largest step 0 is not positive"),
    ],
)
def test_options_out_of_range_are_refused(kernel: Kernel, changes: dict[str, float], said: str):
    gearbox = PAIRS["paper"].gearbox(kernel)
    gearbox.start()
    with pytest.raises(GearboxError, match=said):
        Radau(gearbox, **changes)


def test_steps_end_where_they_are_told_and_interpolate_their_ends(kernel: Kernel):
    gearbox = PAIRS["paper"].gearbox(kernel)
    state = gearbox.start()
    radau = Radau(gearbox)
    radau.start(state)
    outcome, n, t = STEP, 0, 0.0
    while outcome == STEP:
        before = state.copy()
        outcome, fired = radau.advance(1e-3, state)
        n += 1
        np.testing.assert_array_equal(radau.interpolate(before.t), before.y)
        scale = gearbox.scales()[0]
        np.testing.assert_allclose(radau.interpolate(state.t) / scale, state.y / scale, atol=1e-12)
        assert state.t > t
        t = state.t
        if outcome == EVENT:
            assert fired.any()
            outcome = STOP
    assert state.t <= 1e-3
    assert radau.counts().steps == n
    radau.delete()
    radau.delete()


def test_states_at_eight_times_in_a_step_are_those_at_each_to_the_bit(kernel: Kernel):
    """Also before the first step, with a single state."""
    gearbox = two_stages(kernel)
    state = stirred(gearbox, np.random.default_rng(5))
    radau = Radau(gearbox)
    radau.start(state)
    before = state.t
    for step in range(6):
        if step > 0:
            assert radau.advance(state.t + 1e-6, state)[0] != EVENT
        times = np.linspace(before, state.t, LANES)
        expected = [radau.interpolate(t) for t in times]
        np.testing.assert_array_equal(radau.interpolate_lanes(times), expected)
        before = state.t


def test_a_step_taken_back_is_made_anew_in_smaller_ones(kernel: Kernel):
    gearbox = PAIRS["paper"].gearbox(kernel)
    state = gearbox.start()
    radau = Radau(gearbox)
    radau.start(state)
    for _ in range(4):
        start = state.copy()
        assert radau.advance(5.0, state)[0] == STEP
    length = state.t - start.t
    end = state.copy()
    for times in (1, 2, 3):
        radau.redo(state)
        assert state.t == start.t
        np.testing.assert_array_equal(state.y, start.y)
        radau.advance(5.0, state)
        assert 0 < state.t - start.t <= length / 4**times * (1 + 1e-12)
    while state.t < end.t:
        radau.advance(end.t, state)
    scale = gearbox.scales()[0]
    np.testing.assert_allclose(state.y / scale, end.y / scale, rtol=0, atol=1e-9)  # the tolerance
    assert radau.counts().rejections >= 3
