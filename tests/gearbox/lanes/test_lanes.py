"""Eight states in lanes have the results of single states, for every law and every component."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest

from gearbox.lanes.lane_cases import (
    CONTACTS,
    DAMPINGS,
    DEVIATIONS,
    FRICTIONS,
    LAWS,
    internal_pair_with_laws,
    loaded_pair,
    pair_with_laws,
    real_gears,
    real_state,
)
from kernel import description
from kernel.deviations import deviations
from kernel.gearbox import LOADED, OPEN, UNLOADED, Gearbox, GearboxError, State
from kernel.gearbox_cases import chain, in_mode, paper_gearbox, prescribed
from kernel.gearbox_description import ALGEBRAIC, CLOSED_FORM
from kernel.kernel import CONTACT, DAMPING, FRICTION, OK, Floats, Kernel, _at
from kernel.shaft_cases import stirred, two_stages
from load_samples import SAMPLES

LANES = 8
OUT_OF_DOMAIN = 2


def around(state: State, random: np.random.Generator, size: float = 1e-7) -> list[State]:
    """Eight states near one, at different times; axes and wheels displaced by about `size`."""
    states = []
    for lane in range(LANES):
        near = state.copy()
        near.t += 1e-3 * lane
        near.y *= 1 + 1e-3 * random.normal(size=len(near.y))
        near.y[2:] += size * random.normal(size=len(near.y) - 2)
        states.append(near)
    return states


def in_lanes(gearbox: Gearbox, name: str, rows: int, states: list[State]) -> tuple[int, Floats]:
    """Code and result of a lane-wise call, (lane, row)."""
    t = np.array([state.t for state in states])
    y = np.array([state.y for state in states]).T.copy()
    result = np.full((rows, LANES), np.nan)
    arrays = (y, states[0].integers, states[0].reals, result)
    first = (1, _at(t)) if name == "lanes_rates" else ()
    code = getattr(gearbox.library, name)(gearbox.handle, *first, *map(_at, arrays))
    return code, result.T


def root_by_root(gearbox: Gearbox, state: State) -> Floats:
    """Root functions of a state, each evaluated separately."""
    result = np.full(gearbox.sizes.n_roots, np.nan)
    arrays = (state.y, state.integers, state.reals, result)
    assert gearbox.library.lanes_root_by_root(gearbox.handle, *map(_at, arrays)) == OK
    return result


def check_idle(gearbox: Gearbox, state: State, roots: Floats) -> None:
    """Root functions excluded from the search are 1, and the others change with the state.

    Roots are (lane, root). The last one, of the revolutions, is 1 up to rounding for small theta.
    """
    live = np.empty(gearbox.sizes.n_roots, np.int32)
    gearbox.library.lanes_roots_live(gearbox.handle, _at(state.integers), _at(live))
    assert live[-1] == 1
    np.testing.assert_array_equal(live[:-1] == 0, np.all(roots[:, :-1] == 1, axis=0))


def check_nearby(gearbox: Gearbox, states: list[State], roots: Floats) -> None:
    """Root functions evaluated from the rates at `states`: there, and at displaced states.

    For overlapping flanks they are those of the rates, otherwise those of the displaced states.
    """
    for size in (0.0, 1e-6):
        moved = [state.copy() for state in states]
        for state in moved:
            state.y *= 1 + size
        code, exact = in_lanes(gearbox, "lanes_roots", gearbox.sizes.n_roots, moved)
        assert code == OK
        t = np.array([state.t for state in states])
        before, after = (np.array([s.y for s in them]).T.copy() for them in (states, moved))
        result = np.full(exact.T.shape, np.nan)
        arrays = (t, before, after, states[0].integers, states[0].reals, result)
        assert gearbox.library.lanes_roots_nearby(gearbox.handle, *map(_at, arrays)) == OK
        # a function of the ends of the path has a part from each
        assert np.all(abs(result.T - exact) <= 1.01 * abs(exact - roots).max(axis=0) + 1e-12 * size)


def check(gearbox: Gearbox, states: list[State]) -> None:
    """Compare all results of eight states in lanes."""
    roots = check_bits(gearbox, states)
    check_outputs(gearbox, states)
    check_idle(gearbox, states[0], roots)
    check_nearby(gearbox, states, roots)


def check_outputs(gearbox: Gearbox, states: list[State]) -> None:
    """Compare all outputs of eight states with those of each, bit by bit, with signs of zeros."""
    reported = np.array([gearbox.values(state) for state in states])
    sampled = gearbox.sampled(states)
    np.testing.assert_array_equal(sampled, reported)
    assert np.all((np.signbit(sampled) == np.signbit(reported)) | np.isnan(reported))


def check_bits(gearbox: Gearbox, states: list[State]) -> Floats:
    """Compare rates and root functions of all states with those of each, bit by bit.

    Return the root functions.

    The formulas have the same source, and the compiler keeps to IEEE arithmetic: it neither
    contracts nor reorders.
    """
    calls: list[tuple[str, int, Callable[[State], Floats]]] = [
        ("lanes_rates", gearbox.sizes.n_states, gearbox.derivative),
        ("lanes_roots", gearbox.sizes.n_roots, gearbox.roots),
    ]
    assert gearbox.library.lanes_count() == LANES
    assert gearbox.library.lanes_serves(gearbox.handle) == 1
    for name, rows, alone in calls:
        code, result = in_lanes(gearbox, name, rows, states)
        assert code == OK
        expected = np.array([alone(state) for state in states])
        assert np.all(np.isfinite(expected))
        np.testing.assert_array_equal(result, expected, err_msg=name)
    np.testing.assert_array_equal(root_by_root(gearbox, states[0]), gearbox.roots(states[0]))
    return result


@pytest.mark.parametrize(
    ("family", "cases"), [(CONTACT, CONTACTS), (DAMPING, DAMPINGS), (FRICTION, FRICTIONS)]
)
def test_every_law_is_compared_here(
    kernel: Kernel, family: int, cases: dict[str, dict[str, float]]
):
    """All laws of the table except rigid contact, which has no force law."""
    names = {info.name for info in kernel.laws(family)} - {"rigid"}
    assert names == set(cases)


@pytest.mark.parametrize("mode", [OPEN, LOADED, UNLOADED], ids=["open", "loaded", "unloaded"])
@pytest.mark.parametrize(("contact", "damping", "friction"), LAWS)
def test_every_law_gives_in_lanes_what_it_gives_alone(
    kernel: Kernel, contact: str, damping: str, friction: str, mode: int
):
    """In each mode, on each branch of the friction law."""
    gearbox = pair_with_laws(kernel, contact, damping, friction)
    random = np.random.default_rng(5)
    for branch in (-1, 0, 1) if mode == LOADED else (0,):
        for _ in range(5):
            check(gearbox, around(in_mode(gearbox, random, (mode, branch)), random))


@pytest.mark.parametrize(("contact", "damping", "friction"), LAWS)
def test_every_law_agrees_in_a_ring(kernel: Kernel, contact: str, damping: str, friction: str):
    """The laws of an internal pair see it as an external one, alone and in lanes."""
    gearbox = internal_pair_with_laws(kernel, contact, damping, friction)
    random = np.random.default_rng(6)
    loaded = 0
    for _ in range(6):
        state, pairs = real_state(gearbox, random)
        loaded += pairs
        check(gearbox, around(state, random, size=1e-6))
    assert loaded >= 18


def integrated(gearbox: Gearbox) -> Floats:
    """States of the first 50 ms by radau, (output, state)."""
    library, state, scale = gearbox.library, gearbox.start(), gearbox.scales()[0]
    radau = library.evl_radau_create(gearbox.handle, scale, 1e-6, 1e-3, None)
    outputs = np.full((20, len(scale)), np.nan)
    at = map(_at, (state.y, state.integers, state.reals))
    duration = ctypes.c_double(0.05)
    code = library.lanes_integrate(gearbox.handle, radau, *at, duration, len(outputs), _at(outputs))
    library.evl_radau_delete(ctypes.byref(radau))
    assert code == OK
    return outputs


@pytest.mark.parametrize(("contact", "damping", "friction"), LAWS)
def test_a_law_without_a_loop_is_as_right_in_both_integrators(
    kernel: Kernel, contact: str, damping: str, friction: str
):
    """Lanes and radau evaluate it state by state, to the same bits; IDA's residual has no loop."""
    gearbox, bare = (pair_with_laws(kernel, contact, damping, friction) for _ in range(2))
    bare.library.lanes_strip_laws(bare.handle)
    random = np.random.default_rng(11)
    for mode in (LOADED, UNLOADED):
        states = around(in_mode(gearbox, random, (mode, 0)), random)
        check(bare, states)
        for name, rows in (
            ("lanes_rates", gearbox.sizes.n_states),
            ("lanes_roots", gearbox.sizes.n_roots),
        ):
            (code, result), (_, expected) = (
                in_lanes(which, name, rows, states) for which in (bare, gearbox)
            )
            assert code == OK
            np.testing.assert_array_equal(result, expected)
        for state in states:
            np.testing.assert_array_equal(bare.residual(state), gearbox.residual(state))
    np.testing.assert_array_equal(integrated(bare), integrated(gearbox))


@pytest.mark.parametrize("sigma", [1, -1], ids=["clockwise", "counterclockwise"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_trains_with_every_support_and_table_agree(kernel: Kernel, n: int, sigma: int):
    """Tables are evaluated at the time of each lane."""
    gearbox = chain(kernel, n, CLOSED_FORM, sigma=sigma)
    random = np.random.default_rng(n)
    for _ in range(10):
        check(gearbox, around(in_mode(gearbox, random, (LOADED, 1)), random))


@pytest.mark.parametrize("sigma", [1, -1], ids=["clockwise", "counterclockwise"])
def test_a_prescribed_speed_agrees(kernel: Kernel, sigma: int):
    """The load that prescribes the speed supplies the missing power."""
    gearbox = prescribed(kernel, CLOSED_FORM, sigma)
    random = np.random.default_rng(8)
    for _ in range(10):
        check(gearbox, around(in_mode(gearbox, random, (LOADED, 0)), random))


@pytest.mark.parametrize("driven_by", ["torque", "motor"])
@pytest.mark.parametrize("middle", [3e4, None], ids=["elastic", "rigid"])
def test_shafts_and_rotors_agree(kernel: Kernel, middle: float | None, driven_by: str):
    """Elastic shafts carry torque, rigid ones make rotors."""
    gearbox = two_stages(kernel, middle=middle, driven_by=driven_by)
    random = np.random.default_rng(9)
    for _ in range(10):
        check(gearbox, around(stirred(gearbox, random), random))


@pytest.mark.parametrize("name", SAMPLES)
def test_every_load_agrees(kernel: Kernel, name: str):
    """Before the first knot of a table, between knots, after the last; after many revolutions."""
    gearbox = loaded_pair(kernel, name)
    is_driven = "angle_deviation_0" in gearbox.names  # the second wheel is the reference
    random = np.random.default_rng(10)
    for segment in range(4):
        state = in_mode(gearbox, random, (LOADED, 0))
        turns = (0, 1, -7, 1234)[segment]
        state.integers[0] += turns
        state.integers[1] += turns * (33 if is_driven else -20)
        gearbox.put(state, "knots_passed", segment)
        check(gearbox, around(state, random))


@pytest.mark.parametrize("fixed", [False, True], ids=["moving axles", "fixed axles"])
@pytest.mark.parametrize("name", DEVIATIONS)
def test_real_gears_with_both_flanks_agree(kernel: Kernel, name: str, fixed: bool):
    """Several tooth pairs on drive and coast flank, with each deviation in every zone."""
    gearbox = real_gears(kernel, name, fixed=fixed)
    random = np.random.default_rng(3)
    loaded = 0
    for _ in range(12):
        state, pairs = real_state(gearbox, random)
        loaded += pairs
        check(gearbox, around(state, random, size=1e-6))
    assert loaded >= 36  # at least a pair on the drive flank and two on the coast flank


def test_every_kind_of_deviation_is_compared_here(kernel: Kernel):
    """Rows without a case would be missed: all that need a module except the gear's form and
    its inspection.

    Compliance is compared in test_compliant_flanks, flank by flank.
    """
    of_form = {
        *("pressure_angle", "profile_shift", "rack", "tip_diameter", "tip_alteration"),
        *("tip_rounding", "thickness_allowance", "bore", "compliance"),
        *("span_teeth", "ball_diameter", "internal", "fillet", "rim_diameter"),
    }
    described = [deviations(**fields) for pair in DEVIATIONS.values() for fields in pair]
    table = description.rows(kernel.library)
    selected = [row for row in table if row.block == "wheel" and row.variants == "+module"]
    selected = [row for row in selected if row.key not in of_form]
    assert {row.key for row in selected} == {key for wheel in described for key in wheel}
    for block in {row.holds for row in selected} - {""}:
        holders = {row.key for row in selected if row.holds == block}
        given = {key for wheel in described for name in holders & {*wheel} for key in wheel[name]}
        assert given == {row.key for row in table if row.block == block}


def test_axles_that_move_far_agree(kernel: Kernel):
    """The line of action rotates beyond the range of the series of its angle."""
    gearbox = chain(kernel, 2, CLOSED_FORM)
    random = np.random.default_rng(4)
    state = in_mode(gearbox, random, (LOADED, 0), displacement=3e-3)
    check(gearbox, around(state, random))


def spoilt(
    kernel: Kernel, lane: int, name: str, change: float, law: str = "johnson"
) -> tuple[Gearbox, list[State]]:
    """Eight valid states of the paper's pair, one of them with a changed component."""
    contact = kernel.law(CONTACT, law, **CONTACTS[law])
    gearbox = paper_gearbox(kernel, friction=0.3, contact=contact)
    random = np.random.default_rng(6)
    states = around(in_mode(gearbox, random, (LOADED, 0)), random)
    states[lane].y[gearbox.index(name)] += change
    return gearbox, states


@pytest.mark.parametrize("lane", range(LANES))
@pytest.mark.parametrize(
    ("name", "change"),
    [("angle_deviation_1", -0.6), ("angle_deviation_1", np.nan), ("displacement_1", -0.2)],
    ids=["past the law's limit", "not a number", "no line of action"],
)
def test_one_lane_without_an_answer_is_told(kernel: Kernel, lane: int, name: str, change: float):
    """And is not hidden in a value; the seven other states have their values."""
    gearbox, states = spoilt(kernel, lane, name, change)
    with pytest.raises(GearboxError) as refused:
        gearbox.derivative(states[lane])
    assert refused.value.code == OUT_OF_DOMAIN
    for other in range(LANES):
        if other != lane:
            assert np.isfinite(gearbox.derivative(states[other])).all()
    for call, rows in (
        ("lanes_rates", gearbox.sizes.n_states),
        ("lanes_roots", gearbox.sizes.n_roots),
    ):
        assert in_lanes(gearbox, call, rows, states)[0] == OUT_OF_DOMAIN


@pytest.mark.parametrize("law", CONTACTS)
def test_no_law_hides_what_is_no_number(kernel: Kernel, law: str):
    """Nor does a law without its own limits."""
    gearbox, states = spoilt(kernel, 3, "angle_deviation_1", np.nan, law)
    assert in_lanes(gearbox, "lanes_rates", gearbox.sizes.n_states, states)[0] == OUT_OF_DOMAIN
    states[3] = states[2].copy()
    code, rates = in_lanes(gearbox, "lanes_rates", gearbox.sizes.n_states, states)
    assert code == OK
    np.testing.assert_array_equal(rates[2], gearbox.derivative(states[2]))


def test_what_the_lanes_do_not_serve_is_said(kernel: Kernel):
    """Tracked contact points and rigid flanks are evaluated by the scalar kernel."""
    served = kernel.library.lanes_serves
    assert served(paper_gearbox(kernel, tracking=ALGEBRAIC).handle) == 0
    rigid = kernel.law(CONTACT, "rigid", restitution=0.5, rest_velocity=1e-3)
    assert served(paper_gearbox(kernel, contact=rigid, damping=None).handle) == 0
