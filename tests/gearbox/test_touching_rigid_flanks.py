"""Simultaneous contact of rigid flanks: Newton's laws determine which of them close."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from kernel.gearbox import LOADED, OPEN, Gearbox, State
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.kernel import Kernel
from kernel.rigid_cases import rigid

MESHES = 4


def row_of_wheels(
    kernel: Kernel,
    inertias: np.ndarray,
    torques: np.ndarray,
    *,
    friction: tuple[float, float] | float = 0.0,
    **law: float,
) -> Gearbox:
    """Wheels in a row on fixed axes, each with its own torque."""
    wheels = [
        wheel(
            teeth=20 + i,
            pitch_radius=0.01 * (20 + i),
            inertia=inertia,
            centre=(0.0, 0.0) if i == 0 else None,
        )
        for i, inertia in enumerate(inertias)
    ]
    meshes = [
        mesh(
            kernel,
            *(m, m + 1),
            driving_rotation=-((-1) ** m),
            centre_line_angle=0.5,
            pressure_angle=0.35,
            friction=friction,
            **rigid(kernel, **law),
        )
        for m in range(len(inertias) - 1)
    ]
    loads = [load(i, TORQUE, torque) for i, torque in enumerate(torques)]
    return Gearbox(kernel, wheels, loads, meshes)


def gap_directions(gearbox: Gearbox) -> np.ndarray:
    """Rate of each gap per speed of each wheel [mesh, wheel]."""
    n = gearbox.sizes.n_wheels
    directions = np.zeros((n - 1, n))
    for m in range(n - 1):
        for i in (m, m + 1):
            sign = gearbox.mesh_geometry(m).sigma
            directions[m, i] = sign * gearbox.wheel_geometry(i).base_radius
    return directions


def closed_by_law(gearbox: Gearbox, inertias: np.ndarray, torques: np.ndarray):
    """The unique normal forces F >= 0 with gap'' = k + R F >= 0 that are 0 where the gap opens."""
    n = len(inertias) - 1
    directions = gap_directions(gearbox)
    k = directions @ (torques / inertias)
    response = directions / inertias @ directions.T
    for some in product([False, True], repeat=n):
        closed = np.array(some)
        force = np.zeros(n)
        force[closed] = -np.linalg.solve(response[np.ix_(closed, closed)], k[closed])
        gap = k + response @ force
        if (force[closed] > 0).all() and (gap[~closed] > 0).all():
            return closed, force
    raise AssertionError("R is positive definite: there is one")


@pytest.mark.parametrize("seed", range(300))
def test_of_flanks_that_touch_those_are_closed_that_push(kernel: Kernel, seed: int):
    random = np.random.default_rng(seed)
    inertias = 10.0 ** random.uniform(-2, 2, MESHES + 1)
    torques = random.normal(size=MESHES + 1) * inertias ** random.uniform(0, 1)
    gearbox = row_of_wheels(kernel, inertias, torques)
    closed, force = closed_by_law(gearbox, inertias, torques)
    state = gearbox.start()
    before = random.random(MESHES) < 0.7
    for m in range(MESHES):
        gearbox.mode(state, m)[1] = LOADED if before[m] else OPEN
        state.y[gearbox.index(f"multiplier_{m}")] = 0.0
    after, _ = gearbox.apply_all(state, [])
    found = [gearbox.mode(after, m)[1] == LOADED for m in range(MESHES)]
    assert found == closed.tolist()
    np.testing.assert_allclose(gearbox.outputs(after)["normal_force"], force, rtol=1e-9)


def moving(kernel: Kernel, seed: int) -> tuple[Gearbox, State]:
    """Flanks in contact, some closed; with friction; approaching or separating, some slowly."""
    random = np.random.default_rng(seed)
    n = int(random.integers(3, 7))
    inertias = 10.0 ** random.uniform(-2, 2, n)
    torques = random.normal(size=n) * inertias ** random.uniform(0, 1)
    law = {
        "restitution": float(random.choice([0.0, 0.3, 0.8])),
        "rest_velocity": float(random.choice([1e-6, 1e-3, 0.1])),
    }
    friction = (float(random.choice([0.1, 0.5])), 1e-3)
    gearbox = row_of_wheels(kernel, inertias, torques, friction=friction, **law)
    state = gearbox.start()
    state.y[gearbox.index("reference_speed")] = random.normal() * random.choice([0, 1, 10])
    for i in range(1, n):
        size = random.choice([0, 1e-7, 1e-5, 1e-3])
        state.y[gearbox.index(f"speed_deviation_{i}")] += size * random.normal()
    for m in range(n - 1):
        gearbox.mode(state, m)[1] = LOADED if random.random() < 0.6 else OPEN
        state.y[gearbox.index(f"multiplier_{m}")] = 0.0
    return gearbox, state


@pytest.mark.parametrize("seed", [*range(500), 2141])  # there two of several are pressed together
def test_after_an_event_nothing_is_left_to_happen(kernel: Kernel, seed: int):
    """No flank remains that its load closes at once, or that separates too slowly to open.

    A second event at the same instant opens or closes no flank.
    """
    gearbox, state = moving(kernel, seed)
    after, _ = gearbox.apply_all(state, [])
    after.yp = gearbox.derivative(after)
    o = gearbox.outputs(after)
    bend = gap_directions(gearbox) @ o["angular_acceleration"]
    rest = (abs(o["gap"]) < 1e-15) & (abs(o["gap_rate"]) < 1e-12)
    closed = [gearbox.mode(after, m)[1] == LOADED for m in range(len(rest))]
    assert (bend[rest & ~np.array(closed)] > 0).all()
    _, events = gearbox.apply_all(after, [])
    assert [event for event in events if "sliding" not in event.name] == []
