"""Moving pictures of examples: labels never stand on each other, nor beyond the edge."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from evolvent import open_history
from evolvent.pages.scales import largest_of
from evolvent.pages.scene import Scene
from pictures import faults

FRAMES = 6
CASES = [
    ("paper", 1),
    ("spur-pair", 1),
    ("compliant-pair", 1),
    ("rattle", 1),
    ("motor-driven", 1),
    ("two-stage", 2),
    ("two-stage-gears", 2),
]


@pytest.mark.parametrize(
    ("case", "mesh"),
    [(case, mesh) for case, meshes in CASES for mesh in (None, *range(meshes))],
)
def test_labels_of_every_frame_are_apart_and_inside(
    example_run: Callable[[str], Path], case: str, mesh: int | None
) -> None:
    with open_history(example_run(case)) as history:
        rows = np.linspace(0, history.sizes["time"] - 1, FRAMES).astype(int).tolist()
        loads = history["load_torque"].values[rows]
        scene = Scene(history, mesh, largest_of(history, rows, mesh), speed=1.234e-5)
        for row, torque in zip(rows, loads, strict=True):
            figure = scene.show(row)
            assert faults(figure) == []
            names = "\n".join(text.get_text() for text in figure.axes[0].texts)
            for wheel in scene.visible:
                assert scene.wheels[wheel].name in names
            expected = sum(torque[wheel] != 0 for wheel in scene.visible)
            assert names.count("drives with") + names.count("brakes with") == expected
