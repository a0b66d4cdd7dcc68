"""Forces, penetrations and elastic energy just before and after every event of a run."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from kernel.description import Block
from kernel.deviations import LINEAR, PARABOLIC, deviations, relief
from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import BEARING, SPEEDS, TORQUE, load, mesh, wheel
from kernel.gears import gear_description
from kernel.kernel import Floats, Kernel
from kernel.radau import EVENT, Radau

MODULE, E = 3e-3, 2.06e11
SPEED = 157.0  # of the driving wheel [rad/s]
ELEMENTS = Block(model="finite_elements")


class Teeth(NamedTuple):
    """Teeth, profile shifts, bores [m] and diameters at the start of tip relief [m]."""

    z: tuple[int, int]
    shift: tuple[float, float]
    bore: tuple[float, float]
    relieved_from: tuple[float, float]


FIFTY = Teeth((50, 50), (0.0, 0.0), (40e-3, 40e-3), (153.5e-3, 153.5e-3))
SPUR = Teeth((19, 34), (0.4, 0.1), (25e-3, 40e-3), (62.5e-3, 105.5e-3))
BORDER = "profile_border"
SMOOTH = "where c bends"  # the integrator stops there, without an event
EDGES = {"edge_closed", "edge_opened", "edge_left_flank", "flank_reached"}
# where the load stops on an edge, its foot point reverses: the torque on the edge's wheel jumps
STEPS = {"edge_left_flank", "flank_reached", BORDER}
# teeth, further keys of wheels and mesh, initial gap of the flanks [m]; required events
CASES: dict[str, tuple[Teeth, dict[str, Any], float, set[str]]] = {
    "50/50": (FIFTY, {}, -8e-6, EDGES),
    "19/34": (SPUR, {}, -6e-6, EDGES),
    "50/50 relieved": (FIFTY, {"shape": LINEAR}, -8e-6, {*EDGES, BORDER}),
    "19/34 relieved": (SPUR, {"shape": PARABOLIC}, -6e-6, {*EDGES, BORDER}),
    "50/50 rounded": (FIFTY, {"tip_rounding": 3e-4}, -8e-6, EDGES),
    "19/34 relieved and rounded": (
        *(SPUR, {"shape": LINEAR, "tip_rounding": 2e-4}, -6e-6),
        {*EDGES, BORDER},
    ),
    "50/50 on a moving axle": (FIFTY, {"moves": True}, -8e-6, EDGES),
    "50/50 relieved on a moving axle": (
        *(FIFTY, {"shape": LINEAR, "moves": True}, -8e-6),
        {*EDGES, BORDER},
    ),
    "19/34 that bounces": (SPUR, {}, 1e-5, {*EDGES, "contact_closed", "contact_opened"}),
    "50/50 that bounces, uncoupled": (
        *(FIFTY, {"tooth_coupling": "false"}, 1e-5),
        {*EDGES, "contact_closed", "contact_opened"},
    ),
}


def pair(
    kernel: Kernel,
    teeth: Teeth,
    *,
    shape: str = "",
    tip_rounding: float = 0.0,
    moves: bool = False,
    **fields: Any,
) -> Gearbox:
    """Two compliant gears at 150 N/mm, undamped."""
    support = {"support_kind": BEARING, "support_stiffness": (1e8, 3e8), "support_mass": 3.0}
    wheels = [
        wheel(
            teeth=teeth.z[i],
            width=20e-3,
            youngs_modulus=E,
            gear={
                **gear_description(
                    MODULE,
                    profile_shift=teeth.shift[i],
                    bore=teeth.bore[i],
                    tip_rounding=tip_rounding,
                ),
                "compliance": ELEMENTS,
            },
            deviation=deviations(
                **(
                    {"tip_relief": relief(3e-6, diameter=teeth.relieved_from[i], shape=shape)}
                    if shape
                    else {}
                )
            ),
            **(support if moves and i else {}),
        )
        for i in (0, 1)
    ]
    torques = [-3000 * MODULE * z / 2 * np.cos(np.radians(20)) for z in teeth.z]
    loads = [load(i, TORQUE, torque) for i, torque in enumerate(torques)]
    description = mesh(kernel, 0, 1, backlash=5e-5, damping=None, friction=(0.0, 1e-3), **fields)
    description.pop("pressure_angle")
    return Gearbox(kernel, wheels, loads, [description])


class Sides(NamedTuple):
    """Compared quantities: of pairs by their number; torques on both wheels."""

    force: dict[int, float]
    penetration: dict[int, float]
    energy: float
    torque: Floats


def sides(gearbox: Gearbox, state: State) -> Sides:
    o = gearbox.outputs(state)
    names = ("pair_number", "pair_normal_force", "pair_penetration", "pair_contact_mode")
    drive = gearbox.sizes.n_reals // 2  # no contact on the coast flanks here
    number, force, h, mode = (np.asarray(o[name][0][:drive]) for name in names)
    here = mode != 4  # off the path
    return Sides(
        dict(zip(number[here].tolist(), force[here].tolist(), strict=True)),
        dict(zip(number[here].tolist(), h[here].tolist(), strict=True)),
        float(o["potential_energy"][0]),
        np.array([o["mesh_torque_driving"][0], o["mesh_torque_driven"][0]]),
    )


def largest_jump(before: dict[int, float], after: dict[int, float]) -> float:
    """Largest change of a pair's value; entering and leaving pairs have no force."""
    pairs = before.keys() | after.keys()
    return max(abs(before.get(k, 0.0) - after.get(k, 0.0)) for k in pairs)


@pytest.mark.parametrize(("teeth", "has", "gap", "expected"), CASES.values(), ids=CASES)
def test_nothing_jumps_at_any_event_of_a_run(
    kernel: Kernel, teeth: Teeth, has: dict[str, Any], gap: float, expected: set[str]
) -> None:
    """Over some pitches; a root function is offset by 1e-10, the permitted change."""
    gearbox = pair(kernel, teeth, **has)
    speeds = [-SPEED, SPEED * teeth.z[0] / teeth.z[1]]
    state = gearbox.start(SPEEDS, speeds, [gap])
    integrator = Radau(gearbox, tolerance=1e-8)
    integrator.start(state)
    end = 6 * 2 * np.pi / teeth.z[0] / SPEED
    seen: set[str] = set()
    jumps: dict[str, Floats] = {}
    largest = np.zeros(4)
    while state.t < end:
        outcome, fired = integrator.advance(end, state)
        here = sides(gearbox, state)
        both = here.force.values(), here.penetration.values()
        scale = [*(max(map(abs, x), default=0.0) for x in both), here.energy]
        largest = np.maximum(largest, [*scale, np.abs(here.torque).max()])
        if outcome != EVENT:
            continue
        after, events = gearbox.apply_all(state, np.flatnonzero(fired).tolist())
        there = sides(gearbox, after)
        stays = here.penetration.keys() & there.penetration.keys()
        jump = np.array(
            [
                largest_jump(here.force, there.force),
                max(abs(here.penetration[k] - there.penetration[k]) for k in stays),
                abs(here.energy - there.energy),
                np.abs(here.torque - there.torque).max(),
            ]
        )
        for kind in [event.name for event in events] or [SMOOTH]:
            seen.add(kind)
            jumps[kind] = np.maximum(jumps.get(kind, np.zeros(4)), jump)
        state = after
        integrator.restart(state)
    assert {*expected, SMOOTH} <= seen
    for kind, jump in jumps.items():
        relative = jump / largest
        assert relative[:3].max() < 1e-9, kind
        assert relative[3] < (3e-4 if kind in STEPS else 1e-9), kind
