"""Gearboxes of the tests, and states of them."""

from __future__ import annotations

from typing import Any

import numpy as np

from kernel.gearbox import APART, LOADED, OPEN, Gearbox, State
from kernel.gearbox_description import (
    BEARING,
    FIXED,
    SLIDER,
    SPEED,
    TABLE,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    wheel,
)
from kernel.housing import Pair
from kernel.kernel import Kernel

PAIRS = {
    "paper": Pair(),
    "mirrored": Pair(sigma=-1),
    "tilted": Pair(teeth=(23, 41), pitch_radius=0.115, chi=2.1, centre=(0.3, -0.7)),
    "tilted and mirrored": Pair(teeth=(31, 17), pitch_radius=0.05, chi=-2.8, sigma=-1),
    "pressure angle given": Pair(alpha_w=0.35, chi=0.6, poisson=(0.2, 0.4)),
    "driven wheel is the reference": Pair(chi=-1.1, sigma=-1, reference=1),
}


def paper_gearbox(kernel: Kernel, **fields: Any) -> Gearbox:
    """Create the paper's virtual setup as in examples/paper.yaml; fields of the mesh."""
    slider = {
        **{"support_kind": SLIDER, "support_mass": 10.0},
        **{"support_stiffness": (1e9, 0.0), "support_damping": (1e5, 0.0)},
    }
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, centre=(0.0, 0.0)),
        wheel(teeth=30, **slider),
    ]
    loads = [load(0, TORQUE, -1.0), load(1, VISCOUS, 10.0)]
    return Gearbox(kernel, wheels, loads, [mesh(kernel, **fields)])


def chain(kernel: Kernel, n: int, *tracking: str, sigma: int = 1, closed: bool = False) -> Gearbox:
    """Train of n wheels with every support and every load but a prescribed speed.

    The wheels differ in all parameters; `closed`: the last one meshes with the first, a ring. If
    several tracking options are given, the first is that of mesh 0, the second of mesh 1, ...
    """
    teeth = (20, 33, 27, 20)[:n]
    radii = [0.005 * z for z in teeth]
    supports = [
        {"support_kind": SLIDER, "support_direction": 0.4},
        {"support_kind": BEARING},
        {"support_kind": FIXED},
        {"support_kind": SLIDER, "support_direction": -1.9},
    ]
    wheels = [
        wheel(
            teeth=teeth[i],
            pitch_radius=radii[i],
            width=0.02 + 0.01 * i,
            youngs_modulus=(2e11, 1.1e11, 7e10, 2e11)[i],
            poisson_ratio=(0.3, 0.25, 0.33, 0.3)[i],
            support_mass=2.0 + i,
            support_stiffness=(1e8, 3e8),
            support_damping=(2e4, 1e4),
            **supports[i],
        )
        for i in range(n)
    ]
    if closed:  # a kite: its corners follow from the four sides
        a, b = radii[0] + radii[1], radii[1] + radii[2]
        d, c = radii[3] + radii[0], radii[2] + radii[3]
        diagonal = 0.7 * (a + b)
        for i, (x, y) in enumerate(
            [(0, 0), _apex(a, b, diagonal, 1), (diagonal, 0), _apex(d, c, diagonal, -1)]
        ):
            wheels[i].centre = (x, y)
    loads = [
        load(0, TORQUE, -7.0 * sigma),
        load(0, VISCOUS, 0.3),
        load(n - 1, VISCOUS, 5.0),
        load(n - 1, TABLE, table=[(0.0, 1.0), (0.5, -2.0), (2.0, 4.0)]),
    ]
    meshes = []
    for m in range(n if closed else n - 1):
        a, b = m, (m + 1) % n
        angle = None if closed else 0.5 - 1.1 * m
        rotation = -sigma * (-1) ** m
        meshes.append(
            mesh(
                kernel,
                a,
                b,
                driving_rotation=rotation,
                centre_line_angle=angle,
                pressure_angle=0.35,
                friction=(0.2, 2e-3),
                damping=(3e3, ("one_sided", 1e10), None, 1e3)[m],
                tracking=tracking[m % len(tracking)],
            )
        )
    return Gearbox(kernel, wheels, loads, meshes)


def _apex(a: float, b: float, base: float, side: int) -> tuple[float, float]:
    """Corner of a triangle over `base` with the sides a and b."""
    x = (a**2 - b**2 + base**2) / (2 * base)
    return x, side * float(np.sqrt(a**2 - x**2))


def prescribed(kernel: Kernel, tracking: str, sigma: int = 1) -> Gearbox:
    """Pair with a variable speed of the driven and a torque table on the driving wheel."""
    wheels = [
        wheel(teeth=20, pitch_radius=0.2, support_kind=BEARING, support_stiffness=(1e9, 5e8)),
        wheel(teeth=30),
    ]
    loads = [
        load(0, TABLE, table=[(0.0, -20.0 * sigma), (1.0, -10.0 * sigma)]),
        load(1, SPEED, table=[(0.0, 0.0), (0.2, 2.0 * sigma), (3.0, 5.0 * sigma)]),
    ]
    description = mesh(
        kernel,
        driving_rotation=-sigma,
        centre_line_angle=2.0,
        friction=(0.1, 1e-3),
        tracking=tracking,
    )
    return Gearbox(kernel, wheels, loads, [description])


def worst(error: Any, tolerance: Any) -> float:
    """Return the largest ratio of an error to its tolerance; at most 1 on success."""
    error, tolerance = np.broadcast_arrays(
        np.abs(np.asarray(error, float)), np.asarray(tolerance, float)
    )
    return float(np.max(np.where(error > 0, error / np.where(tolerance > 0, tolerance, 1e-300), 0)))


def draw(random: np.random.Generator, size: float) -> float:
    """Return a random number of either sign with a magnitude from size/100 to size."""
    return float(size * 10.0 ** random.uniform(-2, 0) * random.choice([-1, 1]))


def face(gearbox: Gearbox, state: State) -> None:
    """Set the tracked points to opposite positions at the wheels' positions, by the closed form."""
    for m in range(gearbox.sizes.n_meshes):
        if f"turn_{m}" not in gearbox.names:
            continue
        near = state.copy()
        gearbox.mode(near, m)[1] = APART
        near, _ = gearbox.apply(near, "apart", contact=m)
        state.y[gearbox.tracked(m)] = near.y[gearbox.tracked(m)]


def set_gap(gearbox: Gearbox, state: State, m: int, gap: float) -> None:
    """Turn the driven wheel of mesh m, or else the driving one, until the gap is `gap`."""
    driving = wheels_of_meshes(gearbox, state, "driving")[m]
    driven = wheels_of_meshes(gearbox, state, "driven")[m]
    turning = driven if f"angle_deviation_{driven}" in gearbox.names else driving
    arc = gearbox.mesh_geometry(m).sigma * gearbox.wheel_geometry(turning).base_radius
    face(gearbox, state)
    now = gearbox.outputs(state)["gap"][m]
    state.y[gearbox.index(f"angle_deviation_{turning}")] += (gap - now) / arc
    face(gearbox, state)


def scatter(
    gearbox: Gearbox,
    random: np.random.Generator,
    displacement: float = 1e-6,
    speed: float = 3.0,
    gap: float = 1e-6,
    share: tuple[float, float] = (0.1, 0.9),
) -> State:
    """Random state on the path of contact, some pitches ahead or back, with moving axes.

    The gap of every mesh is of magnitude `gap`, of either sign; the mode is OPEN in any case.
    `share` of its path has passed in the first mesh: near the ends a radius of curvature is small.
    """
    sizes = gearbox.sizes
    state = State(
        float(random.uniform(0.6, 1.5)),  # in the last segment of the tables of `chain`
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_states),
        np.zeros(sizes.n_integers, np.int32),
        np.full(sizes.n_reals, 0.01),
    )
    gearbox.put(state, "knots_passed", 2 if sizes.n_wheels > 2 else 1)
    gearbox.put(state, "side", 1)
    state.integers[0] = random.integers(-3, 3)
    first = gearbox.wheel_geometry(0)
    sense = -gearbox.mesh_geometry().sigma  # in which wheel 0 drives
    phi = sense * (random.integers(-30, 30) + random.uniform(*share)) * first.angular_pitch
    theta = phi / first.speed_ratio
    state.integers[0] += int(theta / (2 * np.pi))
    state.y[gearbox.index("reference_angle")] = np.fmod(theta, 2 * np.pi)
    state.y[gearbox.index("reference_speed")] = draw(random, speed)
    for i, name in enumerate(gearbox.names):
        if name.startswith("displacement"):
            state.y[i] = draw(random, displacement * (100 if "rate" in name else 1))
        if name.startswith("speed_deviation"):
            state.y[i] = draw(random, 1e-4)
    theta = state.y[gearbox.index("reference_angle")] + 2 * np.pi * state.integers[0]
    for m, driving in enumerate(wheels_of_meshes(gearbox, state, "driving")):
        wheel = gearbox.wheel_geometry(driving)
        moved = -gearbox.mesh_geometry(m).sigma * wheel.speed_ratio * theta / wheel.angular_pitch
        gearbox.mode(state, m)[:] = np.floor(moved), OPEN, 0
    for m in range(sizes.n_meshes):
        set_gap(gearbox, state, m, draw(random, gap))
    return state


def wheels_of_meshes(gearbox: Gearbox, state: State, role: str) -> list[int]:
    """Return the driving or the driven wheel of every mesh."""
    return [int(i) for i in gearbox.outputs(state)[f"{role}_wheel"]]


def press(
    gearbox: Gearbox, state: State, m: int = 0, mode: int = LOADED, friction: int = 0
) -> None:
    """Set a contact mode and a friction branch of a mesh, independently of the state."""
    gearbox.mode(state, m)[1:] = mode, friction
    for index, (contact, name) in gearbox.sides.items():
        if contact == m and name != "side":
            state.integers[index] = 0  # to be set from the state by `take_sides`


def branch(gearbox: Gearbox, state: State, m: int = 0, knee: float = 1e-3) -> int:
    """Branch of a Coulomb law for the sliding velocity of a mesh; knee: limit of the branch 0."""
    v_t = gearbox.outputs(state)["sliding_velocity"][m]
    return 0 if abs(v_t) <= knee else int(np.sign(v_t))


def in_mode(
    gearbox: Gearbox,
    random: np.random.Generator,
    mode: tuple[int, int],
    size: float = 1e-6,
    **options: Any,
) -> State:
    """State with every mesh in a contact mode and on a friction branch, with a consistent gap.

    In a ring the last gap follows from the others; there the mesh is open if the gap is positive.
    The options are those of `scatter`.
    """
    state = scatter(gearbox, random, **options)
    n = gearbox.sizes.n_meshes
    for m in range(n):
        gap = abs(draw(random, size))
        if m < gearbox.sizes.n_wheels - 1:
            set_gap(gearbox, state, m, gap if mode[0] == OPEN else -gap)
    gaps = gearbox.outputs(state)["gap"]
    for m in range(n):
        press(gearbox, state, m, *(mode if gaps[m] < 0 else (OPEN, 0)))
    state.yp = gearbox.derivative(state)
    return state


def moved(gearbox: Gearbox, after: State, before: State) -> float:
    """Return the state change of an event that preserves positions and speeds, over its tolerance.

    More than 1 is an error: tracked points are projected onto (1), which moves them by the rounding
    of the lengths in (1), 1e-13 of these; all other values are bitwise unchanged.
    """
    tolerance = np.zeros(len(before.y))
    r_b = max(gearbox.wheel_geometry(i).base_radius for i in range(gearbox.sizes.n_wheels))
    arms = {"angle_deviation": r_b, "displacement": 1.0, "zeta": 1.0, "dr": 1.0}
    length = 1e-13 * max(
        arm * abs(value)
        for name, value in zip(gearbox.names, before.y, strict=True)
        for start, arm in arms.items()
        if name.startswith(start) and "rate" not in name
    )
    for m in range(gearbox.sizes.n_meshes):
        if f"turn_{m}" in gearbox.names and gearbox.mode(before, m)[1] != APART:
            rho = gearbox.mesh_geometry(m).rho_start_driving
            angle = max(length / rho, 1e-16)
            tolerance[gearbox.tracked(m)] = [angle, *(3 * [length]), 1e-13, r_b * length]
    return worst(after.y - before.y, tolerance)
