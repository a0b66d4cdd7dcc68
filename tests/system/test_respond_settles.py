"""`evolvent respond` of a drive whose slowest mode takes many pitches to settle."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

from evolvent.figures.orbits import draw_orbits
from evolvent.figures.response import draw_response

SPEED = "wheels.motor.loads.0.speed"
SETTLING = -2


def drive() -> dict[str, Any]:
    """A pair with compliant teeth between a motor and a machine on soft shafts: 18 Hz, 0.2."""
    gears = {
        "module": "4.5 mm",
        "thickness_allowance": "-60 um",
        "bore": "30 mm",
        "width": "14 mm",
        "material": "steel",
        "compliance": {},
    }
    disc = {"width": "200 mm", "material": "steel"}
    return {
        "format": 1,
        "materials": {
            "steel": {"youngs_modulus": "206 GPa", "poisson_ratio": 0.3, "density": "7830 kg/m3"}
        },
        "wheels": [
            {
                **disc,
                "name": "motor",
                "inertia": "0.2 kg m2",
                "mass": "80 kg",
                "loads": [
                    {
                        "kind": "drive",
                        "speed": "2250 rpm",
                        "torque": "302 N m",
                        "slope": "-5 N m/rpm",
                    }
                ],
            },
            {
                **gears,
                "name": "pinion",
                "teeth": 16,
                "profile_shift": 0.1817,
                "tip_diameter": "82.46 mm",
            },
            {
                **gears,
                "name": "gear",
                "teeth": 24,
                "profile_shift": 0.1715,
                "tip_diameter": "118.36 mm",
            },
            {
                **disc,
                "name": "machine",
                "inertia": "0.5 kg m2",
                "mass": "50 kg",
                "loads": [{"kind": "torque", "value": "453 N m"}],
            },
        ],
        "shafts": [
            {
                "name": "coupling",
                "wheels": ["motor", "pinion"],
                "stiffness": "5 kN m/rad",
                "damping": "0.3 N m s/rad",
            },
            {
                "name": "output",
                "wheels": ["gear", "machine"],
                "stiffness": "10 kN m/rad",
                "damping": "1 N m s/rad",
            },
        ],
        "meshes": [
            {
                "name": "pinion-gear",
                "driving": "pinion",
                "driven": "gear",
                "driving_rotation": "counterclockwise",
                "centre_line_angle": "0 deg",
                "centre_distance": "91.5 mm",
                "damping": {"law": "ratio", "value": 0.07},
                "friction": {
                    "law": "coulomb",
                    "coefficient": 0.05,
                    "regularisation_velocity": "1 mm/s",
                },
            }
        ],
        "simulation": {
            "duration": "0.1 s",
            "output": {"per_pitch": 100, "mesh": "pinion-gear"},
            "initial": {"kind": "steady"},
        },
    }


@pytest.fixture
def case(tmp_path: Path) -> Path:
    path = tmp_path / "drive.yaml"
    path.write_text(yaml.safe_dump(drive(), sort_keys=False))
    return path


Evolvent = Callable[..., subprocess.CompletedProcess[str]]


@pytest.mark.parametrize("steps", [4, pytest.param(41, marks=pytest.mark.long)])
def test_slow_modes_are_waited_for_and_leave_no_hysteresis(
    evolvent: Evolvent, case: Path, tmp_path: Path, steps: int
) -> None:
    """600 pitches are five time constants of its slowest mode at 12000 rpm.

    Up and down give the same motion, to the error of the integration and the criterion of 1e-6 of a
    scale.
    """
    path = tmp_path / "r.h5"
    over = f"{SPEED}={12000 - 200 * (steps - 1)} rpm:12000 rpm:{steps}"
    done = evolvent("respond", case, "--over", over, "-o", path)
    assert done.returncode == 0, done.stderr
    assert "0 not periodic, 0 still settling, 0 jumps" in done.stderr
    with xr.open_dataset(path, engine="h5netcdf") as response:
        assert (response["period"] == 1).all()
        assert response.sizes["jump"] == 0
        assert response["followed"].max() < 600  # shooting replaces most of the integration
        reported = response["transmission_error_standard_deviation"].values[..., 0]
    np.testing.assert_allclose(reported[0], reported[1], rtol=1e-7)


def test_what_still_settles_is_not_called_aperiodic(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """30 pitches are less than a time constant at 12000 rpm, for any motion."""
    path = tmp_path / "r.h5"
    words = ("--over", f"{SPEED}=11800 rpm:12000 rpm:2", "--periods", "100", "-o", path)
    done = evolvent("respond", case, *words)
    assert done.returncode == 0, done.stderr
    assert "0 not periodic, 4 still settling, 0 jumps" in done.stderr.splitlines()[-1]
    (line,) = [line for line in done.stderr.splitlines() if "warning" in line]
    assert "the slowest mode has a time constant of 0.0408" in line
    assert "--periods " in line
    modes = evolvent("modes", case, "--mean", "--json", "--set", f"{SPEED}=12000 rpm")
    slowest = max(-1 / mode["eigenvalue"][0] for mode in json.loads(modes.stdout)["modes"])
    with xr.open_dataset(path, engine="h5netcdf") as response:
        response.load()
    assert (response["period"] == SETTLING).all()
    assert (response["repeat_distance"] > 1e-6).all()
    np.testing.assert_allclose(response["time_constant"], slowest, rtol=0.02)
    legends = draw_response(response).legends
    labels = [text.get_text() for text in legends[0].get_texts()]
    assert "up, still settling" in labels
    assert not any("not periodic" in label for label in labels)


@pytest.mark.long
def test_a_pair_that_grazes_in_a_mesh_that_never_parts_is_called_a_pair(
    evolvent: Evolvent, case: Path, tmp_path: Path
) -> None:
    """Half a minute: around 8.5 krpm tooth pairs graze while others carry load."""
    path = tmp_path / "o.h5"
    over = f"{SPEED}=8000 rpm:8700 rpm"
    done = evolvent("respond", case, "--over", over, "--method", "orbits", "-o", path)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(path, engine="h5netcdf") as orbits:
        grazing = np.isin(orbits["orbit_kind"].values, [5, 6])
        assert grazing.any()
        assert (orbits["share_no_contact"] == 0).all()
        assert (orbits["orbit_grazing"].values[grazing] == 1).all()
        labels = [text.get_text() for text in draw_orbits(orbits.load()).legends[0].get_texts()]
    assert "one tooth pair just touches" in labels
    assert not any("mesh" in label for label in labels)
