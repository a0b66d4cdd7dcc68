"""Data sheets of random gears: every value is finite, or absent with a reason."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from kernel.description import Block
from kernel.gearbox import Gearbox, GearboxError
from kernel.gearbox_description import TORQUE, load, mesh, wheel
from kernel.gears import gear_description
from kernel.interface import fields
from kernel.kernel import Kernel

MOST_ROWS, MOST_POINTS = 160, 1000
N_GEARS = 150
# values of these rows cannot be negative
POSITIVE = ("pressure_", "curvature_", "diameter_", "dynamic_factor", "base_tangent", "dimension")


class Row(ctypes.Structure):
    """`evl_sheet_row`."""

    _fields_ = fields("evl_sheet_row")


def rows_of(gearbox: Gearbox) -> dict[str, Row]:
    """Rows of the first mesh."""
    rows = (Row * MOST_ROWS)()
    n = gearbox.library.evl_gearbox_datasheet(gearbox.handle, 0, MOST_ROWS, rows)
    assert n < MOST_ROWS
    return {row.key.decode(): row for row in rows[:n]}


def random_gears(kernel: Kernel, rng: np.random.Generator) -> Gearbox:
    """Pair of random gears with the same rack, driven by a torque."""
    common: dict[str, Any] = {"module": 10 ** rng.uniform(-3.3, -2)}
    common["pressure_angle"] = np.radians(rng.choice([14.5, 17.5, 20.0, 22.5, 25.0]))
    common["rack_dedendum"] = rng.uniform(1.1, 1.4)
    common["rack_root_radius"] = rng.uniform(0.1, 0.3)
    wheels = []
    for _ in range(2):
        given = {
            **common,
            "profile_shift": rng.uniform(-0.5, 0.9),
            "tip_alteration": rng.uniform(-0.3, 0.1),
            "thickness_allowance": -common["module"] * rng.uniform(0, 0.05),
        }
        if rng.random() < 0.5:
            given["accuracy"] = Block({"class": int(rng.integers(1, 12)), "seed": 1})
        gear = gear_description(**given)
        teeth = int(rng.integers(8, 120))
        wheels.append(wheel(teeth=teeth, width=10 * common["module"], gear=gear))
    loads = [load(i, TORQUE, value) for i, value in enumerate(rng.uniform(-50, 50, 2))]
    rotation = int(rng.choice([-1, 1]))
    return Gearbox(kernel, wheels, loads, [mesh(kernel, real=True, driving_rotation=rotation)])


def test_values_of_random_gears_are_finite_or_absent_with_a_reason(kernel: Kernel) -> None:
    rng = np.random.default_rng(20)
    n_made = n_absent = 0
    while n_made < N_GEARS:
        try:
            gearbox = random_gears(kernel, rng)
        except GearboxError:
            continue
        n_made += 1
        for key, row in rows_of(gearbox).items():
            numbers = np.array(row.value[: row.n])
            n_absent += np.isnan(numbers).sum()
            assert not np.isinf(numbers).any(), key
            assert row.note or not np.isnan(numbers).any(), key
            if key.startswith(POSITIVE):
                assert (numbers[np.isfinite(numbers)] > 0).all(), key
    assert n_absent > 0


def test_outlines_of_teeth_lie_between_root_and_tip_and_pass_the_pitch_point(
    kernel: Kernel,
) -> None:
    rng = np.random.default_rng(21)
    n_made = 0
    while n_made < 30:
        try:
            gearbox = random_gears(kernel, rng)
        except GearboxError:
            continue
        n_made += 1
        rows = rows_of(gearbox)
        pitch, tip, root = (
            np.array(rows[key].value[:2]) / 2
            for key in ("pitch_diameter", "tip_diameter", "root_diameter")
        )
        for side, middle in enumerate((-pitch[0], pitch[1])):
            points = np.empty((MOST_POINTS, 2))
            call = gearbox.library.evl_gearbox_mesh_outline
            n = call(gearbox.handle, 0, side, 3, MOST_POINTS, points)
            assert 0 < n <= MOST_POINTS
            radii = np.hypot(points[:n, 0], points[:n, 1] - middle)
            assert radii.min() >= root[side] * (1 - 1e-9)
            assert radii.max() <= tip[side] * (1 + 1e-9)
            # counterclockwise but for the undercut, in steps of a fraction of a pitch
            angles = np.unwrap(np.arctan2(points[:n, 1] - middle, points[:n, 0]))
            steps = np.diff(angles) * rows["teeth"].value[side] / (2 * np.pi)
            assert steps.max() < 0.6
            assert np.isclose(angles[-1] - angles[0], 3 * 2 * np.pi / rows["teeth"].value[side])
            # a flank crosses the pitch point: the outline passes closer than its chords deviate
            assert np.hypot(*points[:n].T).min() < rows["base_pitch"].value[0] / 10
