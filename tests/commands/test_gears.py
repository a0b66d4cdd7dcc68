"""Gears defined by a basic rack: output of `show`, and rejected input with locations."""

from __future__ import annotations

import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
CASE = 3


def shown(evolvent: Evolvent, case: Path, *options: str) -> dict[str, Any]:
    words = [word for option in options for word in ("--set", option)]
    result = evolvent("show", case, "--json", *words)
    assert result.returncode == 0, result.stderr
    return json.loads(result.stdout)


def refused(evolvent: Evolvent, case: Path, *options: str) -> str:
    words = [word for option in options for word in ("--set", option)]
    result = evolvent("run", case, *words)
    assert result.returncode == CASE
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    return result.stderr


def test_show_gives_the_reference_values_in_si(evolvent: Evolvent, reference: Path) -> None:
    case = shown(evolvent, reference)
    mesh = case["meshes"]["pinion-gear"]["gear"]
    tolerance = {"rel": 1e-12}  # accuracy of the given values
    expected = {
        "centre_distance": 52.38927831334764e-3,
        "working_pressure_angle": np.radians(21.13868827687391),
        "line_of_action": 18.892972108605324e-3,
        "active_diameter_driving": 22.653576724323237e-3,
        "active_diameter_driven": 78.1051679820969e-3,
        "path_of_contact": 7.229131220081783e-3,
        "contact_ratio": 1.224391830355867,
    }
    for name, value in expected.items():
        assert mesh[name] == pytest.approx(value, **tolerance), name
    assert mesh["backlash"] == 0
    assert case["wheels"]["pinion"]["gear"]["base_diameter"] == pytest.approx(
        0.024 * np.cos(np.radians(20)), **tolerance
    )


def test_show_prints_symbols_of_iso_21771_with_lengths_in_mm_and_angles_in_degrees(
    evolvent: Evolvent, reference: Path
) -> None:
    text = evolvent("show", reference).stdout
    rows = {
        match[1]: match[2].split()
        for match in re.finditer(
            r"^  \S.*? {2,}(\S+) +(?:mm|um|deg)? +([-\d. ]+)$", text, re.MULTILINE
        )
    }
    assert rows["z"] == ["12", "40"]
    assert rows["m_n"] == ["2", "2"]
    assert rows["alpha_n"] == ["20", "20"]
    assert rows["x"] == ["0.3", "-0.1"]
    assert rows["d"] == ["24", "80"]
    assert rows["d_a"] == ["28", "83.2"]
    assert rows["a_w"] == ["52.38927831"]
    assert rows["alpha_wt"] == ["21.13868828"]
    assert rows["eps_alpha"] == ["1.22439183"]
    symbols = "z m_n alpha_n x d d_b d_a d_f d_Ff h s_n s_an"
    symbols += " a_w a alpha_wt d_w1 d_w2 d_Nf1 d_Nf2 g_alpha g_f g_a p_bt c_1 c_2 j_bn j_wt j_r"
    assert set(symbols.split()) <= set(rows)


def test_show_prints_a_column_for_each_gear_and_no_table_without_gears(
    evolvent: Evolvent, examples: Path, reference_case: dict[str, Any], tmp_path: Path
) -> None:
    """Six gears in a row: four columns and two."""
    wheel = reference_case["wheels"][1]
    reference_case["wheels"] = [{**wheel, "name": f"gear-{i}"} for i in range(6)]
    reference_case["meshes"] = [
        {
            **{"driving": f"gear-{i}", "driven": f"gear-{i + 1}", "centre_line_angle": 0},
            "driving_rotation": "clockwise",
        }
        for i in range(5)
    ]
    path = tmp_path / "row.yaml"
    path.write_text(json.dumps(reference_case))
    text = evolvent("show", path).stdout
    assert text.count("\nGears (ISO 21771)\n") == 2
    assert re.search(r"^ +gear-0 +gear-1 +gear-2 +gear-3$", text, re.MULTILINE)
    assert re.search(r"^ +gear-4 +gear-5$", text, re.MULTILINE)
    assert "ISO 21771" not in evolvent("show", examples / "paper.yaml").stdout
    assert "gear" not in shown(evolvent, examples / "paper.yaml")["wheels"]["pinion"]


def test_the_resolved_case_has_the_defaults_of_a_gear_and_means_the_same(
    evolvent: Evolvent, reference: Path, tmp_path: Path
) -> None:
    first = shown(evolvent, reference)
    pinion = first["case"]["wheels"][0]
    assert pinion["pressure_angle"] == 20
    # the addendum has another default for internal gears: like tip_alteration it stays absent
    assert pinion["rack"] == {"dedendum": 1.25, "root_radius": 0.38}
    assert pinion["bore"] == 0
    again = tmp_path / "again.yaml"
    again.write_text(json.dumps(first["case"]))
    second = shown(evolvent, again)
    for part in ("case", "wheels", "meshes"):
        assert second[part] == first[part]


def test_a_wheel_without_module_gets_no_keys_of_a_gear(evolvent: Evolvent, examples: Path) -> None:
    pinion = shown(evolvent, examples / "paper.yaml")["case"]["wheels"][0]
    assert not {"module", "pressure_angle", "profile_shift", "rack", "bore"} & set(pinion)


def test_the_example_has_contact_ratio_one_and_a_half_and_backlash(
    evolvent: Evolvent, examples: Path
) -> None:
    case = shown(evolvent, examples / "spur-pair.yaml")
    mesh = case["meshes"]["pinion-gear"]["gear"]
    # the values in its comments
    assert mesh["contact_ratio"] == pytest.approx(1.496, abs=5e-4)
    assert mesh["backlash"] == pytest.approx(66.8e-6, abs=5e-8)
    assert case["warnings"] == []


def test_backlash_and_centre_distance_state_the_same_pair(
    evolvent: Evolvent, reference: Path
) -> None:
    by_backlash = shown(evolvent, reference, "meshes.0.backlash=1e-4")["meshes"]["pinion-gear"]
    distance = by_backlash["gear"]["centre_distance"]
    option = f"meshes.0.centre_distance={distance!r}"
    by_distance = shown(evolvent, reference, option)["meshes"]["pinion-gear"]
    assert by_distance["gear"]["backlash"] == pytest.approx(1e-4, abs=1e-16)
    both = shown(evolvent, reference, option, "meshes.0.backlash=1e-4")["meshes"]["pinion-gear"]
    assert both["gear"]["centre_distance"] == distance


PINION, MESH = "wheels.pinion", "meshes.pinion-gear"
REFUSED = {
    "flat flanks": ("wheels.0.pressure_angle=3", f"{PINION}.pressure_angle: is 3 deg, must be"),
    "thicker teeth": ("wheels.0.thickness_allowance=1e-5", "is 1e-5 m, must be at most 0 m"),
    "no module": ("wheels.0.module=0", "is 0 m, must be greater than 0 m"),
    "a misspelt rack": ("wheels.0.rack={adendum: 1}", "(did you mean 'addendum'?)"),
    "a full rounding and more": ("wheels.0.rack.root_radius=0.5", "0.5 of the rack is more than"),
    "two tips": (
        "wheels.0.tip_alteration=0.1",
        f"{PINION}.tip_diameter: tip diameter 0.028 m does",
    ),
    "pointed": ("wheels.0.tip_diameter=0.0325", f"{PINION}.tip_diameter: the tooth is pointed"),
    "a bore through": (
        "wheels.1.bore=0.08",
        "wheels.gear.bore: the bore, diameter 0.08 m, must be",
    ),
    "another pitch radius": (
        "wheels.0.pitch_radius=0.013",
        "pitch radius 0.013 m does not agree with the reference radius 0.012 m",
    ),
    "another module": ("wheels.1.module=0.0021", f"{MESH}: its wheels cannot mesh: the base pitch"),
    "a wheel without module": (
        "wheels.1={name: gear, teeth: 40, width: 0.02, material: steel}",
        f"{MESH}: one of its wheels has a module and the other has none; give both a module",
    ),
    "a pressure angle": ("meshes.0.pressure_angle=20", f"{MESH}.pressure_angle: a pressure angle"),
    "the paper's rule": ("meshes.0.pressure_angle=paper_rule", f"{MESH}.pressure_angle: "),
    "too close": ("meshes.0.centre_distance=0.052", "the normal backlash would be -2.73616E-04 m"),
    "inside the base circles": ("meshes.0.centre_distance=0.048", "the sum of the base radii"),
    "out of reach": ("meshes.0.centre_distance=0.06", "its teeth do not reach each other"),
    "a negative backlash": ("meshes.0.backlash=-1e-6", "is -1e-6 m, must be at least 0 m"),
    "a tip past the base circle": (
        "wheels.1.tip_diameter=0.0842",
        "a tip diameter of at most 0.0841375 m avoids it",
    ),
}


@pytest.mark.parametrize(("option", "reason"), REFUSED.values(), ids=list(REFUSED))
def test_gears_that_cannot_be_made_or_mesh_are_refused_with_the_reason(
    evolvent: Evolvent, reference: Path, option: str, reason: str
) -> None:
    assert reason in refused(evolvent, reference, option)


def test_two_centres_have_to_agree_with_the_centre_distance(
    evolvent: Evolvent, reference: Path
) -> None:
    centres = ("wheels.0.centre=[0, 0]", "wheels.1.centre=[0.053, 0]")
    line = refused(evolvent, reference, *centres)
    assert "are 0.053 m apart, but its centre distance is 0.0523893 m" in line
    shown(evolvent, reference, *centres, "meshes.0.centre_distance=0.053")


def test_keys_of_a_gear_need_a_module(evolvent: Evolvent, examples: Path) -> None:
    line = refused(evolvent, examples / "paper.yaml", "wheels.pinion.profile_shift=0.1")
    assert "wheels.pinion: 'profile_shift' needs 'module' in the same block" in line


def test_one_module_is_not_enough(evolvent: Evolvent, examples: Path) -> None:
    line = refused(evolvent, examples / "paper.yaml", "wheels.pinion.module=0.02")
    assert "one of its wheels has a module and the other has none" in line


def test_a_centre_distance_needs_real_gears(evolvent: Evolvent, examples: Path) -> None:
    line = refused(evolvent, examples / "paper.yaml", "meshes.0.centre_distance=0.5")
    assert "meshes.pinion-gear.centre_distance: a centre distance is for two wheels" in line


def test_a_distance_and_a_backlash_that_contradict_each_other_are_refused(
    evolvent: Evolvent, reference: Path
) -> None:
    line = refused(evolvent, reference, "meshes.0.centre_distance=0.0525", "meshes.0.backlash=1e-4")
    assert "meshes.pinion-gear.backlash: backlash 1E-04 m does not agree with" in line


@pytest.mark.parametrize(
    ("option", "warning"),
    [
        (
            "wheels.0.tip_diameter=0.03",
            "wheels.pinion: the tooth is 2.06233E-04 m thick on the tip",
        ),
        (
            "meshes.0.centre_distance=0.054",
            "meshes.pinion-gear: its contact ratio is 0.531337, less than 1",
        ),
    ],
)
def test_what_is_allowed_but_unwise_is_a_warning(
    evolvent: Evolvent, reference: Path, option: str, warning: str
) -> None:
    (text,) = shown(evolvent, reference, option)["warnings"]
    assert text.startswith(warning)


def test_a_wheel_that_gave_way_is_shown_and_recorded_as_it_is(
    evolvent: Evolvent, examples: Path, tmp_path: Path
) -> None:
    """Rounded data: the driven wheel's allowance is the given one less the overlap."""
    options = ("meshes.0.centre_distance=0.0808122", "simulation.duration=1e-4")
    rounded = shown(evolvent, examples / "spur-pair.yaml", *options)
    (warning,) = rounded["warnings"]
    overlap = re.search(r"backlash would be -(\S+) m", warning)
    assert overlap
    gear = rounded["wheels"]["gear"]["gear"]
    allowance = -5e-5 - float(overlap[1]) / np.cos(np.radians(20))
    # the warning prints six digits of a third of a micrometre
    assert gear["thickness_allowance"] == pytest.approx(allowance, abs=1e-12)
    words = [word for option in options for word in ("--set", option)]
    assert evolvent("run", examples / "spur-pair.yaml", *words, "-o", "x.h5").returncode == 0
    with xr.open_dataset(tmp_path / "x.h5", engine="h5netcdf") as history:
        assert float(history["backlash"][0]) == 0
        assert float(history["tooth_angle"][1]) == gear["tooth_angle"]
