"""Sliding velocity of each tooth pair."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kernel.kernel import Kernel
from kernel.real_cases import GAPS, PAIRS, made

PERFECT = [name for name, pair in PAIRS.items() if not pair.deviates]


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("name", PAIRS)
def test_the_pair_longest_on_the_path_slides_as_its_mesh(kernel: Kernel, name: str, gap: str):
    """To the bit; pairs off the path have no value."""
    gearbox, teeth = made(kernel, PAIRS[name], GAPS[gap], seed=3)
    values = gearbox.outputs(teeth.state)
    sliding, on_path = values["pair_sliding_velocity"][0], values["pair_on_path"][0] == 1
    np.testing.assert_array_equal(np.isfinite(sliding), on_path)
    drive = np.arange(len(sliding)) < gearbox.sizes.n_drive_slots
    (leader,) = np.flatnonzero(drive & (values["pair_number"][0] == values["tooth_pair"][0]))
    if on_path[leader]:
        assert sliding[leader] == values["sliding_velocity"][0]


@pytest.mark.parametrize("gap", GAPS)
@pytest.mark.parametrize("name", PERFECT)
def test_every_pair_slides_as_its_place_on_the_line_of_action_and_the_speeds_say(
    kernel: Kernel, name: str, gap: str
):
    """With fixed axes: sigma (omega_A l_A + omega_B l_B), l the distances from the base circles.

    The coast flank is the mirror image, with the opposite sigma.
    """
    pair = replace(PAIRS[name], fixed=True)
    gearbox, teeth = made(kernel, pair, GAPS[gap], seed=3)
    values = gearbox.outputs(teeth.state)
    speed_a, speed_b = values["angular_velocity"]
    length = values["line_of_action_length"][0]
    share = values["elastic_share_driving"][0]
    n_drive, reported = gearbox.sizes.n_drive_slots, 0
    for index, sliding in enumerate(values["pair_sliding_velocity"][0]):
        if not np.isfinite(sliding):
            continue
        rho_a, h = values["pair_position"][0][index], values["pair_penetration"][0][index]
        sigma = values["flank"][0] * (1 if index < n_drive else -1)
        arm_a = rho_a - share * h
        arm_b = (length + h - rho_a) - (1 - share) * h
        expected = sigma * (speed_a * arm_a + speed_b * arm_b)
        size = abs(speed_a * arm_a) + abs(speed_b * arm_b)
        assert abs(sliding - expected) <= 1e-12 * size, index
        reported += 1
    assert reported > 0 or name == "contact lost"
