"""Integers of the discrete state are initialised, kept and checked; root functions change them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from kernel.deviations import deviations, relief
from kernel.gearbox import LOADED, OPEN, Gearbox, GearboxError, State
from kernel.gearbox_cases import draw
from kernel.gearbox_description import BEARING, SPEEDS, TORQUE, VISCOUS, load, mesh, wheel
from kernel.gears import gear_description
from kernel.kernel import Kernel

DIAMETERS = {
    "tip_relief": (0.0645, 0.1095),
    "root_relief": (0.0575, 0.1015),
}  # start of the reliefs [m]
VALUES = {"flanks": range(5), "friction": (-1, 0, 1), "zone_a": (-1, 0, 1), "zone_b": (-1, 0, 1)}
SIDES = (-1, 1)


@pytest.fixture
def gearbox(kernel: Kernel) -> Gearbox:
    """A gearbox whose tooth contacts have all existing integers."""
    wheels = [
        wheel(
            teeth=z,
            width=0.02,
            gear=gear_description(3e-3),
            deviation=deviations(**{k: relief(2e-6, diameter=d[i]) for k, d in DIAMETERS.items()}),
            support_kind=BEARING,
            support_stiffness=(1e8, 3e8),
            support_mass=3.0,
        )
        for i, z in enumerate((20, 35))
    ]
    pair = mesh(
        kernel,
        friction=(0.1, 1e-3),
        damping=("one_sided", 1e9),
        backlash=2e-5,
    )
    pair.pop("pressure_angle")
    return Gearbox(kernel, wheels, [load(0, TORQUE, -20.0), load(1, VISCOUS, 5.0)], [pair])


def starts(gearbox: Gearbox) -> Iterator[State]:
    """States from a start: overlapping and separated, closing and opening."""
    random = np.random.default_rng(4)
    for _ in range(60):
        speed = draw(random, 10.0)
        speeds = [speed, -speed * 20 / 35 * (1 + draw(random, 1e-4))]
        yield gearbox.start(SPEEDS, speeds, gaps=[float(random.uniform(-3e-6, 1e-6))])


def contradicts(gearbox: Gearbox, state: State) -> bool:
    """Whether the modes are rejected at this state."""
    try:
        gearbox.check_modes(state)
    except GearboxError:
        return True
    return False


def test_no_wrong_integer_goes_unnoticed(gearbox: Gearbox):
    """For every integer of the table: a start sets it, a wrong one is corrected or rejected."""
    names = {name for contact, name in gearbox.integer_names if contact >= 0}
    refused: set[str] = set()
    settled: set[str] = set()
    for state in starts(gearbox):
        assert not contradicts(gearbox, state)
        for index, (contact, name) in enumerate(gearbox.integer_names):
            if contact < 0 or gearbox.mode(state, contact)[1] not in (LOADED, OPEN):
                continue
            right = int(state.integers[index])
            values = (right - 1, right + 1) if name == "tooth_pair" else VALUES.get(name, SIDES)
            for value in set(values) - {right}:
                wrong = state.copy()
                wrong.integers[index] = value
                if not contradicts(gearbox, wrong):
                    continue
                refused.add(name)
                after, _ = gearbox.apply(wrong)
                if after.integers[index] == right and not contradicts(gearbox, after):
                    settled.add(name)
    assert refused == names
    # another tooth pair in its slot is beyond an end of the path, and leaves it
    assert settled == names - {"tooth_pair"}


def test_root_functions_have_directions_where_they_have_a_meaning_and_are_one_elsewhere(
    gearbox: Gearbox,
):
    live = set()
    for state in starts(gearbox):
        values, directions = gearbox.roots(state), gearbox.root_directions(state)
        np.testing.assert_array_equal(
            (values == 1)[:-1], (directions == 0)[:-1]
        )  # except for the revolutions
        live |= {name for name, index in gearbox.root_indices.items() if directions[index] != 0}
        # a start is on the side of every limit given by its modes; starts at rest are on no limit
        assert np.all(values * directions <= 2e-6)
    everything = {name for _, name in gearbox.root_indices}
    assert {name for _, name in live} == everything
