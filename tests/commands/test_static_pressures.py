"""Contact pressure at the points A to E of the path, and sharp edges beside its maximum."""

from __future__ import annotations

import copy
import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
import yaml

from commands.datasheet_cases import pair

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

POINTS = "abcde"


@pytest.fixture
def fzg() -> dict[str, Any]:
    """FZG gears type C; --torque is that of load stage 9."""
    common = {"module": 4.5e-3, "thickness_allowance": -6e-5, "bore": 0.03, "width": 0.014}
    steel = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830}
    gears = (("pinion", 16, 0.1817, 0.08246), ("gear", 24, 0.1715, 0.11836))
    return {
        "format": 1,
        "materials": {"steel": steel},
        "wheels": [
            {
                **{"name": name, "teeth": teeth, "profile_shift": shift, "tip_diameter": tip},
                **{**common, "material": "steel", "compliance": {}},
            }
            for name, teeth, shift, tip in gears
        ],
        "meshes": [
            {
                **{"driving": "pinion", "driven": "gear", "driving_rotation": "counterclockwise"},
                **{"centre_line_angle": 0, "centre_distance": 0.0915},
                "contact": {"law": "johnson"},
            }
        ],
        "simulation": {"duration": 0.01, "output_interval": 0.001},
    }


def solved(
    evolvent: Evolvent, folder: Path, case: dict[str, Any], torque: float = 302.0, *words: str
) -> dict[str, float]:
    """Results of `static` at one torque."""
    (folder / "case.yaml").write_text(yaml.safe_dump(case, sort_keys=False))
    given = ("--torque", repr(torque), "-o", folder / "static.h5", "--json", *words)
    done = evolvent("static", folder / "case.yaml", *given)
    assert done.returncode == 0, done.stderr
    reported = json.loads(done.stdout)
    return {k: v[0] if isinstance(v, list) else v for k, v in reported.items()}


def test_fzg_gears_have_the_pressures_of_a_hand_calculation(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    """By hand: 1655.6 MPa at C, 1779 MPa at B under full load; compliant teeth: 1730 MPa."""
    found = solved(evolvent, tmp_path, fzg)
    assert found["nominal_pressure_at_c"] == pytest.approx(1655.6e6, abs=0.1e6)
    assert found["nominal_pressure_at_b"] == pytest.approx(1779e6, abs=1e6)
    assert found["largest_contact_pressure"] == pytest.approx(1730e6, rel=5e-3)
    # a single pair at C has the nominal force
    assert found["contact_pressure_at_c"] == pytest.approx(1655.6e6, rel=1e-3)
    for point in POINTS:
        assert found[f"contact_pressure_at_{point}"] > 0
        assert found[f"contact_pressure_at_{point}"] <= found["largest_contact_pressure"] * (
            1 + 1e-6
        )
    sheet = evolvent(
        "datasheet",
        tmp_path / "case.yaml",
        "--json",
        "--set",
        "wheels.pinion.loads=[{kind: torque, value: 302}]",
        "--set",
        "wheels.gear.loads=[{kind: torque, value: 453}]",
    )
    rows = {row["key"]: row["values"][0] for row in json.loads(sheet.stdout)["rows"]}
    for point in POINTS:
        assert found[f"nominal_pressure_at_{point}"] == pytest.approx(
            rows[f"pressure_{point}"], rel=1e-12
        )


def test_pressures_are_those_of_the_pair_at_the_points(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    found = solved(evolvent, tmp_path, fzg, 302.0, "--points", "2000")
    rows = json.loads(evolvent("datasheet", tmp_path / "case.yaml", "--json").stdout)["rows"]
    rho = {row["key"]: row["values"][0] for row in rows}
    with xr.open_dataset(tmp_path / "static.h5", engine="h5netcdf") as file:
        static = file.load().isel(torque=0)
    flank = (static["pair_contact_kind"] == 1).values
    at = static["pair_position"].values[flank]
    pressure = static["pair_contact_pressure"].values[flank]
    order = np.argsort(at)
    for point in "bcd":
        there = np.interp(rho[f"curvature_{point}"], at[order], pressure[order])
        assert found[f"contact_pressure_at_{point}"] == pytest.approx(there, rel=2e-3), point
    # the ends of contact of the flanks
    for point, k in (("a", 0), ("e", -1)):
        assert found[f"contact_pressure_at_{point}"] == pytest.approx(
            pressure[order][k], rel=5e-3
        ), point


def test_contacts_only_share_the_load_nearly_by_geometry(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    """Equal pairs of a stiff mesh: B and D in single contact have the full load."""
    for wheel in fzg["wheels"]:
        del wheel["compliance"]
    found = solved(evolvent, tmp_path, fzg, 30.0)
    for point in "bcd":
        assert found[f"contact_pressure_at_{point}"] == pytest.approx(
            found[f"nominal_pressure_at_{point}"], rel=1e-4
        )
    assert found["sharp_edge_force"] == 0


@pytest.mark.parametrize("torque", [3.0, 302.0, 3000.0])
def test_the_end_of_the_driven_flank_is_loaded_where_a_pair_takes_its_load_at_once(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any], torque: float
) -> None:
    """The transmission error jumps where pairs without compliance begin; edge contact has no jump.

    Corner contact before A only changes the force of the pair at A by its own compliance.
    """
    for wheel in fzg["wheels"]:
        del wheel["compliance"]
    jumps = solved(evolvent, tmp_path, fzg, torque)
    fzg["meshes"][0]["edge_contact"] = True
    smooth = solved(evolvent, tmp_path, fzg, torque)
    for point in "ae":
        name = f"contact_pressure_at_{point}"
        assert jumps[name] > 0.5 * jumps["nominal_pressure_at_a"]
        assert jumps[name] == pytest.approx(smooth[name], rel=0.01)


def test_a_relieved_end_of_the_path_carries_nothing(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    for wheel in fzg["wheels"]:
        wheel["tip_relief"] = {"amount": 1e-4, "diameter": wheel["tip_diameter"] - 2e-3}
    found = solved(evolvent, tmp_path, fzg, 100.0)
    assert found["contact_pressure_at_a"] == found["contact_pressure_at_e"] == 0
    assert found["contact_pressure_at_c"] > 0
    assert found["sharp_edge_force"] == 0


@pytest.mark.parametrize("sense", ["clockwise", "counterclockwise"])
def test_coast_flanks_and_the_other_rotation_are_mirror_images(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any], sense: str
) -> None:
    one = solved(evolvent, tmp_path, fzg)
    other = copy.deepcopy(fzg)
    other["meshes"][0]["driving_rotation"] = sense
    for torque in (302.0, -302.0):
        found = solved(evolvent, tmp_path, other, torque)
        for point in POINTS:
            for kind in ("contact_pressure_at_", "nominal_pressure_at_"):
                assert found[kind + point] == pytest.approx(one[kind + point], rel=1e-5), point
        assert found["sharp_edge_force"] == pytest.approx(one["sharp_edge_force"], rel=1e-4)


def test_a_driving_gear_has_the_points_from_its_own_root(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    """The path is run through from the other end: A and E, B and D are exchanged."""
    one = solved(evolvent, tmp_path, fzg)
    fzg["meshes"][0].update(driving="gear", driven="pinion", driving_rotation="clockwise")
    found = solved(evolvent, tmp_path, fzg, 453.0)
    for point, other in zip("bcd", "dcb", strict=True):
        assert found[f"nominal_pressure_at_{point}"] == pytest.approx(
            one[f"nominal_pressure_at_{other}"], rel=1e-9
        )
        # on the undeformed driving flank: the transmission error moves the point
        assert found[f"contact_pressure_at_{point}"] == pytest.approx(
            one[f"contact_pressure_at_{other}"], rel=0.02
        )


def test_every_largest_pressure_names_the_sharp_edges_it_leaves_out(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    found = solved(evolvent, tmp_path, fzg)
    force = found["sharp_edge_force"]
    assert force == pytest.approx(found["largest_edge_force"], rel=1e-9)
    assert force > 1000
    words = ("static", tmp_path / "case.yaml", "--torque", "302", "-o", tmp_path / "s.h5")
    text = evolvent(*words).stdout
    note = f"corner contact, no rounding given: pressure undefined, force {force / 1e3:.3g} kN"
    (row,) = [line for line in text.splitlines() if "quasi-static " in line and note in line]
    printed = [float(word) for word in row.split(";")[0].split()[2:]]
    expected = [found[f"contact_pressure_at_{point}"] for point in POINTS]
    expected.append(found["largest_contact_pressure"])
    assert printed == pytest.approx([value * 1e-6 for value in expected], rel=6e-4)
    (row,) = re.findall(r"^ +nominal +302 +(.*)$", text, re.MULTILINE)
    expected = [found[f"nominal_pressure_at_{point}"] * 1e-6 for point in POINTS]
    assert [float(word) for word in row.split()] == pytest.approx(expected, rel=6e-4)
    with xr.open_dataset(tmp_path / "s.h5", engine="h5netcdf") as file:
        assert float(file["sharp_edge_force"][0]) == pytest.approx(force, rel=1e-12)
    rounded = [f"wheels.{name}.tip_rounding=0.3 mm" for name in ("pinion", "gear")]
    sets = [word for value in rounded for word in ("--set", value)]
    text = evolvent(*words, *sets).stdout
    assert "no rounding given" not in text


def test_a_rounded_corner_counts_in_the_maximum(
    evolvent: Evolvent, tmp_path: Path, fzg: dict[str, Any]
) -> None:
    """Hertz: p^2 = N E*/(pi) (1/rho_mate + 1/r_t); the rounding is sharper than any flank."""
    rounding = 3e-4
    for wheel in fzg["wheels"]:
        wheel["tip_rounding"] = rounding
    found = solved(evolvent, tmp_path, fzg, 302.0, "--points", "1000")
    with xr.open_dataset(tmp_path / "static.h5", engine="h5netcdf") as file:
        static = file.load().isel(torque=0)
    edge = (static["pair_contact_kind"] > 1).values
    largest = float(static["pair_contact_pressure"].values[edge].max())
    assert found["largest_contact_pressure"] >= largest > found["contact_pressure_at_b"]
    at = np.unravel_index(
        np.nanargmax(np.where(edge, static["pair_contact_pressure"].values, np.nan)), edge.shape
    )
    mate = (
        "pair_position" if static["pair_contact_kind"].values[at] == 3 else "pair_position_driven"
    )
    e_star = 2.06e11 / (2 * (1 - 0.3**2))
    line_load = float(static["pair_normal_force"].values[at]) / 0.014
    curvature = 1 / float(static[mate].values[at]) + 1 / rounding
    assert largest == pytest.approx(np.sqrt(line_load * e_star / np.pi * curvature), rel=1e-3)


def test_a_concave_relief_without_pressure_is_named(evolvent: Evolvent, tmp_path: Path) -> None:
    """A steep linear relief that begins shortly below point D."""
    rack = {"addendum": 0.76, "dedendum": 0.93, "root_radius": 0.14}
    common = {"module": 1e-3, "pressure_angle": 14.5, "rack": rack}
    relief = {"amount": 2.4e-5, "diameter": 46.7e-3}
    case = pair(
        {**common, "teeth": 45, "profile_shift": 0.37, "tip_alteration": -0.245},
        {**common, "teeth": 26, "profile_shift": 0.4, "tip_rounding": 8e-5},
        backlash=1e-4,
    )
    remark = "Largest pressure without point D: a relieved flank is too concave there"
    path = tmp_path / "case.yaml"
    for relieved in (False, True):
        if relieved:
            case["wheels"][0]["tip_relief"] = relief
        path.write_text(yaml.safe_dump(case, sort_keys=False))
        done = evolvent("static", path, "--torque", "0.01", "-o", tmp_path / "static.h5")
        assert done.returncode == 0
        assert (remark in done.stdout) == relieved
        row = next(line for line in done.stdout.splitlines() if "quasi-static  " in line)
        assert (row.split()[5] == "-") == relieved
