"""Loss factors of a mesh: H_V of equal load shares, H_VL of the shares under load."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

from system.real_cases import real_pair
from system.test_operating_friction import of_mesh
from system.test_slow_runs import SPEED, TORQUE
from system.test_slow_runs import case as slow_case

Evolvent = Callable[..., subprocess.CompletedProcess[str]]


MU = 0.01


def fzg(**wheel: Any) -> dict[str, Any]:
    """FZG gears of type C."""
    diameters, shifts = (82.46e-3, 118.36e-3), (0.182, 0.171)
    of_wheels = [
        {
            "tip_diameter": diameters[i],
            "profile_shift": shifts[i],
            "thickness_allowance": -1e-4,
            "loads": [{"kind": "torque", "value": -1.0}],
            **wheel,
        }
        for i in (0, 1)
    ]
    return real_pair(
        (16, 24),
        4.5e-3,
        width=0.014,
        wheels=(of_wheels[0], of_wheels[1]),
        mesh={"centre_distance": 91.5e-3},
    )


def test_the_loss_factor_of_fzg_gears_type_c(evolvent: Evolvent, tmp_path: Path) -> None:
    """0.19495824, computed from contact ratios 0.72258953 and 0.71494742."""
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(fzg()))
    shown = evolvent("show", file, "--json")
    assert shown.returncode == 0, shown.stderr
    z_1, z_2, eps = 16, 24, 1.437537
    expected = math.pi * (1 / z_1 + 1 / z_2) * (1 - eps + 0.72258953**2 + 0.71494742**2)
    assert expected == pytest.approx(0.19495824, rel=1e-5)
    factor = of_mesh(json.loads(shown.stdout), "loss_factor")
    assert factor == pytest.approx(0.19495824, rel=1e-6)


def test_under_load_the_corner_contact_raises_it(evolvent: Evolvent, tmp_path: Path) -> None:
    """FZG type C at 302 N m: about 0.2035 by another program.

    With the sliding at the ends of the flanks instead of the corners it is 0.2027, in full 0.2043.
    """
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(fzg(bore=0.03, compliance={})))
    words = ("static", file, "--torque", "302", "-o", tmp_path / "x.h5")
    document = json.loads(evolvent(*words, "--json").stdout)
    assert document["tooth_loss_factor"] == pytest.approx(0.19495824, rel=1e-6)
    (loaded,) = document["loaded_tooth_loss_factor"]
    assert loaded == pytest.approx(0.2035, rel=0.01)
    text = evolvent(*words).stdout
    assert f"H_V 0.195 with equal load shares, H_VL {loaded:.4g} with the shares" in text


def slow(*, drives: bool, compliant: bool) -> dict[str, Any]:
    """A slow run without deviations; the gear drives if not `drives`."""
    one = slow_case("perfect", 0.0, coasts=not drives)
    if not compliant:
        for wheel in one["wheels"]:
            del wheel["compliance"]
    friction = {"law": "coulomb", "coefficient": MU, "regularisation_velocity": 1e-7}
    one["meshes"][0]["friction"] = friction
    one["simulation"]["metrics"] = {"from": one["simulation"]["duration"] / 2}
    one["simulation"]["duration"] *= 1.5  # a whole pitch after the first
    return one


def lost(evolvent: Evolvent, folder: Path, one: dict[str, Any]) -> float:
    """Mean friction loss of the window over the power of the driving wheel."""
    file, result = folder / "case.yaml", folder / "run.h5"
    file.write_text(json.dumps(one))
    done = evolvent("run", file, "-o", result)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(result, engine="netcdf4") as run:
        return float(run.window_friction_loss_mean[0]) / (TORQUE * SPEED)


def test_contacts_alone_lose_mu_times_the_loss_factor(evolvent: Evolvent, tmp_path: Path) -> None:
    """Equal shares nearly hold without compliance of the teeth."""
    file = tmp_path / "show.yaml"
    file.write_text(json.dumps(slow(drives=True, compliant=False)))
    factor = of_mesh(json.loads(evolvent("show", file, "--json").stdout), "loss_factor")
    losses = [
        lost(evolvent, tmp_path, slow(drives=drives, compliant=False)) for drives in (True, False)
    ]
    assert sum(losses) / 2 == pytest.approx(MU * factor, rel=0.015)


def test_corner_contact_loses_what_the_static_analysis_says(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    """Compliant teeth without relief enter and leave on their corners."""
    one = slow(drives=True, compliant=True)
    file, result = tmp_path / "case.yaml", tmp_path / "static.h5"
    file.write_text(json.dumps(one))
    speed = ("--torque", repr(TORQUE), "--speed", repr(SPEED))
    done = evolvent("static", file, "-o", result, *speed, "--points", "1000")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(result, engine="netcdf4") as opened:
        curve = opened.load()
    assert (curve.pair_contact_kind > 1).any()
    loaded, equal = float(curve.loaded_tooth_loss_factor[0]), float(curve.tooth_loss_factor)
    assert loaded > equal
    h = curve.transmission_error.values[0]
    one["simulation"]["initial"]["gaps"] = {"pinion-gear": -float(h[0])}
    expected = MU * (loaded + by_growth(curve, h))
    assert lost(evolvent, tmp_path, one) == pytest.approx(expected, rel=1e-4)


def by_growth(curve: xr.Dataset, h: Any) -> float:
    """Change of the loss factor as the driven wheel lags more or less, about 1e-3 of it."""
    growth = (np.roll(h, -1) - np.roll(h, 1)) / (2 * float(curve.base_pitch) / h.size)
    arm_a = curve.pair_position.values[0] / float(curve.base_radius_driving)
    arm_b = curve.pair_position_driven.values[0] / float(curve.base_radius_driven)
    share = curve.force_share.values[0]
    terms = np.where(share > 0, share * np.sign(arm_b - arm_a) * arm_b, 0.0)
    return float(-(terms.sum(1) * growth).mean())
