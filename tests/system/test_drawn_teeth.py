"""Drawn teeth of a history touch at the contacts of the kernel."""

from __future__ import annotations

import numpy as np
import pytest

from evolvent.physics.teeth import drawn_meshes, drawn_wheels

CHORD = 1e-6  # deviation of a drawn chord from its involute [m]
PITCH_ERRORS = 2e-6  # of class 1; they are not drawn [m]
ROWS = 15


def distance(point: complex, outline: np.ndarray) -> float:
    along = np.roll(outline, -1) - outline
    along = np.where(along == 0, 1e-30, along)
    share = ((point - outline) * along.conjugate()).real / np.abs(along) ** 2
    return float(np.abs(outline + np.clip(share, 0.0, 1.0) * along - point).min())


@pytest.mark.parametrize(
    ("case", "settings"),
    [
        ("spur-pair.yaml", ()),
        ("spur-pair.yaml", ("wheels.0.tip_rounding=3e-4", "wheels.1.tip_rounding=5e-4")),
        ("rattle.yaml", ()),
        ("two-stage-gears.yaml", ()),
        ("two-stage.yaml", ()),
        ("paper-friction.yaml", ()),
        (
            "paper-friction.yaml",
            ("meshes.0.driving_rotation=counterclockwise", "wheels.pinion.loads.0.value=1"),
        ),
        ("tip-relief.yaml", ("wheels.0.accuracy.class=1", "wheels.1.accuracy.class=1")),
    ],
)
def test_drawn_flanks_touch_where_tooth_pairs_carry_load(runs, case, settings):
    """Within chord, penetration and the deviation of the mate, on drive and coast flanks."""
    run = runs(case, *settings)
    history = run.history
    wheels, meshes = drawn_wheels(history), drawn_meshes(history)
    force = history["pair_normal_force"].values
    position = history["pair_position"].values
    loaded = np.flatnonzero((force > 0).any(axis=(1, 2)))
    touched: set[str] = set()
    for row in loaded[:: max(loaded.size // ROWS, 1)]:
        moved = [complex(*shift) for shift in history["centre_displacement"].values[row]]
        turned = history["angle"].values[row]
        outlines = [
            wheel.outline(float(angle), shift)
            for wheel, angle, shift in zip(wheels, turned, moved, strict=True)
        ]
        for number, mesh in enumerate(meshes):
            slack = CHORD + float(history["penetration"].values[row, number])
            if history["tip_relief"].values.any():
                slack += PITCH_ERRORS + float(history["tip_relief"].values.max())
            for slot in np.flatnonzero(force[row, number] > 0):
                name = str(history["pair"].values[slot])
                touched.add(name.split("_")[0])
                start, along, _ = mesh.line(name.startswith("coast"), mesh.shifts(history, row))
                point = start + position[row, number, slot] * along
                for wheel in mesh.wheels:
                    assert distance(point, outlines[wheel]) < slack, (row, name)
    assert touched == ({"drive", "coast"} if case == "rattle.yaml" else {"drive"})
