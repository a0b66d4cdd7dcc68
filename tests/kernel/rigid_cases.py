"""Gearboxes with rigid contact, and an independent model of impacts on their bodies."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from kernel.gearbox import (
    OPEN,
    Event,
    EventRecord,
    Gearbox,
    GearboxError,
    State,
    event_names,
)
from kernel.gearbox_cases import draw, face, wheels_of_meshes
from kernel.gearbox_description import BEARING, CLOSED_FORM, mesh, wheel
from kernel.kernel import CONTACT, OK, Kernel, Status

KNEE = 1e-3
FRICTION = (0.3, KNEE)


def rigid(kernel: Kernel, restitution: float = 0.0, rest_velocity: float = 1e-6) -> dict[str, Any]:
    """Fields of a mesh with rigid contact."""
    law = kernel.law(CONTACT, "rigid", restitution=restitution, rest_velocity=rest_velocity)
    return {"contact": law, "damping": None}


def rigid_train(
    kernel: Kernel,
    n: int = 3,
    tracking: str = CLOSED_FORM,
    sigma: int = 1,
    restitutions: tuple[float | None, ...] = (0.0, 0.0),
    outer_drive: bool = False,
    loads: tuple[Any, ...] = (),
    friction: Any = FRICTION,
    rest_velocity: float = 1e-6,
) -> Gearbox:
    """Train of wheels that differ in all parameters, on bearings; restitution None: elastic.

    `outer_drive`: both neighbours drive the wheel in the middle in the same direction.
    """
    teeth = (20, 33, 27, 24)[:n]
    wheels = [
        wheel(
            teeth=z,
            pitch_radius=0.005 * z,
            width=0.02 + 0.01 * i,
            centre=(0.0, 0.0) if i == 0 else None,
            support_kind=BEARING,
            support_mass=2.0 + i,
            support_stiffness=(1e8, 3e8),
            support_damping=(2e4, 1e4),
        )
        for i, z in enumerate(teeth)
    ]
    meshes = []
    for m in range(n - 1):
        back = outer_drive and m == 1
        fields = {"damping": 3e3}
        if restitutions[m] is not None:
            fields = rigid(kernel, restitutions[m], rest_velocity)
        meshes.append(
            mesh(
                kernel,
                *((m + 1, m) if back else (m, m + 1)),
                driving_rotation=-sigma if outer_drive else -sigma * (-1) ** m,
                centre_line_angle=0.5 - 1.1 * m + (np.pi if back else 0.0),
                pressure_angle=0.35,
                friction=friction,
                tracking=tracking,
                **fields,
            )
        )
    return Gearbox(kernel, wheels, loads, meshes)


# ---- dynamics written down once more: bodies, the gap's rate, the force of a mesh


class Bodies:
    """Speeds as one vector (omega of every wheel, then x and y of every axis) and their masses."""

    def __init__(self, gearbox: Gearbox, support_masses: list[float]) -> None:
        self.gearbox = gearbox
        self.n = gearbox.sizes.n_wheels
        geometry = [gearbox.wheel_geometry(i) for i in range(self.n)]
        moving = [g.mass + s for g, s in zip(geometry, support_masses, strict=True)]
        self.masses = np.array([g.inertia for g in geometry] + list(np.repeat(moving, 2)))

    def speeds(self, state: State) -> np.ndarray:
        """All speeds."""
        values = self.gearbox.outputs(state)
        return np.concatenate([values["angular_velocity"], values["centre_velocity"].ravel()])

    def directions(self, m: int, factor: float, state: State) -> tuple[np.ndarray, np.ndarray]:
        """Gradient of the gap's rate, and the generalised force of a unit normal force.

        `factor`: friction over normal force, along t on the driving wheel; axes at their reference
        positions.
        """
        values, geometry = self.gearbox.outputs(state), self.gearbox.mesh_geometry(m)
        a = wheels_of_meshes(self.gearbox, state, "driving")[m]
        b = wheels_of_meshes(self.gearbox, state, "driven")[m]
        chi, alpha = geometry.centre_line_angle, geometry.working_pressure_angle
        sigma = geometry.sigma
        t = np.array([np.cos(chi + sigma * alpha), np.sin(chi + sigma * alpha)])
        e = sigma * np.array([t[1], -t[0]])
        radii = [self.gearbox.wheel_geometry(i).base_radius for i in (a, b)]
        arms = [values[f"friction_arm_{side}"][m] for side in ("driving", "driven")]
        gap, force = np.zeros(3 * self.n), np.zeros(3 * self.n)
        for wheel_, radius, arm, sign in zip((a, b), radii, arms, (1, -1), strict=True):
            axle = slice(self.n + 2 * wheel_, self.n + 2 * wheel_ + 2)
            gap[wheel_] = sigma * radius
            gap[axle] = -sign * e
            force[wheel_] = sigma * (radius + factor * arm)
            force[axle] = sign * (-e + factor * t)
        return gap, force

    def energy(self, state: State) -> float:
        """Kinetic energy."""
        return float(self.masses @ self.speeds(state) ** 2 / 2)


def friction_of(gearbox: Gearbox, state: State, m: int = 0, f: float = FRICTION[0]) -> float:
    """Friction over normal force for the sliding velocity."""
    return float(-f * np.clip(gearbox.outputs(state)["sliding_velocity"][m] / KNEE, -1, 1))


def approaching(gearbox: Gearbox, random: np.random.Generator, sizes: list[float]) -> State:
    """Flanks in contact; the gap of mesh m closes at sizes[m], all other motion is random."""
    n = gearbox.sizes.n_wheels
    state = gearbox.start()
    for i, name in enumerate(gearbox.names):
        if name.startswith("displacement") and "_rate" in name:
            state.y[i] = draw(random, 1e-3)
    state.y[gearbox.index("reference_speed")] = draw(random, 0.5)
    for m, size in enumerate(sizes):  # a train: wheel m + 1 closes the gap of mesh m
        turning = m + 1 if f"speed_deviation_{m + 1}" in gearbox.names else m
        sigma = gearbox.mesh_geometry(m).sigma
        rate = gearbox.outputs(state)["gap_rate"][m]
        index = gearbox.index(f"speed_deviation_{turning}")
        state.y[index] -= sigma * (rate + size) / gearbox.wheel_geometry(turning).base_radius
    for m in range(n - 1):
        gearbox.mode(state, m)[1:] = OPEN, 0
        gearbox.mode(state, m)[0] = 0
    face(gearbox, state)
    return state


def fire(gearbox: Gearbox, state: State, roots: np.ndarray) -> tuple[State, list[Event]]:
    """Apply an event at which several roots fired, also of several meshes."""
    after = state.copy()
    events = (EventRecord * (gearbox.sizes.n_events))()
    n_events, status = ctypes.c_int(-1), Status()
    fired = roots.astype(np.int32)
    arrays = (after.y, after.yp, after.integers, after.reals)
    code = gearbox.library.evl_gearbox_apply_event(
        gearbox.handle,
        ctypes.c_double(state.t),
        fired.ctypes.data_as(ctypes.c_void_p),
        ctypes.c_bool(False),
        *(array.ctypes.data_as(ctypes.c_void_p) for array in arrays),
        events,
        ctypes.byref(n_events),
        ctypes.byref(status),
    )
    assert code == OK, status.message
    names = event_names(gearbox.kernel)
    happened = events[: n_events.value]
    return after, [Event(names[e.kind], e.mesh, e.tooth_pair) for e in happened]


def close(gearbox: Gearbox, state: State, *meshes: int) -> tuple[State, list[Event]]:
    """Close the contacts of these meshes simultaneously."""
    roots = np.zeros(gearbox.sizes.n_roots)
    for m in meshes:
        roots[gearbox.root_indices[m, "contact"]] = 1
    return fire(gearbox, state, roots)


def refusal(make: Callable[[], Any]) -> GearboxError:
    """Return the error of a call that the kernel rejects."""
    with pytest.raises(GearboxError) as refused:
        make()
    return refused.value
