"""Root stress in the commands: nominal stress beside finite elements."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

COS = math.cos(math.radians(20))
BASE_PITCH = math.pi * 3 * COS  # mm

# z, x, bore [mm]: rho [mm], m sigma/N: tension, compression; Y_F Y_S cos(alpha). By other programs.
ACCEPTED = {
    (50, 0.0, 40.0): (29.3098, 2.6915, -3.2930, 2.8662),
    (19, 0.4, 25.0): (15.7846, 2.6610, -3.4426, 2.9713),
    (40, 0.0, 36.0): (24.2484, 2.7535, -3.3702, 2.9227),
}
FORCE = 2000.0  # N
WIDTH = 20.0  # mm


def equal_pair(teeth: int, shift: float, bore: float, distance: float) -> str:
    """Two equal wheels of module 3 mm under FORCE."""
    wheel = (
        f"teeth: {teeth}, module: 3 mm, profile_shift: {shift}, bore: {bore} mm, "
        f"width: {WIDTH} mm, material: steel, compliance: {{}}"
    )
    torque = FORCE * 1.5 * teeth * COS / 1e3
    return f"""
format: 1
materials: {{steel: {{youngs_modulus: 206 GPa, poisson_ratio: 0.3, density: 7830 kg/m3}}}}
wheels:
- {{name: a, {wheel}, loads: [{{kind: torque, value: {-torque!r} N m}}]}}
- {{name: b, {wheel}, loads: [{{kind: torque, value: {-torque!r} N m}}]}}
meshes:
- {{name: a-b, driving: a, driven: b, driving_rotation: clockwise, centre_line_angle: 0 deg,
   centre_distance: {distance!r} mm, contact: {{law: johnson}}}}
simulation: {{duration: 1 ms, output_interval: 10 us}}
"""


def pair_with_load_at(teeth: int, shift: float, bore: float, rho: float) -> str:
    """Two equal wheels whose outer point of single contact is at rho [mm]."""
    base = 1.5 * teeth * COS
    tip = math.sqrt((1.5 * teeth + 3 * (1 + shift)) ** 2 - base**2)
    line = rho + tip - BASE_PITCH
    return equal_pair(teeth, shift, bore, math.hypot(line, 2 * base))


def shown(evolvent: Evolvent, case: Path, *options: str) -> dict[str, Any]:
    """The JSON of show."""
    given = [word for option in options for word in ("--set", option)]
    done = evolvent("show", case, "--json", *given)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(("wheel", "accepted"), ACCEPTED.items(), ids=map(str, ACCEPTED))
def test_show_prints_accepted_stresses_at_the_outer_point_of_single_contact(
    evolvent: Evolvent,
    tmp_path: Path,
    wheel: tuple[int, float, float],
    accepted: tuple[float, ...],
) -> None:
    rho, tension, compression, nominal = accepted
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(*wheel, rho))
    line_load = FORCE / WIDTH  # N/mm
    both = shown(evolvent, case)["root_stress"]["a-b"]
    assert list(both) == ["driving", "driven"]
    for found in both.values():
        assert found["load_position"] == pytest.approx(rho / 1e3, rel=1e-12)
        assert found["line_load"] == pytest.approx(line_load * 1e3, rel=1e-9)
        assert found["tension_coefficient"] == pytest.approx(tension, rel=1e-3)
        assert found["compression_coefficient"] == pytest.approx(compression, rel=1e-3)
        assert found["nominal_coefficient"] == pytest.approx(nominal, rel=1e-4)
        factors = found["form_factor"] * found["stress_correction_factor"]
        assert found["nominal_coefficient"] == pytest.approx(factors * COS, rel=1e-12)
        # MPa = N/mm2
        for stress in ("nominal_stress", "tension", "compression"):
            coefficient = stress.replace("_stress", "") + "_coefficient"
            expected = found[coefficient] * line_load / 3 * 1e6
            assert found[stress] == pytest.approx(expected, rel=1e-9), stress


def test_text_and_json_have_the_same_root_stress(evolvent: Evolvent, examples: Path) -> None:
    case = examples / "compliant-pair.yaml"
    both = shown(evolvent, case)["root_stress"]["pinion-gear"]
    text = evolvent("show", case).stdout.split("Root stress in mesh pinion-gear")[1]
    lines = [line.split() for line in text.splitlines()]
    for symbol, name, factor in (
        ("Y_F", "form_factor", 1),
        ("Y_S", "stress_correction_factor", 1),
        ("q_s", "notch_parameter", 1),
        ("sigma_F0", "nominal_stress", 1e-6),
        ("Sigma_F", "tension_coefficient", 1),
        ("sigma_F-", "compression", 1e-6),
    ):
        row = next(line for line in lines if symbol in line and not line[0].startswith("Y_F"))
        printed = [float(word) for word in row[-2:]]
        expected = [both[side][name] * factor for side in ("driving", "driven")]
        assert printed == pytest.approx(expected, rel=1e-4), symbol
    assert "K_Fbeta = K_Hbeta = 1" in text
    assert "no friction along the flank" in text


def test_only_wheels_with_finite_elements_have_root_stress(
    evolvent: Evolvent, examples: Path
) -> None:
    case = examples / "compliant-pair.yaml"
    both = shown(evolvent, case)["root_stress"]["pinion-gear"]
    one = shown(evolvent, case, "wheels.gear.compliance={model: analytic}")["root_stress"]
    assert one == {"pinion-gear": {"driving": both["driving"]}}
    none = ("wheels.pinion.compliance={model: analytic}", "wheels.gear.compliance={model: none}")
    assert shown(evolvent, case, *none)["root_stress"] == {}
    done = evolvent("show", case, "--set", none[0], "--set", none[1])
    assert "Root stress" not in done.stdout


def test_a_sharp_notch_has_no_nominal_stress(evolvent: Evolvent, tmp_path: Path) -> None:
    """Y_S holds for q_s from 1 to 8."""
    case = tmp_path / "pair.yaml"
    case.write_text(pair_with_load_at(200, 0.0, 540.0, 103.2))
    sharp = "wheels.a.rack={root_radius: 0.02}"
    both = shown(evolvent, case, sharp)["root_stress"]["a-b"]
    assert both["driving"]["notch_parameter"] > 8
    assert both["driven"]["notch_parameter"] < 8
    assert both["driving"]["nominal_stress"] is None
    assert both["driving"]["nominal_coefficient"] is None
    assert both["driving"]["tension"] > both["driven"]["tension"]
    assert both["driven"]["nominal_stress"] > 0
    text = evolvent("show", case, "--set", sharp).stdout
    assert "No nominal stress of the driving wheel: q_s = " in text
    assert "No nominal stress of the driven wheel" not in text


def test_two_pairs_everywhere_have_no_single_contact(evolvent: Evolvent, tmp_path: Path) -> None:
    case = tmp_path / "pair.yaml"
    case.write_text(equal_pair(50, 0.0, 40.0, 150.05))
    high = [
        f"wheels.{name}.rack={{addendum: 1.3, dedendum: 1.5, root_radius: 0.3}}" for name in "ab"
    ]
    reported = shown(evolvent, case, *high)
    assert reported["meshes"]["a-b"]["contact_ratio"] > 2
    for found in reported["root_stress"]["a-b"].values():
        assert {name for name, value in found.items() if value is not None} == {"line_load"}
    given = [word for option in high for word in ("--set", option)]
    assert "no position has a single tooth pair" in evolvent("show", case, *given).stdout


def test_refused_cases_show_no_root_stress(evolvent: Evolvent, examples: Path) -> None:
    given = ("--set", "meshes.0.centre_distance=0.09")
    done = evolvent("show", examples / "compliant-pair.yaml", "--json", *given)
    assert done.returncode != 0
    assert json.loads(done.stdout)["root_stress"] == {}
