"""Outputs requested one by one, at one state or at eight, equal those of the whole table."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearbox.lanes.lane_cases import loaded_pair, real_gears, real_state
from kernel.description import Block
from kernel.gearbox import APART, LOADED, OPEN, Gearbox, GearboxError, State
from kernel.gearbox_cases import chain, in_mode, paper_gearbox, set_gap
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM, DIFFERENTIAL
from kernel.housing_cases import HOUSINGS
from kernel.kernel import OUT_OF_DOMAIN, Kernel
from kernel.real_cases import GAPS, PAIRS, made
from kernel.rigid_cases import rigid_train
from kernel.shaft_cases import stirred, two_stages

Case = tuple[Gearbox, State]
SEED = 11


def trained(kernel: Kernel, tracking: str, mode: tuple[int, int]) -> Case:
    gearbox = chain(kernel, 4, tracking)
    return gearbox, in_mode(gearbox, np.random.default_rng(SEED), mode)


def real(kernel: Kernel, pair: str, gap: str) -> Case:
    gearbox, teeth = made(kernel, PAIRS[pair], GAPS[gap], SEED)
    return gearbox, teeth.state


def shafts(
    kernel: Kernel,
    of: Block | None,
    middle: float | None,
    driven_by: str,
    *,
    against_housing: bool = False,
) -> Case:
    gearbox = two_stages(
        kernel, middle=middle, driven_by=driven_by, housing=of, against_housing=against_housing
    )
    return gearbox, stirred(gearbox, np.random.default_rng(SEED))


def rigid(kernel: Kernel) -> Case:
    gearbox = rigid_train(kernel)
    return gearbox, gearbox.start()


def with_loss(kernel: Kernel) -> Case:
    gearbox = loaded_pair(kernel, "loss")
    return gearbox, in_mode(gearbox, np.random.default_rng(SEED), (LOADED, 0))


def with_temperatures(kernel: Kernel) -> Case:
    gearbox = real_gears(kernel, "all of them", fixed=True, with_temperatures=True)
    state, loaded = real_state(gearbox, np.random.default_rng(SEED))
    assert loaded > 0
    return gearbox, state


TRACKINGS = {"closed form": CLOSED_FORM, "algebraic": ALGEBRAIC, "differential": DIFFERENTIAL}
MODES = {"sliding": (LOADED, 1), "open": (OPEN, 0), "apart": (APART, 0)}
CASES: dict[str, Callable[[Kernel], Case]] = {
    **{
        f"{tracking}, {mode}": lambda kernel, t=TRACKINGS[tracking], m=MODES[mode]: trained(
            kernel, t, m
        )
        for tracking in TRACKINGS
        for mode in MODES
        if (tracking, mode) != ("closed form", "apart")
    },
    **{
        f"{pair}, {gap}": lambda kernel, pair=pair, gap=gap: real(kernel, pair, gap)
        for pair in ("standard", "contact lost", "every deviation")
        for gap in GAPS
    },
    "shafts": lambda kernel: shafts(kernel, None, 3e4, "torque"),
    "rigid shaft, prescribed speed": lambda kernel: shafts(kernel, None, None, "gear"),
    "speed prescribed against the housing, by the last wheel": lambda kernel: shafts(
        kernel, None, 3e4, "drum", against_housing=True
    ),
    **{
        f"housing, {name}": lambda kernel, of=of: shafts(kernel, of, None, "torque")
        for name, of in HOUSINGS.items()
    },
    "rigid contact": rigid,
    "load-independent loss": with_loss,
    "temperatures": with_temperatures,
}
EVERY_CASE = pytest.mark.parametrize("make", CASES.values(), ids=CASES)


def names(gearbox: Gearbox) -> list[str]:
    return [entry.name.decode() for entry in gearbox.table]


def near(gearbox: Gearbox, state: State, n: int) -> list[State]:
    """States with one discrete state, as within a step."""
    random = np.random.default_rng(SEED)
    states = []
    for i in range(n):
        one = state.copy()
        one.t += 1e-9 * i
        one.y *= 1 + 1e-12 * i * random.uniform(-1, 1, gearbox.sizes.n_states)
        states.append(one)
    return states


@EVERY_CASE
def test_each_output_asked_for_alone_is_that_of_the_whole_table_to_the_bit(kernel, make):
    gearbox, state = make(kernel)
    reported = gearbox.values(state)
    for entry in gearbox.table:
        here = slice(entry.offset, entry.offset + entry.count)
        name = entry.name.decode()
        mine = gearbox.sampled([state], name)
        np.testing.assert_array_equal(mine[0], reported[here], err_msg=name)


@EVERY_CASE
def test_some_states_are_each_state_to_the_bit(kernel, make):
    """Five do not fill the lanes; an output may be requested twice."""
    gearbox, state = make(kernel)
    states = near(gearbox, state, 5)
    reported = np.array([gearbox.values(one) for one in states])
    twice = [*names(gearbox), *names(gearbox)]
    np.testing.assert_array_equal(gearbox.sampled(states, *twice), np.hstack([reported, reported]))


@EVERY_CASE
def test_eight_states_at_once_tell_what_one_tells_to_the_bit(kernel, make):
    """Each output separately, and all together; `tests/gearbox/lanes` covers all laws."""
    gearbox, state = make(kernel)
    states = near(gearbox, state, 8)
    reported = np.array([gearbox.values(one) for one in states])
    for entry in gearbox.table:
        here = slice(entry.offset, entry.offset + entry.count)
        name = entry.name.decode()
        np.testing.assert_array_equal(
            gearbox.sampled(states, name), reported[:, here], err_msg=name
        )
    np.testing.assert_array_equal(gearbox.sampled(states), reported)


@EVERY_CASE
def test_of_eight_states_those_that_fill_the_room_change_nothing(kernel, make):
    """The first three have the same values as with other states after them."""
    gearbox, state = make(kernel)
    states = near(gearbox, state, 8)
    filled = [*states[:3], *[states[2]] * 5]
    for name in ("potential_energy", "gap", "pair_friction_force", "teeth", "contact_point_driven"):
        mine = gearbox.sampled(filled, name, n=3)[:3]
        np.testing.assert_array_equal(mine, gearbox.sampled(states, name)[:3], err_msg=name)


def test_the_cases_tell_every_output_of_the_table(kernel):
    reported = set()
    for make in CASES.values():
        gearbox, _ = make(kernel)
        reported |= {entry.name for entry in gearbox.table if entry.count > 0}
    on_request = {b"root_stress_max", b"root_stress_min"}  # evl_gearbox_add_root_outputs
    assert reported == {entry.name for entry in gearbox.table} - on_request


def test_what_only_other_outputs_need_is_not_computed(kernel):
    """Outside the domain of the law the angles are available, the forces are not."""
    gearbox = paper_gearbox(kernel)
    state = in_mode(gearbox, np.random.default_rng(SEED), (LOADED, 1))
    set_gap(gearbox, state, 0, -0.2)
    known = ("teeth", "angle", "centre_velocity", "load_work")
    assert np.isfinite(gearbox.sampled([state], *known)).all()
    with pytest.raises(GearboxError) as caught:
        gearbox.sampled([state], *known, "normal_force")
    assert caught.value.code == OUT_OF_DOMAIN
