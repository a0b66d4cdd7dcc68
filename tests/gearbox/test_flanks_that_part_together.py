"""Rigid flanks with simultaneous adhesive forces: which of them stay closed."""

from __future__ import annotations

import numpy as np
import pytest

from kernel.gearbox import LOADED, OPEN, Gearbox
from kernel.gearbox_description import TORQUE, load, mesh, shaft, wheel
from kernel.kernel import Kernel
from kernel.rigid_cases import fire, rigid

INERTIAS = (100.0, 0.5, 0.5, 0.01)  # the second and the third wheel are one rotor
TEETH = (20, 20, 80, 20)


def two_steps(kernel: Kernel, sigma: int, press: float, flee: float) -> Gearbox:
    """Two meshes in a row, a small and a large wheel on one shaft; the last wheel speeds up."""
    wheels = [
        wheel(
            teeth=z,
            pitch_radius=0.01 * z,
            inertia=inertia,
            centre=(0.0, 0.0) if i == 0 else None,
        )
        for i, (z, inertia) in enumerate(zip(TEETH, INERTIAS, strict=True))
    ]
    meshes = [
        mesh(
            kernel,
            *(m, m + 1),
            driving_rotation=-sigma * (-1) ** (m // 2),
            centre_line_angle=0.5,
            pressure_angle=0.35,
            friction=0.0,
            **rigid(kernel),
        )
        for m in (0, 2)
    ]
    signs = [_sigma(kernel, meshes, wheels, m) for m in (0, 1)]
    loads = [load(0, TORQUE, -signs[0] * press), load(3, TORQUE, signs[1] * flee)]
    return Gearbox(kernel, wheels, loads, meshes, shafts=[shaft(1, 2)])


def _sigma(kernel: Kernel, meshes: list, wheels: list, m: int) -> int:
    return Gearbox(kernel, wheels, [], meshes, shafts=[shaft(1, 2)]).mesh_geometry(m).sigma


@pytest.mark.parametrize("sigma", [1, -1])
def test_a_flank_stays_closed_that_only_pulls_while_another_is_closed_too(
    kernel: Kernel, sigma: int
):
    """kappa'' = k + R F: with both closed both pull, the first one more; alone the second pulls,
    and alone the first one pushes, by -k_0/R_00, and carries the rotor away from the second.
    """
    press, flee = 1.0, 1.0
    gearbox = two_steps(kernel, sigma, press, flee)
    radii = [gearbox.wheel_geometry(i).base_radius for i in range(4)]
    rotor = INERTIAS[1] + INERTIAS[2]
    k = np.array([-radii[0] * press / INERTIAS[0], radii[3] * flee / INERTIAS[3]])
    cross = -radii[1] * radii[2] / rotor
    response = np.array(
        [
            [radii[0] ** 2 / INERTIAS[0] + radii[1] ** 2 / rotor, cross],
            [cross, radii[2] ** 2 / rotor + radii[3] ** 2 / INERTIAS[3]],
        ]
    )
    both = -np.linalg.solve(response, k)
    assert both[0] < both[1] < 0
    assert -k[1] / response[1, 1] < 0
    force = -k[0] / response[0, 0]
    assert force > 0
    assert (k + response[:, 0] * force)[1] > 0

    state = gearbox.start()
    for m in (0, 1):
        gearbox.mode(state, m)[1] = LOADED
        state.y[gearbox.index(f"multiplier_{m}")] = 1.0
    after, _ = fire(gearbox, state, np.zeros(gearbox.sizes.n_roots))
    assert [int(gearbox.mode(after, m)[1]) for m in (0, 1)] == [LOADED, OPEN]
    np.testing.assert_allclose(gearbox.outputs(after)["normal_force"], [force, 0.0], rtol=1e-12)


@pytest.mark.parametrize("sigma", [1, -1])
def test_of_two_flanks_that_touch_the_one_closes_that_is_pressed_whatever_the_other_does(
    kernel: Kernel, sigma: int
):
    """Closed together the first would push and the second pull: the first one closes alone."""
    flee = 1.0
    some = two_steps(kernel, sigma, 1.0, flee)
    radii = [some.wheel_geometry(i).base_radius for i in range(4)]
    rotor = INERTIAS[1] + INERTIAS[2]
    first = radii[0] ** 2 / INERTIAS[0] + radii[1] ** 2 / rotor
    second = radii[2] ** 2 / rotor + radii[3] ** 2 / INERTIAS[3]
    cross = radii[1] * radii[2] / rotor
    # of R F = -k the first is positive and the second negative between cross/second and first/cross
    share = np.sqrt(first / second)
    assert cross / second < share < first / cross
    press = share * radii[3] * flee / INERTIAS[3] * INERTIAS[0] / radii[0]
    gearbox = two_steps(kernel, sigma, press, flee)
    state = gearbox.start()
    for m in (0, 1):
        gearbox.mode(state, m)[1] = OPEN
        state.y[gearbox.index(f"multiplier_{m}")] = 0.0
    after, _ = fire(gearbox, state, np.zeros(gearbox.sizes.n_roots))
    assert [int(gearbox.mode(after, m)[1]) for m in (0, 1)] == [LOADED, OPEN]
    force = radii[0] * press / INERTIAS[0] / first
    np.testing.assert_allclose(gearbox.outputs(after)["normal_force"], [force, 0.0], rtol=1e-12)
