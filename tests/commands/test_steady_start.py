"""Steady start behind a soft shaft: it has the requested position of the mesh."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

RELIEF = 8.0e-6  # m: the initial deflection of the teeth is larger, so that tip edges carry load
POSITIONS = (0.05, 0.3, 0.62, 0.85)


@pytest.mark.parametrize("stiffness", [700, 1500, 4500, 100_000])
def test_a_slow_steady_start_is_the_static_mesh_at_its_position(
    evolvent: Evolvent, examples: Path, tmp_path: Path, stiffness: int
) -> None:
    settings = {
        "wheels.pinion.tip_relief.amount": RELIEF,
        "wheels.gear.tip_relief.amount": RELIEF,
        "wheels.pinion.compliance.model": "analytic",
        "wheels.gear.compliance.model": "analytic",
        "meshes.0.friction": "{law: none}",
        "shafts.coupling.stiffness": stiffness,
        "simulation.duration": 1e-4,
        # so slow that all modes follow the mesh and the dampers have no effect
        "wheels.motor.loads.0": "{kind: drive, speed: 1.0e-3, torque: 150, slope: -48}",
        "simulation.metrics": "{from: 0}",
    }
    words = [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]
    case = examples / "tutorial-pair.yaml"
    # 371.7 N m at the machine without losses: 149.984 N m at the pinion
    torque = 371.7 * 23 / 57
    static = evolvent(
        "static", case, "--torque", repr(torque), "--points", "2000", "-o", "rest.h5", *words
    )
    assert static.returncode == 0, static.stderr
    with h5py.File(tmp_path / "rest.h5") as rest:
        positions, errors = rest["position"][:], rest["transmission_error"][:].squeeze()
    for position in POSITIONS:
        start = ("--set", f"simulation.initial={{kind: steady, position: {position}}}")
        done = evolvent("run", case, "-q", "-o", "start.h5", *words, *start)
        assert "metrics contains no whole pitch" in done.stderr
        assert done.returncode == 4, done.stderr
        with h5py.File(tmp_path / "start.h5.partial") as history:
            error = history["transmission_error"][0, 0]
        # the error changes by up to 30 um per pitch; positions of the curve are 1/2000 apart
        assert error == pytest.approx(np.interp(position, positions, errors, period=1), abs=5e-8)
