"""Rigid flanks that touch at one instant: those are closed that Newton's laws want closed."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from kernel.gearbox import LOADED, OPEN, Gearbox
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.kernel import Kernel
from kernel.rigid_cases import rigid

MESHES = 4


def row_of_wheels(kernel: Kernel, inertias: np.ndarray, torques: np.ndarray) -> Gearbox:
    """Wheels in a row on fixed axles, each with a torque of its own."""
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
            friction=0.0,
            **rigid(kernel),
        )
        for m in range(len(inertias) - 1)
    ]
    loads = [load(i, TORQUE, torque) for i, torque in enumerate(torques)]
    return Gearbox(kernel, wheels, loads, meshes)


def closed_by_law(gearbox: Gearbox, inertias: np.ndarray, torques: np.ndarray):
    """The only normal forces F >= 0 with gap'' = k + R F >= 0 that are 0 where the gap opens."""
    n = len(inertias) - 1
    directions = np.zeros((n, n + 1))
    for m in range(n):
        for i in (m, m + 1):
            sign = gearbox.mesh_geometry(m).sigma
            directions[m, i] = sign * gearbox.wheel_geometry(i).base_radius
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
        state.y[gearbox.place(f"multiplier_{m}")] = 0.0
    after, _ = gearbox.apply_all(state, [])
    found = [gearbox.mode(after, m)[1] == LOADED for m in range(MESHES)]
    assert found == closed.tolist()
    np.testing.assert_allclose(gearbox.outputs(after)["normal_force"], force, rtol=1e-9)
