"""Undercut gears from case to history: a shortened path of contact, and rejected cases."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
SHORTENED = "shortens its path of contact"


def case_of(za: int, zb: int, **changes: Any) -> dict[str, Any]:
    """Standard gears of module 2 mm under a constant torque, driven from rest."""
    case: dict[str, Any] = {
        "format": 1,
        "materials": {"steel": {"youngs_modulus": 206e9, "poisson_ratio": 0.3, "density": 7830}},
        "wheels": [
            {"name": "a", "teeth": za, "loads": [{"kind": "torque", "value": -10}]},
            {"name": "b", "teeth": zb, "loads": [{"kind": "viscous", "coefficient": 1}]},
        ],
        "meshes": [
            {
                "driving": "a",
                "driven": "b",
                "driving_rotation": "clockwise",
                "centre_line_angle": 0,
                "damping": {"law": "ratio", "value": 0.05},
            }
        ],
        "simulation": {"duration": 4e-2, "output_interval": 1e-5, "initial": {"kind": "steady"}},
    }
    for wheel in case["wheels"]:
        wheel.update(module=0.002, width=0.02, material="steel", bore=0.008)
    case["wheels"][0].update(changes.pop("a", {}))
    case["wheels"][1].update(changes.pop("b", {}))
    case["meshes"][0].update(changes.pop("mesh", {}))
    case["simulation"].update(changes)
    return case


def write(folder: Path, case: dict[str, Any], name: str = "case.yaml") -> Path:
    path = folder / name
    path.write_text(json.dumps(case))
    return path


@pytest.mark.parametrize(
    ("za", "zb", "ratio"), [(15, 40, 1.5516), (12, 30, 1.27456), (12, 12, 1.12878)]
)
def test_standard_gears_with_undercut_run(
    evolvent: Evolvent, tmp_path: Path, za: int, zb: int, ratio: float
) -> None:
    done = evolvent("run", write(tmp_path, case_of(za, zb)), "-o", tmp_path / "x.h5")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count(SHORTENED) == 1
    with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
        assert history["contact_ratio"].item() == pytest.approx(ratio, rel=1e-5)
        form = 2 * history["form_radius"].values[0]
        assert 2 * history["active_radius"].values[0] == pytest.approx(form, rel=1e-12)
        assert int(history["pairs_in_contact"].max()) == 2
        assert int(history["pairs_in_contact"].min()) == 1
        force = history["normal_force"].values
        base = history["base_radius"].values[0]
        assert force.mean() * base == pytest.approx(10, rel=2e-2)
        energy = sum(history[k].values for k in ("kinetic_energy", "potential_energy"))
        balance = energy + history["dissipated_energy"].values - history["load_work"].values
        assert abs(balance - balance[0]).max() < 1e-8 * energy.max()
    checked = subprocess.run(
        ["evolvent-post", "check", tmp_path / "x.h5"], capture_output=True, text=True, check=False
    )
    assert checked.returncode == 0, checked.stdout


def test_show_prints_the_shortened_path(evolvent: Evolvent, tmp_path: Path) -> None:
    case = write(tmp_path, case_of(15, 40))
    text = evolvent("show", case).stdout
    assert text.count(SHORTENED) == 1
    shown = json.loads(evolvent("show", case, "--json").stdout)
    mesh, gear = shown["meshes"]["a-b"], shown["wheels"]["a"]["gear"]
    assert mesh["gear"]["active_diameter_driving"] == pytest.approx(
        gear["form_diameter"], rel=1e-12
    )
    path = mesh["gear"]["path_of_contact"]
    assert np.hypot(*np.subtract(mesh["point_b"], mesh["point_a"])) == pytest.approx(
        path, rel=1e-12
    )
    assert 2 * np.hypot(gear["base_diameter"] / 2, mesh["rho_start_driving"]) == pytest.approx(
        gear["form_diameter"], rel=1e-12
    )


def forces(evolvent: Evolvent, folder: Path, case: dict[str, Any], name: str) -> np.ndarray:
    path = write(folder, case, f"{name}.yaml")
    done = evolvent("run", path, "-q", "-o", folder / f"{name}.h5")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(folder / f"{name}.h5", engine="h5netcdf") as history:
        return np.array(history["normal_force"].values[:, 0])


def test_mirror_order_and_integrator_do_not_matter(evolvent: Evolvent, tmp_path: Path) -> None:
    start: dict[str, Any] = {"initial": {"kind": "rest"}, "tolerance": 1e-10, "duration": 2e-3}
    case = case_of(12, 30, **start)
    plain = forces(evolvent, tmp_path, case, "plain")
    mirrored = json.loads(json.dumps(case))
    mirrored["meshes"][0]["driving_rotation"] = "counterclockwise"
    mirrored["wheels"][0]["loads"][0]["value"] = 10
    ordered = json.loads(json.dumps(case))
    ordered["wheels"].reverse()
    other = case_of(12, 30, **start, integrator="ida")
    scale = abs(plain).max()
    for name, changed in {"mirrored": mirrored, "ordered": ordered, "ida": other}.items():
        difference = abs(forces(evolvent, tmp_path, changed, name) - plain).max()
        assert difference < 1e-5 * scale, name


def test_the_driven_wheel_may_be_the_undercut_one(evolvent: Evolvent, tmp_path: Path) -> None:
    """In static equilibrium the choice of the driving wheel is irrelevant."""
    results = []
    for number, (za, zb) in enumerate(((12, 30), (30, 12))):
        path = write(tmp_path, case_of(za, zb), f"{number}.yaml")
        torque = 10 if number == 0 else 10 * 30 / 12
        done = evolvent("static", path, "--torque", f"{torque}", "-o", tmp_path / f"{number}.h5")
        assert done.returncode == 0, done.stderr
        with xr.open_dataset(tmp_path / f"{number}.h5", engine="h5netcdf") as static:
            error = static["transmission_error"].values.ravel()
            results.append((error.min(), error.max(), float(static["contact_ratio"].item())))
    assert results[1] == pytest.approx(results[0], rel=1e-3)


CORNER = "the corner that it leaves on the form circle"


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"b": {"compliance": {"model": "analytic"}}}, ""),
        ({"b": {"compliance": {"model": "finite_elements"}}}, ""),
        ({"mesh": {"edge_contact": True}}, ".edge_contact"),
        ({"mesh": {"edge_contact": False}, "b": {"compliance": {"model": "analytic"}}}, ""),
    ],
)
def test_compliance_and_corner_contact_stay_refused(
    evolvent: Evolvent, tmp_path: Path, changes: dict[str, Any], field: str
) -> None:
    done = evolvent("validate", write(tmp_path, case_of(15, 40, **changes)))
    assert done.returncode == 3
    (line,) = done.stderr.splitlines()
    assert f"meshes.a-b{field}: undercut shortens the path of contact, and {CORNER}" in line


REFUSED = {
    "a contact ratio below 1": (
        case_of(9, 9, a={"profile_shift": -0.1}, b={"profile_shift": 0.1}),
        "undercut leaves it a contact ratio of",
    ),
    "a tip in the undercut tooth": (
        case_of(12, 40, b={"rack": {"addendum": 1.24}}),
        "tip interference: the tip of the driven wheel enters the undercut tooth of the driving",
    ),
}


@pytest.mark.parametrize("what", REFUSED)
def test_what_cannot_mesh_is_refused_and_shown_with_its_geometry(
    evolvent: Evolvent, tmp_path: Path, what: str
) -> None:
    case, reason = REFUSED[what]
    done = evolvent("show", write(tmp_path, case), "--json")
    assert done.returncode == 3
    shown = json.loads(done.stdout)
    assert reason in shown["refusal"]
    assert shown["wheels"]["a"]["gear"]["teeth"] == case["wheels"][0]["teeth"]
    mesh = shown["meshes"]["a-b"]["gear"]
    assert mesh["active_diameter_driving"] == pytest.approx(
        shown["wheels"]["a"]["gear"]["form_diameter"], rel=1e-12
    )
    assert (mesh["contact_ratio"] < 1) == ("ratio" in what)
    text = evolvent("show", write(tmp_path, case)).stdout
    assert "Gears in mesh (ISO 21771)" in text


def test_teeth_that_overlap_are_shown_with_their_geometry(
    evolvent: Evolvent, examples: Path
) -> None:
    words = ("--set", "meshes.0.centre_distance=80.5 mm")
    done = evolvent("show", examples / "spur-pair.yaml", "--json", *words)
    assert done.returncode == 3
    shown = json.loads(done.stdout)
    assert "the teeth do not fit" in shown["refusal"]
    mesh = shown["meshes"]["pinion-gear"]["gear"]
    assert mesh["centre_distance"] == 0.0805
    assert mesh["backlash"] < 0
