"""Energy scale of a mounted housing, which depends on the duration of the run."""

from __future__ import annotations

import numpy as np

from kernel.gearbox import Gearbox
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.housing_cases import BODY
from kernel.housing_description import MOUNTED, housing
from kernel.kernel import Kernel

STILL = {**BODY, "velocity": [0.0] * 3, "angular_velocity": [0.0] * 3}
ENERGIES = {"dissipated_energy", "load_work"}


def mounted(kernel: Kernel, **body: object) -> Gearbox:
    wheels = [wheel(teeth=20, pitch_radius=0.2), wheel(teeth=30)]
    parts = housing(MOUNTED, **{**STILL, **body})
    return Gearbox(kernel, wheels, [load(0, TORQUE, -40.0)], [mesh(kernel)], parts)


def energy_of(gearbox: Gearbox, duration: float) -> float:
    scale, row = gearbox.scales(duration)
    index = gearbox.index("load_work")
    assert scale[index] == row[index] == scale[gearbox.index("dissipated_energy")]
    return float(scale[index])


def test_a_short_run_changes_the_scales_of_the_energies_alone(kernel: Kernel) -> None:
    gearbox = mounted(kernel, force=[1e9, 0.0, 0.0])
    for long, short in zip(gearbox.scales(), gearbox.scales(1e-4), strict=True):
        changed = {n for n, a, b in zip(gearbox.names, long, short, strict=True) if a != b}
        assert changed == ENERGIES


def test_the_energy_that_a_load_gives_a_still_housing_grows_with_the_square_of_the_time(
    kernel: Kernel,
) -> None:
    gearbox = mounted(kernel, force=[1e9, 0.0, 0.0])  # far more than the energy of the meshes
    np.testing.assert_allclose(energy_of(gearbox, 2e-4), 4 * energy_of(gearbox, 1e-4), rtol=1e-14)


def test_a_housing_that_rings_takes_no_more_than_in_a_period(kernel: Kernel) -> None:
    gearbox = mounted(kernel, force=[1e9, 0.0, 0.0], stiffness=[3e9] * 3)
    assert energy_of(gearbox, 1.0) == energy_of(gearbox, 100.0) == energy_of(gearbox, np.inf)


def test_the_energy_of_a_very_short_run_is_that_of_the_meshes(kernel: Kernel) -> None:
    light, heavy = mounted(kernel), mounted(kernel, force=[1e9, 0.0, 0.0])
    assert energy_of(light, 1e-12) == energy_of(heavy, 1e-12)
    assert energy_of(light, np.inf) != energy_of(heavy, np.inf)
