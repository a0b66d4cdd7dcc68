"""Friction laws with a local coefficient in whole cases."""

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

from evolvent import check_history
from system.cases import STEEL
from system.test_operating_friction import MODULE, OIL, TEETH, case

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
LAWS = pytest.mark.parametrize("law", ["benedict_kelley", "xu_kahraman"])
B = (
    *(math.nan, -8.916465, 1.03303, 1.036077, -0.354068, 2.812084),
    *(-0.100601, 0.752755, -0.390958, 0.620305),
)
DELTA, WIDTH = 1e-3, 0.02


def coefficient(law: str, load: Any, v: Any, total: Any, curvature: Any) -> Any:
    """The formula of docs/reference/laws.md for 20 mPa s and 0.5 um."""
    u, rolling, eta = np.hypot(v, DELTA), np.hypot(total, DELTA), 20.0
    if law == "benedict_kelley":
        mu = 0.0127 * np.log10(29660 * load / 1e3 / (eta * u * rolling**2))
        return np.clip(mu, 0, 0.2) * v / u
    e_star = STEEL["youngs_modulus"] / (2 * (1 - STEEL["poisson_ratio"] ** 2))
    p = np.clip(np.sqrt(load * e_star * curvature / np.pi) / 1e9, 0.05, 4)
    ratio = np.minimum(2 * u / rolling, 2)
    x = ratio * p * np.log10(eta)
    f = B[1] + B[4] * x + B[5] * np.exp(-x) + B[9] * np.exp(0.5)
    powers = p ** B[2] * ratio ** B[3] * (rolling / 2) ** B[6] * eta ** B[7] * curvature ** -B[8]
    return np.exp(f) * powers * v / u


@LAWS
@pytest.mark.parametrize("compliant", [False, True], ids=["contacts", "compliant"])
def test_the_friction_of_every_pair_is_that_of_the_law(runs, law: str, *, compliant: bool) -> None:
    """Radii of curvature follow from the sliding velocity, within the penetration."""
    one = case(law)
    if compliant:
        for wheel in one["wheels"]:
            wheel |= {"bore": 0.02, "compliance": {"model": "analytic"}}
    run = runs(one)
    assert run.exit_code == 0, run.messages
    assert [v.invariant.name for v in check_history(run.history) if v.failed] == []
    h = run.history
    base = [MODULE * z / 2 * math.cos(math.radians(20)) for z in TEETH]
    line = sum(base) * math.tan(float(h.working_pressure_angle[0]))
    omega = np.abs(h.angular_velocity.values)
    omega_a, omega_b = omega[:, 0, None], omega[:, 1, None]
    normal = h.pair_normal_force.values[:, 0, :]
    v = h.pair_sliding_velocity.values[:, 0, :]
    rho_a = (omega_b * line - v) / (omega_a + omega_b)
    on_path = (normal > 1) & (rho_a > 1e-3) & (rho_a < line - 1e-3)
    rho_b = line - rho_a
    total = omega_a * rho_a + omega_b * rho_b
    with np.errstate(invalid="ignore", divide="ignore"):
        phi = coefficient(law, normal / WIDTH, v, total, 1 / rho_a + 1 / rho_b)
    found = -h.pair_friction_force.values[:, 0, :]
    assert on_path.sum() > 50
    largest = np.nanmax(np.abs(found))
    np.testing.assert_allclose(
        found[on_path], (normal * phi)[on_path], rtol=2e-3, atol=2e-3 * largest
    )


@LAWS
def test_radau_and_ida_agree(runs, law: str) -> None:
    one = case(law)
    one["simulation"]["tolerance"] = 1e-10
    radau, ida = (runs(one, f"simulation.integrator={name}").history for name in ("radau", "ida"))
    for name in ("normal_force", "friction_force", "angular_velocity", "dissipated_energy"):
        scale = float(np.abs(radau[name]).max())
        np.testing.assert_allclose(ida[name], radau[name], rtol=0, atol=1e-6 * scale)


@LAWS
def test_the_mirrored_case_and_the_other_order_of_wheels_are_the_same(runs, law: str) -> None:
    names = ("normal_force", "friction_loss", "dissipated_energy", "transmission_error")
    first = runs(case(law)).history
    for other in (case(law, 1), case(law, swapped=True)):
        run = runs(other)
        assert run.exit_code == 0, run.messages
        for name in names:
            scale = float(np.abs(first[name]).max())
            np.testing.assert_allclose(run.history[name], first[name], rtol=0, atol=1e-9 * scale)


@LAWS
def test_static_friction_is_that_of_the_law(evolvent: Evolvent, tmp_path: Path, law: str) -> None:
    file, result = tmp_path / "case.yaml", tmp_path / "static.h5"
    file.write_text(json.dumps(case(law)))
    done = evolvent("static", file, "--torque", "120", "--speed", "150", "-o", result)
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(result, engine="netcdf4") as opened:
        curve = opened.load()
    base = (float(curve.base_radius_driving), float(curve.base_radius_driven))
    rho_a, rho_b = curve.pair_position.values[0], curve.pair_position_driven.values[0]
    normal = curve.pair_normal_force.values[0]
    loaded = normal > 0
    h = (curve.transmission_error.values[0])[:, None] / 2
    v_a, v_b = 150 * (rho_a - h), 150 * base[0] / base[1] * (rho_b - h)
    with np.errstate(invalid="ignore", divide="ignore"):
        phi = coefficient(law, normal / WIDTH, v_b - v_a, v_a + v_b, 1 / rho_a + 1 / rho_b)
    np.testing.assert_allclose(
        curve.pair_friction_force.values[0][loaded], -(normal * phi)[loaded], rtol=1e-9
    )


@LAWS
def test_a_rigid_contact_refuses_it_in_one_line(
    evolvent: Evolvent, tmp_path: Path, law: str
) -> None:
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(case(law, contact={"law": "rigid"}, damping={"law": "none"})))
    done = evolvent("validate", file)
    assert done.returncode == 3
    assert len(done.stderr.splitlines()) == 1
    assert "friction law whose coefficient depends on its force; choose coulomb" in done.stderr


@pytest.mark.parametrize(
    ("law", "key", "needed"),
    [
        ("benedict_kelley", "viscosity", True),
        ("benedict_kelley", "roughness", False),
        ("xu_kahraman", "viscosity", True),
        ("xu_kahraman", "roughness", True),
    ],
)
def test_only_what_the_law_uses_is_required(
    evolvent: Evolvent, tmp_path: Path, law: str, key: str, *, needed: bool
) -> None:
    one = case(law)
    one["lubricant"] = {name: value for name, value in OIL.items() if name != key}
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    done = evolvent("validate", file)
    assert (done.returncode != 0) == needed, done.stderr
    assert (f"needs '{key}' of the lubricant" in done.stderr) == needed


@pytest.mark.parametrize(
    ("oil", "named"),
    [
        ({}, None),
        ({"viscosity": "0.5 mPa s"}, "the viscosity 5E-04 Pa s counts as 0.001 Pa s"),
        ({"roughness": "2 um"}, "the roughness 2E-06 m counts as 1E-06 m"),
    ],
    ids=str,
)
def test_a_held_argument_is_named_in_a_warning(
    evolvent: Evolvent, tmp_path: Path, oil: dict[str, str], named: str | None
) -> None:
    one = case("xu_kahraman")
    one["lubricant"].update(oil)
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    done = evolvent("validate", file)
    assert done.returncode == 0, done.stderr
    assert ("counts as" in done.stderr) == (named is not None)
    assert named is None or named in done.stderr


@pytest.mark.parametrize("integrator", ["radau", "ida"])
@pytest.mark.parametrize("amplitude", [0.0, 7000.0])
def test_an_argument_held_only_during_the_run_is_named_once(
    evolvent: Evolvent, tmp_path: Path, integrator: str, amplitude: float
) -> None:
    """2 GPa at the nominal operating point; the torque pulsates to 5 times its mean."""
    one = case("xu_kahraman")
    load = {"kind": "harmonic", "mean": -500.0, "amplitude": max(amplitude, 1.0), "frequency": 600}
    one["wheels"][1]["loads"] = [load]
    one["simulation"] |= {"duration": 2e-3, "integrator": integrator}
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    assert evolvent("validate", file).stderr == ""
    done = evolvent("run", file, "-q", "-o", tmp_path / "run.h5")
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("counts as") == (amplitude > 0)
    if amplitude > 0:
        assert "meshes.pinion-gear.friction.law: the pressure of a tooth pair, " in done.stderr
        assert "checked at the ends of all steps" in done.stderr
        largest = xr.open_dataset(tmp_path / "run.h5", engine="h5netcdf")
        assert float(largest["pair_contact_pressure_max"].max()) > 4e9
