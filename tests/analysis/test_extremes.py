"""Monitored outputs: one table, and the same values from all sources."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import (
    LOADED,
    OPEN,
    OUTPUTS_OF_EXTREMES,
    UNLOADED,
    Gearbox,
    Output,
    State,
    output_table,
)
from kernel.gearbox_cases import chain, in_mode, paper_gearbox
from kernel.gearbox_description import (
    ALGEBRAIC,
    CLOSED_FORM,
    DIFFERENTIAL,
    SPEEDS,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import Floats, Kernel, _at, _int
from kernel.radau import EVENT, Radau

MODES = {"open": (OPEN, 0), "sticking": (LOADED, 0), "sliding": (LOADED, -1), "none": (UNLOADED, 0)}
MAKERS: dict[str, Callable[[Kernel], Gearbox]] = {
    **{
        f"pair, {name}": lambda kernel, kind=kind: paper_gearbox(kernel, tracking=kind)
        for name, kind in (
            ("closed form", CLOSED_FORM),
            ("algebraic", ALGEBRAIC),
            ("differential", DIFFERENTIAL),
        )
    },
    "four wheels": lambda kernel: chain(kernel, 4, CLOSED_FORM, sigma=-1),
}


NEAR = 0.98  # as requested by the driver


class Candidate(ctypes.Structure):
    """`evl_candidate`."""

    _fields_ = [
        ("channel", _int),
        ("sense", _int),
        *((name, ctypes.c_double) for name in ("t", "left", "right", "value")),
    ]


def table(kernel: Kernel) -> list[Output]:
    return output_table(kernel.library, OUTPUTS_OF_EXTREMES)


def names(kernel: Kernel) -> dict[str, int]:
    """Names of the monitored outputs, and their indices."""
    return {entry.name.decode(): entry.monitored for entry in table(kernel)}


def n_monitored(library: ctypes.CDLL) -> int:
    """Number of monitored outputs."""
    return 1 + max(entry.monitored for entry in output_table(library, OUTPUTS_OF_EXTREMES))


def n_channels(gearbox: Gearbox) -> int:
    return n_monitored(gearbox.library) * gearbox.sizes.n_meshes


def monitored(gearbox: Gearbox, state: State) -> Floats:
    values = np.full(n_channels(gearbox), np.nan)
    arrays: Any = (state.y, state.integers, state.reals, values)
    gearbox._call("evl_gearbox_monitored", *map(_at, arrays))
    return values


def room(gearbox: Gearbox) -> Floats:
    return np.zeros(gearbox.sizes.n_cached)


def roots_and_monitored(
    gearbox: Gearbox, state: State, highest: Floats, cached: Floats
) -> tuple[Floats, Floats]:
    roots, values = np.empty(gearbox.sizes.n_roots), np.empty(n_channels(gearbox))
    before: Any = map(_at, (state.y, state.integers, state.reals))
    after: Any = map(_at, (highest, cached, roots, values))
    near = ctypes.c_double(NEAR)
    gearbox._call("evl_gearbox_roots_and_monitored", *before, near, *after)
    return roots, values


def walk(gearbox: Gearbox, duration: float, n: int) -> Iterator[tuple[State, Floats]]:
    """States of a motion, and the cached quantities of flanks: empty after each event."""
    state = gearbox.start(SPEEDS, [10.0, -10.0 * 20 / 35], gaps=[-3e-6])
    radau, cached, t = Radau(gearbox), room(gearbox), 0.0
    radau.start(state)
    while t < duration:
        outcome, fired = radau.advance(duration, state)
        while t < state.t:
            one = state.copy()
            one.t, one.y = t, radau.interpolate(t)
            yield one, cached
            t += duration / n
        if outcome == EVENT:
            state, _ = gearbox.apply_all(state, np.flatnonzero(fired))
            radau.restart(state)
            cached[:] = 0


def relieved(kernel: Kernel, shape: int) -> Gearbox:
    """Gears defined by a basic rack with reliefs at tip and root, and crowning."""
    wheels = [
        wheel(
            teeth=z,
            width=0.02,
            gear=gear_description(3e-3),
            deviation=deviations(
                tip_relief=relief(8e-6, diameter=tip, shape=shape),
                root_relief=relief(5e-6, diameter=root, shape=shape),
                profile_crowning=2e-6,
            ),
        )
        for z, tip, root in ((20, 0.0625, 0.0578), (35, 0.1075, 0.1025))
    ]
    pair = mesh(kernel, friction=(0.1, 1e-3))
    pair.pop("pressure_angle")
    return Gearbox(kernel, wheels, [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)], [pair])


def test_each_extreme_is_that_of_an_output_with_its_unit(kernel):
    gearbox = paper_gearbox(kernel)
    outputs = {entry.name: entry for entry in gearbox.table}
    entries = table(kernel)
    assert len({(entry.name, entry.is_largest) for entry in entries}) == len(entries)
    assert {entry.monitored for entry in entries} == set(range(n_monitored(kernel.library)))
    for entry in entries:
        assert entry.units == outputs[entry.name].units
        assert entry.symbol == outputs[entry.name].symbol
        assert outputs[entry.name].dims in (2, 8)  # of meshes, or of their tooth pairs
        assert entry.long_name


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
def test_monitored_outputs_are_the_outputs(kernel, make, mode):
    gearbox = make(kernel)
    state = in_mode(gearbox, np.random.default_rng(7), mode)
    values, reported = monitored(gearbox, state), gearbox.outputs(state)
    n_meshes = gearbox.sizes.n_meshes
    for name, number in names(kernel).items():
        expected = reported[name].reshape(n_meshes, -1).max(axis=1)
        mine = values.reshape(n_meshes, -1)[:, number]
        # the same formulas; the order of the force's sums may differ
        np.testing.assert_allclose(mine, expected, rtol=1e-13, err_msg=name)


@pytest.mark.parametrize("mode", MODES.values(), ids=MODES)
@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
def test_with_the_roots_come_the_same_roots_and_monitored_outputs_to_the_bit(kernel, make, mode):
    gearbox = make(kernel)
    state = in_mode(gearbox, np.random.default_rng(7), mode)
    highest = np.full(n_channels(gearbox), np.inf)  # flanks with deviations have estimates
    roots, values = roots_and_monitored(gearbox, state, highest, room(gearbox))
    np.testing.assert_array_equal(roots, gearbox.roots(state))
    np.testing.assert_array_equal(values, monitored(gearbox, state))


@pytest.mark.parametrize("shape", [LINEAR, PARABOLIC], ids=["linear", "parabolic"])
def test_pressures_are_estimated_only_where_far_below_what_is_known(kernel, shape):
    """At states as dense as IDA's, over a pitch and its events: all but the estimates are exact."""
    gearbox = relieved(kernel, shape)
    number, ratios = names(kernel)["pair_contact_pressure"], []
    for state, cached in walk(gearbox, 2 * np.pi / 20 / 10.0, 600):
        exact = monitored(gearbox, state)
        if not exact[number] > 0:
            continue
        limits = np.full(len(exact), -np.inf)
        for limit in (-np.inf, exact[number]):  # no estimate, and one that is too near
            limits[number] = limit
            values = roots_and_monitored(gearbox, state, limits, cached)[1]
            np.testing.assert_array_equal(values, exact)
        limits[number] = 2 * exact[number]
        values = roots_and_monitored(gearbox, state, limits, cached)[1]
        ratios.append(values[number] / exact[number])
        np.testing.assert_array_equal(np.delete(values, number), np.delete(exact, number))
    assert np.max(np.abs(np.array(ratios) - 1)) <= 5e-3  # as stated in the header
    assert np.mean(np.array(ratios) != 1) > 0.5  # the others are recomputed, or in flat parts


def candidates(radau: Radau, high: Floats, low: Floats) -> list[Candidate]:
    library = radau.gearbox.library
    found = []
    for index in range(library.evl_radau_look(radau.handle, _at(high), _at(low))):
        found.append(Candidate())
        library.evl_radau_candidate(radau.handle, index, ctypes.byref(found[-1]))
    return found


def check_look(radau: Radau, before: float, state: State) -> int:
    """Compare the candidates of a step with the channels at its states; return their number."""
    gearbox = radau.gearbox
    grid = [state.copy() for _ in range(41)]
    for one, t in zip(grid, np.linspace(before, state.t, 41), strict=True):
        one.t, one.y = t, radau.interpolate(t)
    values = np.array([monitored(gearbox, one) for one in grid])
    size, n = np.abs(values).max(axis=0), n_channels(gearbox)
    found = candidates(radau, np.full(n, -np.inf), np.full(n, np.inf))
    for one in found:
        assert before <= one.left <= one.t <= one.right <= state.t
        at = state.copy()
        at.y = radau.interpolate(one.t)
        channel = one.channel
        # the interpolant may differ from its channel by a hundredth of its range, and its values at
        # the nodes by Newton's last correction
        doubt = 0.01 * np.ptp(values[:, channel]) + 1e-5 * size[channel]
        assert abs(one.value - monitored(gearbox, at)[channel]) <= doubt
        heights = [one.sense * x.value for x in found if x.channel == channel]
        assert max(heights) >= (one.sense * values[:, channel]).max() - doubt
    assert candidates(radau, size * 10 + 1, -size * 10 - 1) == []
    return len(found)


def test_a_look_at_a_step_finds_the_extremes_of_its_states_and_none_within_wide_limits(kernel):
    looked = 0
    for seed in range(12):
        gearbox = chain(kernel, 4, CLOSED_FORM, sigma=-1)
        state = in_mode(gearbox, np.random.default_rng(seed), MODES["sliding"])
        radau = Radau(gearbox, max_step=1e-3)
        radau.start(state)
        for _ in range(6):
            before = state.t
            outcome, _ = radau.advance(before + 0.05, state)
            if state.t > before:
                looked += check_look(radau, before, state)
            if outcome == EVENT:
                break
    assert looked > 100
