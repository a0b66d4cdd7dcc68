"""Extremes of the root stress between the positions of `static`, and where they occur."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

SIDES = ("driving", "driven")
KINDS = ("max", "min")
STEEL = {"youngs_modulus": "206 GPa", "poisson_ratio": 0.3, "density": "7830 kg/m3"}
MORE = ("", "_x", "_arc", "_tooth")
# both wheels, bores in mm; centre distance [mm]
PAIRS = {
    "almost undercut": (
        {"teeth": 15, "profile_shift": 0.13, "bore": 15},
        {"teeth": 40, "bore": 36},
        82.95,
    ),
    "small": ({"teeth": 9, "profile_shift": 0.5, "bore": 8}, {"teeth": 30, "bore": 30}, 60.0),
    "thin rim": ({"teeth": 40, "bore": 105}, {"teeth": 40, "bore": 105}, 120.2),
    "shifted": (
        {"teeth": 19, "profile_shift": 0.6, "bore": 25},
        {"teeth": 34, "profile_shift": -0.3, "bore": 30},
        80.4,
    ),
}
CASES = [(name, rounding) for name in PAIRS for rounding in (0.0, 0.15)]


def case_of(
    name: str, rounding: float = 0.15, *, mirrored: bool = False, swapped: bool = False
) -> dict[str, Any]:
    """Return a pair of module 3 mm with the loads of static analyses."""
    first, second, distance = PAIRS[name]
    common = {
        **{"module": "3 mm", "width": "20 mm", "material": "steel"},
        **{"compliance": {}, "tip_rounding": f"{rounding} mm"},
    }
    wheels = [
        {"name": wheel, **common, **given, "bore": f"{given['bore']} mm"}
        for wheel, given in zip("ab", (first, second), strict=True)
    ]
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": wheels[::-1] if swapped else wheels,
        "meshes": [
            {
                **{"name": "mesh", "driving": "a", "driven": "b"},
                "driving_rotation": "counterclockwise" if mirrored else "clockwise",
                **{"centre_line_angle": 0, "centre_distance": f"{distance} mm"},
                "contact": {"law": "johnson"},
            }
        ],
        "simulation": {"duration": "1 ms", "output_interval": "10 us"},
    }


def solved(
    evolvent: Evolvent, folder: Path, case: dict[str, Any], *words: str | float
) -> dict[str, Any]:
    """Results of `static`, JSON."""
    (folder / "case.yaml").write_text(yaml.safe_dump(case, sort_keys=False))
    given = ("-o", folder / "static.h5", "--json", *map(str, words))
    done = evolvent("static", folder / "case.yaml", *given)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(("name", "rounding"), CASES)
@pytest.mark.parametrize("torque", [3.0, 30.0])
def test_extremes_do_not_depend_on_the_number_of_positions(
    evolvent: Evolvent, tmp_path: Path, name: str, rounding: float, torque: float
) -> None:
    case = case_of(name, rounding)
    few, usual, many = (
        solved(evolvent, tmp_path, case, "--torque", torque, "--points", points)
        for points in (29, 200, 2003)
    )
    for side in SIDES:
        for kind in KINDS:
            key = f"root_stress_{kind}_{side}"
            exact = many[key][0]
            assert (exact > 0) == (kind == "max")
            for found in (few, usual):
                assert found[key] == pytest.approx([exact], rel=1e-4)
            # the same place, where an extreme is no plateau: at a maximum of a smooth function
            # positions differ by the square root of the accuracy
            here, there = (
                usual[f"{key.replace(kind, kind + '_arc')}"],
                many[f"{key.replace(kind, kind + '_arc')}"],
            )
            assert here == pytest.approx(there, rel=0.02)


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.parametrize("torque", [30.0, -30.0])
def test_mirrored_and_reordered_cases_have_the_same_extremes(
    evolvent: Evolvent, tmp_path: Path, name: str, torque: float
) -> None:
    one = solved(evolvent, tmp_path, case_of(name), "--torque", torque)
    mirrored = solved(evolvent, tmp_path, case_of(name, mirrored=True), "--torque", torque)
    swapped = solved(evolvent, tmp_path, case_of(name, swapped=True), "--torque", torque)
    reversed_ = solved(evolvent, tmp_path, case_of(name, mirrored=True), "--torque", -torque)
    for side in SIDES:
        for kind in KINDS:
            for more in MORE:
                key = f"root_stress_{kind}{more}_{side}"
                assert swapped[key] == pytest.approx(one[key], rel=1e-6), key
                if more not in ("_tooth",):
                    assert mirrored[key] == pytest.approx(one[key], rel=1e-6), key
                if more in ("", "_arc"):
                    assert reversed_[key] == pytest.approx(one[key], rel=1e-5), key


def test_the_extreme_is_that_of_a_position_there(evolvent: Evolvent, tmp_path: Path) -> None:
    """Positions on a fine grid: the nearest one has nearly the stress, the tooth and the arc."""
    import xarray as xr

    case = case_of("shifted")
    case["wheels"][0]["pitch_errors"] = [f"{5 * (-1) ** (i // 3)} um" for i in range(19)]
    found = solved(evolvent, tmp_path, case, "--torque", 60, "--points", 400)
    with xr.open_dataset(tmp_path / "static.h5", engine="h5netcdf") as file:
        static = file.load().isel(torque=0)
    assert found["pitches"] == 19
    for wheel, side in zip("ab", SIDES, strict=True):
        for kind in KINDS:
            position = found[f"root_stress_{kind}_x_{side}"][0]
            assert 0 <= position < 19
            near = static.sel(wheel=wheel).isel(
                position=[round(position * 400) % static.position.size]
            )
            for more, tolerance in (("", 0.01), ("_arc", 0.02), ("_tooth", 0)):
                expected = found[f"root_stress_{kind}{more}_{side}"][0]
                value = float(near[f"root_stress_{kind}{more}"].item())
                assert value == pytest.approx(expected, rel=tolerance, abs=0), (side, kind, more)


def test_wheels_without_finite_elements_have_no_extremes(
    evolvent: Evolvent, tmp_path: Path
) -> None:
    case = case_of("shifted")
    case["wheels"][1]["compliance"] = {"model": "analytic"}
    found = solved(evolvent, tmp_path, case, "--torque", 30)
    for kind in KINDS:
        for more in MORE:
            value = found[f"root_stress_{kind}{more}_driven"]
            assert value == ([-1] if more == "_tooth" else [None])
            assert np.isfinite(found[f"root_stress_{kind}{more}_driving"][0])
