"""Flash and contact temperature of whole runs: their formula, metrics, symmetries and refusals."""

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

from designs import read_folder, write_design
from system.cases import STEEL
from system.periodic_cases import mirrored
from system.scaled_cases import Scales, scaled_case
from system.test_operating_friction import MODULE, TEETH
from system.test_operating_friction import case as pair_case

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

WIDTH, CONDUCTIVITY, HEAT, BULK = 0.02, 45.0, 460.0, 363.15
MU = 0.05
FLASH, CONTACT = "pair_flash_temperature", "pair_contact_temperature"
METRICS = ("flash_temperature_max", "contact_temperature_max")
WANTED = f"pairs,angular_velocity,{FLASH}"


def case(law: str = "coulomb", sign: int = -1, **mesh: Any) -> dict[str, Any]:
    """The pair of the friction laws, with thermal data, and metrics of its window."""
    one = pair_case(law, sign, **mesh)
    if law == "coulomb":
        one["meshes"][0]["friction"]["coefficient"] = MU
    one["materials"]["steel"] |= {
        "thermal_conductivity": f"{CONDUCTIVITY} W/(m K)",
        "specific_heat": f"{HEAT} J/(kg K)",
    }
    one["lubricant"]["bulk_temperature"] = "90 degC"
    one["simulation"] |= {"outputs": WANTED, "metrics": {"from": 2e-4}, "duration": 6e-3}
    return one


def of_pairs(history: xr.Dataset, name: str) -> np.ndarray:
    """An output of the tooth pairs of the only mesh: [time, pair]."""
    return history[name].values[:, 0, :]


def window(history: xr.Dataset, name: str) -> float:
    return float(history[f"window_{name}"].values[0])


def by_hand(history: xr.Dataset, heat: Any) -> np.ndarray:
    """Blok's formula for the heat over the width of all pairs [W/m]."""
    base = [MODULE * z / 2 * math.cos(math.radians(20)) for z in TEETH]
    line = sum(base) * math.tan(float(history.working_pressure_angle[0]))
    omega = np.abs(history.angular_velocity.values)
    rho_a, h = of_pairs(history, "pair_position"), of_pairs(history, "pair_penetration")
    rho_b = line + h - rho_a
    v_a, v_b = omega[:, :1] * (rho_a - h / 2), omega[:, 1:] * (rho_b - h / 2)
    load = of_pairs(history, "pair_normal_force") / WIDTH
    e_star = STEEL["youngs_modulus"] / (2 * (1 - STEEL["poisson_ratio"] ** 2))
    half_width = np.sqrt(4 * load / (np.pi * e_star * (1 / rho_a + 1 / rho_b)))
    coefficient = math.sqrt(CONDUCTIVITY * STEEL["density"] * HEAT)
    given = heat(load, v_a, v_b)
    return 1.11 * given / (coefficient * (np.sqrt(v_a) + np.sqrt(v_b)) * np.sqrt(2 * half_width))


def test_the_temperatures_are_those_of_the_formula(runs) -> None:
    run = runs(case())
    assert run.exit_code == 0, run.messages
    h = run.history
    flash, contact = of_pairs(h, FLASH), of_pairs(h, CONTACT)
    load, slides = of_pairs(h, "pair_normal_force"), np.abs(of_pairs(h, "pair_sliding_velocity"))
    expected = by_hand(h, lambda w, v_a, v_b: MU * w * np.abs(v_a - v_b))
    full = (load > 1) & (slides > 2e-3)  # friction is fully developed
    assert full.sum() > 500
    np.testing.assert_allclose(flash[full], expected[full], rtol=1e-7)
    assert flash[full].max() > 10
    assert (flash[load == 0] == 0).all()
    np.testing.assert_array_equal(contact, BULK + flash)
    assert h[FLASH].attrs["units"] == h[CONTACT].attrs["units"] == "K"


def test_a_local_coefficient_counts_with_its_friction_force(runs) -> None:
    h = runs(case("benedict_kelley")).history
    heat = np.abs(of_pairs(h, "pair_friction_force") * of_pairs(h, "pair_sliding_velocity")) / WIDTH
    loaded = of_pairs(h, "pair_normal_force") > 1
    expected = by_hand(h, lambda _w, _a, _b: heat)
    np.testing.assert_allclose(of_pairs(h, FLASH)[loaded], expected[loaded], rtol=1e-7)


def test_a_mesh_may_replace_the_bulk_temperature(runs) -> None:
    one = case(lubricant={"bulk_temperature": "100 degC"})
    h = runs(one).history
    np.testing.assert_array_equal(of_pairs(h, CONTACT), 373.15 + of_pairs(h, FLASH))


def test_both_senses_of_rotation_are_mirror_images(runs) -> None:
    one = case()
    h, other = runs(one).history, runs(mirrored(one)).history
    np.testing.assert_allclose(of_pairs(other, FLASH), of_pairs(h, FLASH), rtol=1e-6, atol=1e-6)
    for name in METRICS:
        assert window(other, name) == pytest.approx(window(h, name), rel=1e-8)


@pytest.mark.parametrize(
    "scales", [Scales(length=8.0), Scales(time=0.25), Scales(mass=16.0), Scales(4.0, 0.5, 2.0)]
)
def test_units_of_length_time_and_mass_do_not_matter(runs, scales: Scales) -> None:
    one = case()
    material, lubricant = one["materials"]["steel"], one["lubricant"]
    material |= {"thermal_conductivity": CONDUCTIVITY, "specific_heat": HEAT}
    lubricant |= {"viscosity": 0.02, "roughness": 5e-7, "bulk_temperature": BULK}
    h = runs(one).history
    other = runs(scaled_case(runs.executable, one, scales)).history
    for name in METRICS:
        assert window(other, name) == pytest.approx(window(h, name), rel=1e-6)


def test_metrics_do_not_depend_on_outputs_and_integrator(runs) -> None:
    one = case()
    fine = "simulation.accuracy=1e-7"
    plain, coarse = (
        runs(one, f"simulation.output_interval={dt}").history for dt in ("10 us", "1 ms")
    )
    radau, ida, dense = (
        runs(one, fine, f"simulation.{setting}").history
        for setting in ("integrator=radau", "integrator=ida", "output_interval=0.5 us")
    )
    inside = (dense.time >= dense.window_begin) & (dense.time <= dense.window_end)
    for name, output in zip(METRICS, (FLASH, CONTACT), strict=True):
        assert window(coarse, name) == window(plain, name)
        assert window(ida, name) == pytest.approx(window(radau, name), rel=1e-4)
        seen = float(dense[output][inside].max())
        gain = window(dense, name) / seen - 1
        assert -1e-9 < gain < 1e-3  # the largest is at the end of the path, between two outputs
    assert window(plain, METRICS[1]) == pytest.approx(BULK + window(plain, METRICS[0]), rel=1e-12)


def test_tip_edges_have_no_temperature_and_the_metrics_leave_them_out(runs) -> None:
    """Teeth without relief bend and touch with their tip edges."""
    one = case()
    for wheel in one["wheels"]:
        wheel |= {"bore": 0.02, "tip_rounding": 2e-4, "compliance": {"model": "analytic"}}
    h = runs(one).history
    load, kind = of_pairs(h, "pair_normal_force"), of_pairs(h, "pair_contact_kind")
    flash = of_pairs(h, FLASH)
    on_edge = (load > 0) & (kind > 0)
    assert on_edge.sum() > 5
    assert np.isfinite(of_pairs(h, "pair_contact_pressure")[on_edge]).all()
    assert np.isnan(flash[on_edge]).all()
    assert np.isnan(of_pairs(h, CONTACT)[on_edge]).all()
    assert np.isfinite(flash[~on_edge]).all()
    inside = ((h.time >= h.window_begin) & (h.time <= h.window_end)).values
    seen = np.nanmax(flash[inside])
    assert seen * (1 - 1e-9) <= window(h, METRICS[0]) < 1.1 * seen


def test_the_summary_prints_them_and_all_excludes_them(runs) -> None:
    one = case()
    run = runs(one)
    flash, contact = (window(run.history, name) for name in METRICS)
    text = f"; flash temperature of the flanks {flash:.4g} K, contact temperature {contact:.4g} K"
    assert f"{text} ({contact - 273.15:.4g} degC)" in run.messages
    plain = runs(one, "simulation.outputs=all")
    assert "temperature" not in plain.messages
    assert not [name for name in plain.history.variables if "temperature" in str(name)]
    for name in ("pair_normal_force", "window_pair_normal_force_max"):  # the same bits
        np.testing.assert_array_equal(plain.history[name], run.history[name])


MISSING = {
    "bulk_temperature": (
        "meshes.pinion-gear.lubricant.bulk_temperature: the contact temperature needs the bulk"
        " temperature of the teeth; give the case, or this mesh, lubricant:"
        " {bulk_temperature: 90 degC}"
    ),
    "thermal_conductivity": (
        "wheels.pinion.material: the flash temperature needs the thermal conductivity of material"
        " 'steel'; give it thermal_conductivity, for steel about 45 W/(m K)"
    ),
    "specific_heat": (
        "wheels.pinion.material: the flash temperature needs the specific heat of material"
        " 'steel'; give it specific_heat, for steel about 460 J/(kg K)"
    ),
    "friction": (
        "meshes.pinion-gear.friction.law: the flash temperature needs the friction of this mesh,"
        " whose law is none; choose a law, such as friction: {law: coulomb, coefficient: 0.05}"
    ),
}


@pytest.mark.parametrize("key", MISSING)
@pytest.mark.parametrize("output", [FLASH, CONTACT])
def test_missing_data_are_refused_with_their_location_and_remedy(
    evolvent: Evolvent, tmp_path: Path, key: str, output: str
) -> None:
    one = case()
    for block in (one["materials"]["steel"], one["lubricant"], one["meshes"][0]):
        block.pop(key, None)
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(one))
    for command in ("validate", "run"):
        words = ("-o", tmp_path / "h.h5") if command == "run" else ()
        done = evolvent(command, file, *words, "--set", f"simulation.outputs=all,{output}")
        assert done.returncode == 3
        (line,) = done.stderr.splitlines()
        assert line.endswith(MISSING[key])
    done = evolvent("run", file, "-q", "-o", tmp_path / "h.h5", "--outputs", "all")
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        (
            "lubricant.bulk_temperature=-300 degC",
            "is -300 degC (-26.85 K), must be greater than 0 K",
        ),
        ("lubricant.bulk_temperature=90 degF", "the unit 'degF' is unknown"),
        ("lubricant.bulk_temperature=0 K", "must be greater than 0 K"),
        ("materials.steel.specific_heat=-1", "must be greater than 0 J/(kg K)"),
        (
            "materials.steel.thermal_conductivity=45 W/m",
            "write the thermal conductivity in W/(m K)",
        ),
    ],
)
def test_values_out_of_range_are_refused(
    evolvent: Evolvent, tmp_path: Path, setting: str, message: str
) -> None:
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(case()))
    done = evolvent("validate", file, "--set", setting)
    assert done.returncode == 3
    assert message in done.stderr


def test_degrees_without_a_unit_are_implausible(evolvent: Evolvent, tmp_path: Path) -> None:
    file = tmp_path / "case.yaml"
    file.write_text(json.dumps(case()))
    done = evolvent("validate", file, "--set", "lubricant.bulk_temperature=90")
    assert "did you mean 90 degC?" in done.stderr


# ---- batches


def batch(
    evolvent: Evolvent, folder: Path, one: dict[str, Any], metrics: str, **options: str
) -> subprocess.CompletedProcess[str]:
    """Run a batch of two bulk temperatures [K]."""
    columns = {"lubricant.bulk_temperature": [BULK, BULK + 10.0]}
    write_design(folder / "design.h5", columns, json.dumps(one), numbers=metrics, **options)
    return evolvent("batch", folder / "design.h5", "-o", folder / "r")


def test_a_plan_names_what_its_case_does_not(evolvent: Evolvent, tmp_path: Path, runs) -> None:
    run = runs(case()).history
    one = case()
    del one["simulation"]["outputs"]
    done = batch(evolvent, tmp_path, one, "temperature", histories=CONTACT)
    assert done.returncode == 0, done.stderr
    rows = read_folder(tmp_path / "r")
    first, second = rows[0], rows[1]
    for name in METRICS:
        assert first[name] == pytest.approx(window(run, name), rel=1e-9)
    assert second[METRICS[0]] == first[METRICS[0]]
    assert second[METRICS[1]] == pytest.approx(first[METRICS[1]] + 10, rel=1e-12)


def test_all_metrics_exclude_the_temperatures(evolvent: Evolvent, tmp_path: Path) -> None:
    assert batch(evolvent, tmp_path, case(), "all").returncode == 0
    assert not [name for name in read_folder(tmp_path / "r")[0] if "temperature" in name]


def test_responses_have_no_temperatures(evolvent: Evolvent, tmp_path: Path) -> None:
    done = batch(
        evolvent,
        tmp_path,
        case(),
        METRICS[0],
        respond_over="wheels.pinion.loads.0.value=-150:-140:2",
    )
    assert done.returncode == 3
    assert "responses have no metrics of the temperatures" in done.stderr
