"""Equilibria of flanks with deviations: force balance, speeds that follow the slopes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from kernel.description import Block
from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import (
    DRIVE,
    INITIAL,
    LOAD,
    LOADED,
    UNLOADED,
    Gearbox,
    GearboxError,
    State,
)
from kernel.gearbox_description import (
    BEARING,
    EQUILIBRIUM,
    FIXED,
    SLIDER,
    SPEED,
    TABLE,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    shaft,
    wheel,
)
from kernel.gears import gear_description
from kernel.kernel import DAMPING, NO_SOLUTION, Kernel
from kernel.real_pairs import RealPair, Teeth

# The pinion of 19 teeth has its tip at 63 mm, its base circle at 53.6; the gear's tip is at 108.
PITCH = [1e-6 * ((5 * k * k + 3 * k) % 17) for k in range(34)]
NOTHING = (None, None)


def both(**fields: Any) -> tuple[Block, Block]:
    return deviations(**fields), deviations(**fields)


def tips(amount: float, shape: str) -> tuple[Block, Block]:
    return (
        deviations(tip_relief=relief(amount, diameter=0.0592, shape=shape)),
        deviations(tip_relief=relief(amount, diameter=0.1043, shape=shape)),
    )


def roots(amount: float, shape: str) -> tuple[Block, Block]:
    return (
        deviations(root_relief=relief(amount, roll_angle=np.radians(13), shape=shape)),
        deviations(root_relief=relief(amount, roll_angle=np.radians(17), shape=shape)),
    )


def classes(accuracy: int, seed: int) -> tuple[Block, Block]:
    return (
        deviations(accuracy_class=accuracy, seed=seed),
        deviations(accuracy_class=accuracy, seed=seed + 100),
    )


def everything(shape: str) -> tuple[Block, Block]:
    return (
        deviations(
            tip_relief=relief(12e-6, diameter=0.0592, shape=shape),
            root_relief=relief(6e-6, roll_angle=np.radians(13), shape=shape),
            profile_crowning=3e-6,
            runout_amount=7e-6,
            runout_phase=2.0,
        ),
        deviations(
            tip_relief=relief(9e-6, diameter=0.1043, shape=shape),
            profile_crowning=2e-6,
            pitch_errors=PITCH,
            runout_amount=11e-6,
            runout_phase=-0.7,
        ),
    )


KINDS: dict[str, tuple[Block | None, Block | None]] = {
    "linear tip relief": tips(12e-6, LINEAR),
    "parabolic tip relief": tips(12e-6, PARABOLIC),
    "deep linear tip relief": tips(60e-6, LINEAR),
    "linear root relief": roots(12e-6, LINEAR),
    "parabolic root relief": roots(12e-6, PARABOLIC),
    "crowning": both(profile_crowning=8e-6),
    "runout": both(runout_amount=20e-6, runout_phase=1.0),
    "pitch errors": (None, deviations(pitch_errors=PITCH)),
    "class 1": classes(1, 1),
    "class 5": classes(5, 3),
    "class 8": classes(8, 4),
    "class 11": classes(11, 6),
    "everything, linear": everything(LINEAR),
    "everything, parabolic": everything(PARABOLIC),
}
ALL_KINDS = pytest.mark.parametrize("kind", KINDS)
SENSES = pytest.mark.parametrize("sigma", [1, -1])


def pair_of(kind: str, sigma: int, *, fixed: bool) -> RealPair:
    """Backlash large enough for the coarse classes: no contact on the coast flanks."""
    return RealPair(deviations=KINDS[kind], sigma=sigma, chi=0.4, fixed=fixed, backlash=4e-4)


def loads_of(sigma: int, torque: float = 50.0, speed: float = 100.0) -> tuple[Any, Any]:
    """Torque on the pinion, with approximate speed."""
    ratio = 34 / 19
    return (
        load(0, TORQUE, -sigma * torque),
        load(1, VISCOUS, torque * ratio**2 / speed),
    )


def rates_of_speeds(gearbox: Gearbox, y: np.ndarray, state: State) -> np.ndarray:
    """Accelerations at positions and speeds, by the right-hand side."""
    moved = state.copy()
    moved.y[:] = y
    indices = [
        i
        for i, name in enumerate(gearbox.names)
        if name.startswith(("reference_speed", "speed_deviation")) or "_rate" in name
    ]
    return gearbox.derivative(moved)[indices]


def unit(gearbox: Gearbox, state: State) -> np.ndarray:
    """Accelerations of each speed by the loads alone."""
    o = gearbox.outputs(state)
    torque = abs(o["load_torque"]).max()
    units = [torque / o["inertia"].min()]  # of the reference speed
    for name in gearbox.names:
        if name.startswith("speed_deviation"):
            units.append(units[0])
        elif "_rate" in name:
            units.append(torque / o["base_radius"].min() / 5.0)  # at least 5 kg move
    return np.array(units)


def worst_acceleration(gearbox: Gearbox, state: State) -> float:
    return float((abs(rates_of_speeds(gearbox, state.y, state)) / unit(gearbox, state)).max())


# ---- balance and slopes


@ALL_KINDS
@SENSES
@pytest.mark.parametrize("fixed", [True, False])
def test_nothing_accelerates_at_the_start(kernel: Kernel, kind: str, sigma: int, fixed: bool):
    pair = pair_of(kind, sigma, fixed=fixed)
    gearbox = pair.gearbox(kernel, loads_of(sigma), friction=(0.05, 1e-2), damping=1e3)
    state = gearbox.start(EQUILIBRIUM)
    # Newton's method ends at rounding of its residual, 1e-12 of the loads
    assert worst_acceleration(gearbox, state) < 1e-10
    o = gearbox.outputs(state)
    assert (o["normal_force"] >= 0).all()
    assert o["normal_force"][0] > 0
    assert sigma * o["angular_velocity"][0] < 0
    np.testing.assert_array_equal(state.yp, gearbox.derivative(state))
    np.testing.assert_array_equal(state.reals, 0)


@pytest.mark.parametrize("kind", [kind for kind in KINDS if not kind.startswith("class")])
@SENSES
def test_the_forces_of_the_start_balance_the_loads_by_the_formulas(
    kernel: Kernel, kind: str, sigma: int
):
    """Tooth pairs, gaps, forces and lever arms with fifty digits, from the gap alone."""
    pair = pair_of(kind, sigma, fixed=True)
    gearbox = pair.gearbox(kernel, loads_of(sigma), damping=800.0)
    state = gearbox.start(EQUILIBRIUM)
    teeth = Teeth(pair, gearbox, state)
    torque = [mp.mpf(0), mp.mpf(0)]
    for contact in teeth.contacts:
        force = teeth.force(contact, 800.0) if contact.gap < 0 else None
        if force is None or force.normal < 0:
            continue
        for i in (0, 1):
            torque[i] += force.torques[i]
    for i, applied in enumerate(gearbox.outputs(state)["load_torque"]):
        # the kernel's contact point is accurate to 1e-11 of the penetration
        assert float(torque[i]) == pytest.approx(-applied, rel=1e-9)


def equilibrium(pair: RealPair, gearbox: Gearbox, state: State, theta: float) -> mp.mpf:
    """Change of the gear's angle for equal acceleration of gear and pinion, elastic forces alone.

    At another angle the slopes in the lever arms unbalance the loads: the train as a whole
    accelerates.
    """
    at = state.copy()
    at.y[gearbox.index("reference_angle")] = theta
    outputs = gearbox.outputs(state)
    applied, inertia = outputs["load_torque"], outputs["inertia"]
    start = Teeth(pair, gearbox, at)
    numbers = {c.number for c in Teeth(pair, gearbox, state).contacts if c.flank == DRIVE}
    ratio = mp.mpf(pair.teeth[0]) / pair.teeth[1]

    def excess(psi: mp.mpf) -> mp.mpf:
        teeth = Teeth(pair, gearbox, at)
        teeth.q[1] = start.q[1] + psi
        pressed = [c for c in teeth.contacts if c.gap < 0 and c.number in numbers]
        forces = [teeth.force(c) for c in pressed]
        a, b = ((mp.fsum(f.torques[i] for f in forces) + applied[i]) / inertia[i] for i in (0, 1))
        return b + ratio * a

    return mp.findroot(excess, (mp.mpf(0), mp.mpf(1e-9)), solver="secant", tol=1e-20)


@pytest.mark.parametrize("kind", ["deep linear tip relief", "crowning", "everything, parabolic"])
@SENSES
def test_speeds_follow_the_static_equilibrium(kernel: Kernel, kind: str, sigma: int):
    """The slope of psi(theta) by differences of equilibria found with fifty digits."""
    pair = pair_of(kind, sigma, fixed=True)
    gearbox = pair.gearbox(kernel, loads_of(sigma), damping=None)
    state = gearbox.start(EQUILIBRIUM)
    assert float(equilibrium(pair, gearbox, state, 0.0)) == pytest.approx(0, abs=1e-14)
    step = 1e-6  # of an angle over which slopes change by 1 in 1e-1
    ends = [equilibrium(pair, gearbox, state, s * step) for s in (1, -1)]
    slope = float(ends[0] - ends[1]) / (2 * step)
    found = state.y[gearbox.index("speed_deviation_1")]
    assert abs(slope) > 1e-5
    assert found == pytest.approx(slope * state.y[gearbox.index("reference_speed")], rel=1e-6)


@ALL_KINDS
@SENSES
@pytest.mark.parametrize("fixed", [True, False])
def test_nothing_accelerates_a_moment_later_either(
    kernel: Kernel, kind: str, sigma: int, fixed: bool
):
    """Along the start's own speeds the accelerations change only in second order.

    Without damping: its forces are not part of the static equilibrium that the speeds follow.
    """
    pair = pair_of(kind, sigma, fixed=fixed)
    gearbox = pair.gearbox(kernel, loads_of(sigma), friction=0.0, damping=None)
    state = gearbox.start(EQUILIBRIUM)
    free = [i for i, name in enumerate(gearbox.names) if "rate" not in name and "speed" not in name]
    velocity = np.zeros_like(state.y)
    velocity[free] = gearbox.derivative(state)[free]
    still = np.zeros_like(velocity)
    still[0] = velocity[0]
    step = 1e-9  # [s], 1e-7 rad
    keep = slice(1, None)  # the loads determine the speed of the whole train

    def change(rates: np.ndarray) -> float:
        ends = [rates_of_speeds(gearbox, state.y + s * step * rates, state) for s in (1, -1)]
        return float((abs(ends[0] - ends[1])[keep] / unit(gearbox, state)[keep]).max())

    # the remainder: dampers of the supports, which act at their speeds but not on the path there
    assert change(velocity) < 1e-3 * change(still) + 1e-12


# ---- trains, supports, laws


def train(
    kernel: Kernel, stages: int, sigma: int, seed: int, elastic: bool | None = None, **fields: Any
) -> Gearbox:
    """One pair, or two on an elastic or a rigid shaft; every deviation, wheels on bearings."""
    supports = [
        {"support_kind": FIXED},
        {"support_kind": BEARING, "support_stiffness": (3e8, 2e8), "support_damping": (3e3, 2e3)},
        {"support_kind": SLIDER, "support_stiffness": (2e8, 0), "support_damping": (2e3, 0)},
        {"support_kind": BEARING, "support_stiffness": (1e9, 1e9), "support_damping": (1e4, 1e4)},
    ]
    shape = (LINEAR, PARABOLIC)[seed % 2]
    wheels, meshes = [], []
    for stage in range(stages):
        for i, z in enumerate((20, 31)):
            tip = 3e-3 * (z + 2)
            wheels.append(
                wheel(
                    teeth=z,
                    width=0.02,
                    gear=gear_description(3e-3),
                    axial_position=0.1 * stage,
                    deviation=deviations(
                        tip_relief=relief((8 + 3 * i) * 1e-6, diameter=tip - 3e-3, shape=shape),
                        accuracy_class=4 + seed % 4,
                        seed=17 * seed + 2 * stage + i,
                        runout_amount=3e-6,
                        runout_phase=1.0 + i,
                        profile_crowning=2e-6,
                    ),
                    **supports[(2 * stage + i + seed) % 4],
                )
            )
        description = mesh(
            kernel,
            2 * stage,
            2 * stage + 1,
            driving_rotation=-sigma * (-1) ** stage,
            centre_line_angle=0.3 + stage,
            backlash=2e-4,
            **fields,
        )
        description.pop("pressure_angle")
        meshes.append(description)
    wheels[0].centre = (0.0, 0.0)
    shafts = [] if elastic is None else [shaft(1, 2, 2e5 if elastic else None, 3.0)]
    loads = [
        load(0, TORQUE, -40.0 * sigma),
        load(2 * stages - 1, VISCOUS, 40.0 * (31 / 20) ** (2 * stages) / 80.0),
    ]
    return Gearbox(kernel, wheels, loads, meshes, shafts=shafts)


TRAINS = {"a pair": (1, None), "a rigid shaft": (2, False), "an elastic shaft": (2, True)}
LAWS = {
    "none": None,
    "linear": ("linear", 2e3),
    "one-sided": ("one_sided", 1e9),
}


@pytest.mark.parametrize("form", TRAINS)
@pytest.mark.parametrize("law", LAWS)
@SENSES
@pytest.mark.parametrize("seed", range(3))
def test_trains_on_moving_axles_have_a_steady_start(
    kernel: Kernel, form: str, law: str, sigma: int, seed: int
):
    stages, elastic = TRAINS[form]
    fields = {"damping": LAWS[law], "friction": (0.06, 5e-3)}
    gearbox = train(kernel, stages, sigma, seed, elastic, **fields)
    state = gearbox.start(EQUILIBRIUM)
    assert worst_acceleration(gearbox, state) < 1e-9  # soft supports: rounding of the residual
    assert (gearbox.outputs(state)["normal_force"] > 0).all()


@pytest.mark.parametrize("seed", range(20))
@SENSES
def test_every_seed_of_a_class_has_a_steady_start(kernel: Kernel, seed: int, sigma: int):
    pair = RealPair(
        deviations=classes(3 + seed % 7, seed), sigma=sigma, fixed=True, backlash=4e-4, chi=-1.0
    )
    gearbox = pair.gearbox(kernel, loads_of(sigma, 5.0 + 20.0 * seed), damping=500.0)
    assert worst_acceleration(gearbox, gearbox.start(EQUILIBRIUM)) < 1e-10


# two pairs at the start: the gear's speed is prescribed, so it is exactly at the entry of pair 0
WIDE = {"teeth": (31, 40), "fixed": True, "backlash": 4e-4, "reference": 1}


def pressed(pair: RealPair, gearbox: Gearbox, state: State) -> list[int]:
    """Numbers of the overlapping tooth pairs, by the formulas."""
    return [c.number for c in Teeth(pair, gearbox, state).contacts if c.gap < 0]


@pytest.mark.parametrize(("error", "numbers"), [(0.0, [-1, 0]), (1e-4, [-1]), (-1e-4, [0])])
def test_pairs_that_pitch_errors_hold_open_stay_open(
    kernel: Kernel, error: float, numbers: list[int]
):
    """An error of the gear's tooth 0: that of the entering pair."""
    pair = RealPair(**WIDE, deviations=(None, deviations(pitch_errors=[error] + 39 * [0.0])))
    gearbox = pair.gearbox(kernel, (load(0, TORQUE, -50.0),))
    state = gearbox.start(EQUILIBRIUM, mesh_position=0.005)
    assert sorted(pressed(pair, gearbox, state)) == numbers
    assert worst_acceleration(gearbox, state) < 1e-10


def test_a_pair_whose_damper_would_pull_carries_nothing(kernel: Kernel):
    """One of two pairs separates, and its damper is stronger than its flank."""
    given = (deviations(tip_relief=relief(30e-6, diameter=0.0915, shape=LINEAR)), None)
    pair = RealPair(**WIDE, deviations=given)
    modes = []
    for damping in (1e2, 3e7):
        gearbox = pair.gearbox(kernel, (load(0, TORQUE, -1000.0),), damping=damping)
        state = gearbox.start(EQUILIBRIUM, mesh_position=0.005)
        assert sorted(pressed(pair, gearbox, state)) == [-1, 0]
        found = [gearbox.mode(state, m) for m in range(pair.slots)]
        modes.append({int(mode[0]): int(mode[1]) for mode in found})
        assert worst_acceleration(gearbox, state) < 1e-10
    assert (modes[0][-1], modes[0][0]) == (LOADED, LOADED)
    assert (modes[1][-1], modes[1][0]) == (UNLOADED, LOADED)


# ---- rejected input


def refusal(gearbox: Gearbox) -> GearboxError:
    with pytest.raises(GearboxError) as caught:
        gearbox.start(EQUILIBRIUM)
    assert caught.value.code == NO_SOLUTION
    assert "\n" not in caught.value.message
    return caught.value


def test_a_damper_that_carries_more_than_the_load_leaves_the_static_positions(kernel: Kernel):
    """A damper of 1e12 N s/m leaves no equilibrium: positions and speeds are those without it."""
    pair = pair_of("everything, parabolic", 1, fixed=True)
    strong, none = (
        pair.gearbox(kernel, loads_of(1), damping=damping).start(EQUILIBRIUM)
        for damping in (1e12, None)
    )
    np.testing.assert_allclose(strong.y[:4], none.y[:4], rtol=1e-12, atol=1e-18)


Loads = Callable[[int], list[Any]]
WRONG: dict[str, tuple[Loads, int, str]] = {
    "a torque on the driving wheel": (
        lambda s: [load(0, TORQUE, 50.0 * s), load(1, VISCOUS, 2.0)],
        *(0, "its torque {50} N m"),
    ),
    "a torque on the driven wheel": (
        lambda s: [load(0, SPEED, -100.0 * s), load(1, TORQUE, 80.0 * s)],
        *(1, "its torque {80} N m"),
    ),
    "a table": (
        lambda s: [
            load(0, SPEED, -100.0 * s),
            load(1, TABLE, table=[(0.0, 60.0 * s), (1.0, 60.0 * s)]),
        ],
        *(1, "its torque {60} N m"),
    ),
    "the larger of two": (
        lambda s: [
            load(0, TORQUE, 5.0 * s),
            load(0, TORQUE, 50.0 * s),
            load(1, VISCOUS, 2.0),
        ],
        *(1, "its torque {50} N m"),
    ),
    "a speed": (
        lambda s: [load(1, VISCOUS, 2.0), load(0, SPEED, 90.0 * s)],
        *(1, "the prescribed speed {90} rad/s"),
    ),
}


@pytest.mark.parametrize("kind", ["perfect", "everything, linear"])
@pytest.mark.parametrize("case", WRONG)
@SENSES
def test_a_load_of_the_wrong_sense_is_named(kernel: Kernel, kind: str, case: str, sigma: int):
    loads, index, words = WRONG[case]
    given = KINDS.get(kind, NOTHING)
    pair = RealPair(deviations=given, sigma=sigma, fixed=True, backlash=4e-4)
    error = refusal(pair.gearbox(kernel, tuple(loads(sigma))))
    field = "torque" if case == "a table" else "value"
    assert (error.subject, error.index, error.field) == (LOAD, index, field)
    value = words.split("{")[1].split("}")[0]
    signed = value if sigma > 0 else f"-{value}"
    assert words.replace("{" + value + "}", signed) in error.message
    assert "it opens the drive flanks of meshes.0" in error.message


def test_a_wrong_sense_is_found_through_a_train(kernel: Kernel):
    """The second stage is driven by a reversed torque on its own shaft."""
    gearbox = train(kernel, 2, 1, 0, elastic=True)
    assert gearbox.start(EQUILIBRIUM)
    wheels = [
        wheel(teeth=z, width=0.02, gear=gear_description(3e-3), axial_position=0.1 * (i // 2))
        for i, z in enumerate((20, 31, 20, 31))
    ]
    wheels[0].centre = (0.0, 0.0)
    meshes = []
    for stage in range(2):
        description = mesh(
            kernel, 2 * stage, 2 * stage + 1, driving_rotation=-1 + 2 * stage, backlash=2e-4
        )
        description.pop("pressure_angle")
        meshes.append(description)
    loads = [load(0, SPEED, -100.0), load(2, TORQUE, 500.0), load(3, VISCOUS, 1.0)]
    error = refusal(Gearbox(kernel, wheels, loads, meshes, shafts=[shaft(1, 2)]))
    assert (error.subject, error.index) == (LOAD, 1)
    assert "its torque 500 N m" in error.message
    assert "meshes.0" in error.message


def test_wheels_that_run_idle_touch_without_force(kernel: Kernel):
    gearbox = RealPair(fixed=True).gearbox(kernel, (load(0, SPEED, -100.0),))
    o = gearbox.outputs(gearbox.start(EQUILIBRIUM))
    assert o["normal_force"][0] == pytest.approx(0, abs=1e-9)
    assert o["gap"][0] == pytest.approx(0, abs=1e-15)


def test_idle_flanks_that_deviate_have_no_slope_to_follow(kernel: Kernel):
    pair = pair_of("everything, linear", 1, fixed=True)
    error = refusal(pair.gearbox(kernel, (load(0, SPEED, -100.0),)))
    assert (error.subject, error.field) == (INITIAL, "kind")
    assert "no load presses" in error.message


def test_crowned_flanks_that_part_have_a_steady_start(kernel: Kernel):
    """Beyond the middle crowned flanks would separate at 10 mm/s, if wheels did not follow."""
    for restitution in (0.3, 0.8):
        law = kernel.law(DAMPING, "hunt_crossley", restitution=restitution, v0_min=1e-3)
        wheels = [
            wheel(
                teeth=z,
                width=0.02,
                gear=gear_description(3e-3),
                deviation=deviations(profile_crowning=crowning),
            )
            for z, crowning in ((20, 1e-5), (35, 0.0))
        ]
        wheels[0].centre = (0.0, 0.0)
        description = mesh(kernel, backlash=2e-4)
        description.pop("pressure_angle")
        description.damping = law
        loads = [load(0, SPEED, -500.0), load(1, TORQUE, -1.0)]
        gearbox = Gearbox(kernel, wheels, loads, [description])
        assert worst_acceleration(gearbox, gearbox.start(EQUILIBRIUM)) < 1e-10


def test_a_steady_start_without_a_speed_is_still_refused_for_that(kernel: Kernel):
    error = refusal(pair_of("crowning", 1, fixed=True).gearbox(kernel, (load(0, TORQUE, -1.0),)))
    assert (error.subject, error.field) == (INITIAL, "kind")
    assert "the steady speed is not determined" in error.message
