"""Eight states at once give what each of them gives alone, for every law and every part."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import mpmath
import numpy as np
import pytest

from kernel.deviations import PARABOLIC, deviations, relief
from kernel.gearbox import LOADED, OPEN, UNLOADED, Gearbox, State
from kernel.gearbox_cases import chain, draw, in_mode, paper_gearbox, prescribed
from kernel.gearbox_description import (
    ALGEBRAIC,
    BEARING,
    CLOSED_FORM,
    SLIDER,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import CONTACT, DAMPING, FRICTION, OK, Floats, Kernel, _at
from kernel.shaft_cases import stirred, two_stages

LANES = 8
OUT_OF_DOMAIN = 2
OFF = 4

CONTACTS = {
    "johnson": {},
    "radzimovsky": {},
    "linear": {"stiffness": 1e8},
    "yang_lin": {},
    "power": {"coefficient": 1e12, "exponent": 1.5},
}
RESTITUTION = {"restitution": 0.5, "v0_min": 1e-2}
DAMPINGS = {
    "none": {},
    "linear": {"coefficient": 3e3},
    "one_sided": {"coefficient": 1e10},
    **dict.fromkeys(
        ("hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang"), RESTITUTION
    ),
}
FRICTIONS = {
    "none": {},
    "coulomb": {"coefficient": 0.2, "regularisation_velocity": 2e-3},
    "tanh": {"coefficient": 0.2, "regularisation_velocity": 2e-3},
    "stribeck": {
        "static_coefficient": 0.3,
        "kinetic_coefficient": 0.1,
        "stribeck_velocity": 0.02,
        "regularisation_velocity": 2e-3,
    },
}
LAWS = [
    *((contact, "flores", "coulomb") for contact in CONTACTS),
    *(("johnson", damping, "coulomb") for damping in DAMPINGS),
    *(("radzimovsky", "linear", friction) for friction in FRICTIONS),
]


def around(state: State, random: np.random.Generator, size: float = 1e-7) -> list[State]:
    """Eight states near one, at times of their own; the axles and wheels moved by about `size`."""
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


def check(gearbox: Gearbox, states: list[State]) -> None:
    """Compare rates and root functions of all states with those of each.

    The formulas are the same text; a compiler that keeps IEEE arithmetic gives the same bits. Four
    units in the last place of the result are for one that orders a sum in another way.
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
        assert np.all(np.abs(result - expected) <= 4 * np.spacing(np.abs(expected))), name


def pair_with_laws(kernel: Kernel, contact: str, damping: str, friction: str) -> Gearbox:
    """Two wheels on supports that move in all directions."""
    spring = {"support_stiffness": (1e8, 3e8), "support_damping": (2e4, 1e4)}
    wheels = [
        wheel(teeth=20, pitch_radius=0.1, support_kind=SLIDER, support_mass=2.0, **spring),
        wheel(teeth=33, support_kind=BEARING, support_mass=3.0, **spring),
    ]
    description = mesh(kernel, 0, 1, centre_line_angle=0.5, pressure_angle=0.35)
    description.contact = kernel.law(CONTACT, contact, **CONTACTS[contact])
    description.damping = kernel.law(DAMPING, damping, **DAMPINGS[damping])
    description.friction = kernel.law(FRICTION, friction, **FRICTIONS[friction])
    loads = [load(0, TORQUE, -7.0), load(1, VISCOUS, 5.0)]
    return Gearbox(kernel, wheels, loads, [description])


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


@pytest.mark.parametrize("sigma", [1, -1], ids=["clockwise", "counterclockwise"])
@pytest.mark.parametrize("n", [2, 3, 4])
def test_trains_with_every_support_and_table_agree(kernel: Kernel, n: int, sigma: int):
    """Tables are asked at the time of each lane."""
    gearbox = chain(kernel, n, CLOSED_FORM, sigma)
    random = np.random.default_rng(n)
    for _ in range(10):
        check(gearbox, around(in_mode(gearbox, random, (LOADED, 1)), random))


@pytest.mark.parametrize("sigma", [1, -1], ids=["clockwise", "counterclockwise"])
def test_a_prescribed_speed_agrees(kernel: Kernel, sigma: int):
    """The load that prescribes it brings the power that is missing."""
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


@pytest.mark.parametrize("rough", [False, True], ids=["perfect", "deviating"])
def test_real_gears_with_both_flanks_agree(kernel: Kernel, rough: bool):
    """Several tooth pairs on drive and coast flank; each kind of deviation, in every zone."""
    form = gear_description(3e-3)
    kinds = (
        deviations(
            tip_relief=relief(2e-5, diameter=0.0645, shape=PARABOLIC),
            profile_crowning=3e-6,
            runout_amount=1e-5,
        ),
        deviations(pitch_errors=list(1e-6 * np.random.default_rng(1).normal(size=35))),
    )
    support = {"support_kind": BEARING, "support_stiffness": (1e8, 3e8), "support_mass": 3.0}
    wheels = [
        wheel(teeth=z, width=0.02, gear=form, deviation=d if rough else deviations(), **support)
        for z, d in zip((20, 35), kinds, strict=True)
    ]
    description = mesh(kernel, 0, 1, friction=(0.1, 1e-3), has_backlash=True, backlash=2e-5)
    description.paper_rule = False
    gearbox = Gearbox(
        kernel, wheels, [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)], [description]
    )
    random = np.random.default_rng(3)
    per_contact = 5 if rough else 3
    loaded = 0
    for _ in range(20):
        state = gearbox.start()
        state.y[gearbox.place("reference_angle")] = draw(random, 0.02)
        state.y[gearbox.place("reference_speed")] = draw(random, 10.0)
        for contact in range(gearbox.sizes.n_reals):
            mode = state.integers[1 + per_contact * contact :][:per_contact]
            if mode[1] == OFF:
                continue
            mode[1:3] = LOADED, random.integers(-1, 2)
            mode[3:] = random.integers(-1, 2, size=per_contact - 3)
            loaded += 1
        check(gearbox, around(state, random, size=1e-6))
    assert loaded >= 60  # at least a pair on the drive flank and two on the coast flank


def test_axles_that_move_far_agree(kernel: Kernel):
    """The line of action turns by more than the series of its angle can bear."""
    gearbox = chain(kernel, 2, CLOSED_FORM)
    random = np.random.default_rng(4)
    state = in_mode(gearbox, random, (LOADED, 0), displacement=3e-3)
    check(gearbox, around(state, random))


def spoilt(kernel: Kernel, lane: int, name: str, change: float) -> tuple[Gearbox, list[State]]:
    """Eight good states of the paper's pair, one of them with a changed component."""
    gearbox = paper_gearbox(kernel, friction=0.3)
    random = np.random.default_rng(6)
    states = around(in_mode(gearbox, random, (LOADED, 0)), random)
    states[lane].y[gearbox.place(name)] += change
    return gearbox, states


@pytest.mark.parametrize("lane", range(LANES))
@pytest.mark.parametrize(
    ("name", "change"),
    [("angle_deviation_1", -0.6), ("angle_deviation_1", np.nan), ("displacement_1", -0.2)],
    ids=["past the law's limit", "not a number", "no line of action"],
)
def test_one_lane_without_an_answer_is_told(kernel: Kernel, lane: int, name: str, change: float):
    """And not hidden in a number."""
    gearbox, states = spoilt(kernel, lane, name, change)
    for call, rows in (
        ("lanes_rates", gearbox.sizes.n_states),
        ("lanes_roots", gearbox.sizes.n_roots),
    ):
        assert in_lanes(gearbox, call, rows, states)[0] == OUT_OF_DOMAIN


def test_what_the_lanes_do_not_serve_is_said(kernel: Kernel):
    """Tracked contact points and rigid flanks are for the scalar kernel."""
    served = kernel.library.lanes_serves
    assert served(paper_gearbox(kernel, tracking=ALGEBRAIC).handle) == 0
    rigid = kernel.law(CONTACT, "rigid", restitution=0.5, rest_velocity=1e-3)
    assert served(paper_gearbox(kernel, contact=rigid, damping=None).handle) == 0


def test_logarithm_is_right_to_one_unit_in_the_last_place(kernel: Kernel):
    """Over all normal numbers, and near 1, where ln x is small."""
    random = np.random.default_rng(7)
    x = np.concatenate(
        [
            np.exp(random.uniform(-708, 709, size=4000)),
            1 + random.normal(size=4000) * 10.0 ** random.uniform(-15, -1, size=4000),
            2.0 ** np.arange(-1022, 1024),
            [np.finfo(float).tiny, np.finfo(float).max, np.sqrt(0.5), np.sqrt(2.0), 1.0],
        ]
    )
    ln = np.empty_like(x)
    kernel.library.lanes_logarithm(ctypes.c_int(len(x)), _at(x), _at(ln))
    with mpmath.workdps(40):
        exact = [mpmath.log(mpmath.mpf(float(value))) for value in x]
        error = [abs(mpmath.mpf(float(value)) - e) for value, e in zip(ln, exact, strict=True)]
    unit = np.spacing(np.abs(np.array([float(e) for e in exact])))
    assert np.max(np.array([float(e) for e in error]) / unit) < 1
    assert ln[-1] == 0
