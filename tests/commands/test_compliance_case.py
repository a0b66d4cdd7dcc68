"""Compliance of wheels: rejected input, and the output of show."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

CASE = 3
BLOCK = "wheels.pinion.compliance"
ELEMENTS = f"{BLOCK}={{}}"

# options; part of the message for the first
BAD_OPTIONS = {
    "no hub": (
        [ELEMENTS, "wheels.pinion.bore=0"],
        "hub_diameter: a solid wheel without fixed hub",
    ),
    "hub under the teeth": (
        [f"{BLOCK}={{hub_diameter: 0.05}}"],
        "hub_diameter: the wheel is held at a diameter of 0.05 m, too close to the root circle; "
        "give a hub_diameter of less than 0.0446176 m",
    ),
    "hub in the bore": (
        [f"{BLOCK}={{hub_diameter: 0.02}}"],
        "hub_diameter: hub_diameter 0.02 m is less than the bore of 0.025 m",
    ),
    "undercut": (
        [ELEMENTS, "wheels.pinion.profile_shift=-0.2", "meshes.0.centre_distance=0.0795"],
        "model: the teeth are undercut",
    ),
    "undercut, formulas": (
        [
            f"{BLOCK}={{model: analytic}}",
            "wheels.pinion.profile_shift=-0.2",
            "meshes.0.centre_distance=0.0795",
        ],
        "model: the teeth are undercut",
    ),
    "pointed tip": (
        [ELEMENTS, "wheels.pinion.profile_shift=1.05", "meshes.0.centre_distance=0.083"],
        "model: the teeth are 2.57447E-04 m thick at the tip, less than 0.1 modules",
    ),
    "falling table": (
        [f"{BLOCK}={{model: table, rho: [0.004, 0.003], c: [1e-11, 2e-11]}}"],
        "rho: the rhos of a table must increase: 0.003 m follows 0.004 m",
    ),
    "short table": (
        [f"{BLOCK}={{model: table, rho: [0.004], c: [1e-11]}}"],
        "rho: has 1 value, needs at least 2",
    ),
    "uneven table": (
        [f"{BLOCK}={{model: table, rho: [0.004, 0.005], c: [1e-11]}}"],
        "c: has 1 values, but rho has 2; they need the same number",
    ),
    "table without numbers": ([f"{BLOCK}={{model: table}}"], "'rho' is missing"),
    "neighbour that yields more than the tooth": (
        [f"{BLOCK}={{model: table, rho: [0.004, 0.018], c: [1e-11, 4e-11], c_1: [5e-10, 5e-10]}}"],
        "compliance.c_1: two loaded tooth pairs would have undefined forces: loaded at rho = 0.01",
    ),
    "teeth that no mesh fits": (
        [
            "wheels.0={name: pinion, teeth: 3, module: 3.0e-3, pressure_angle: 10, width: 0.02, "
            "profile_shift: 0.99081, rack: {addendum: 0.32315, dedendum: 0.80604, "
            "root_radius: 0.05}, material: steel, compliance: {hub_diameter: 0.947e-3, order: 4}}",
            "wheels.1={name: gear, teeth: 60, module: 3.0e-3, pressure_angle: 10, width: 0.02, "
            "rack: {addendum: 0.32315, dedendum: 0.9, root_radius: 0}, material: steel}",
            "meshes.0={driving: pinion, driven: gear, driving_rotation: clockwise, "
            "centre_line_angle: 0}",
        ],
        "compliance: no mesh fits the tooth: element 63, under the fillet and the root, would fold",
    ),
    "no such model": (
        [f"{BLOCK}.model=beam"],
        "model: must be one of finite_elements, analytic, table, none",
    ),
    "order of formulas": (
        [f"{BLOCK}={{model: analytic, order: 8}}"],
        "'order' is not valid with 'model: analytic'",
    ),
    "another law": (
        [
            ELEMENTS,
            "meshes.0.contact={law: linear, stiffness: 1e8}",
            "meshes.0.damping={law: none}",
        ],
        "contact.law: a wheel with compliance requires contact {law: johnson}, to which its c is",
    ),
    "rigid": (
        [ELEMENTS, "meshes.0.contact={law: rigid}", "meshes.0.damping={law: none}"],
        "contact.law: a wheel with compliance requires contact {law: johnson}",
    ),
    "tracked": ([ELEMENTS, "meshes.0.tracking=differential"], "requires tracking: closed_form"),
}


@pytest.mark.parametrize(("options", "reason"), BAD_OPTIONS.values(), ids=BAD_OPTIONS)
def test_what_gives_no_compliance_is_refused_in_one_line(
    evolvent: Evolvent, examples: Path, tmp_path: Path, options: list[str], reason: str
) -> None:
    given = [word for option in options for word in ("--set", option)]
    result = evolvent("run", examples / "spur-pair.yaml", *given)
    assert result.returncode == CASE, result.stderr
    assert result.stdout == ""
    assert result.stderr.count("\n") == 1
    assert reason in result.stderr
    assert list(tmp_path.iterdir()) == []


def test_wheels_that_are_stated_by_their_pitch_radius_have_none(
    evolvent: Evolvent, examples: Path
) -> None:
    result = evolvent("run", examples / "paper.yaml", "--set", "wheels.0.compliance={}")
    assert result.returncode == CASE
    assert "wheels.pinion: 'compliance' needs 'module' in the same block" in result.stderr


def shown(evolvent: Evolvent, examples: Path, *options: str) -> dict:
    """JSON output of show for the spur pair."""
    given = [word for option in options for word in ("--set", option)]
    result = evolvent("show", examples / "spur-pair.yaml", "--json", *given)
    return json.loads(result.stdout)


def test_show_prints_compliance_and_stiffness_beside_those_of_the_standard(
    evolvent: Evolvent, examples: Path
) -> None:
    """The 19/34 pair as in a static analysis by another program: its secant stiffness."""
    fit = (
        *("wheels.pinion.compliance={}", "wheels.gear.compliance={}"),
        *("wheels.pinion.thickness_allowance=0", "wheels.gear.thickness_allowance=0"),
        "meshes.0={name: pinion-gear, driving: pinion, driven: gear, driving_rotation: clockwise, "
        "centre_line_angle: 0}",
    )
    reported = shown(evolvent, examples, *fit)["compliance"]["pinion-gear"]
    # c_B falls from start to end of the path, c_A rises
    assert (
        reported["driving_at_start"]
        < reported["driving_at_pitch_point"]
        < reported["driving_at_end"]
    )
    assert (
        reported["driven_at_start"] > reported["driven_at_pitch_point"] > reported["driven_at_end"]
    )
    assert 0 < reported["driving_next"] < reported["driving_at_pitch_point"]
    # over a pitch at 150 N/mm the secant is 13.56 to 19.83 N/(mm um); here the load is half
    assert 12.5e9 < reported["single_pair"] < reported["double_pair"] < 19.9e9
    # q' of ISO 6336-1, 9.3.1.1 by manual calculation, rack 1.25, 20 degrees
    z, x = (19, 34), (0.4, 0.1)
    q = 0.04723 + 0.15551 / z[0] + 0.25791 / z[1] - 0.00635 * x[0] - 0.11654 * x[0] / z[0]
    q += -0.00193 * x[1] - 0.24188 * x[1] / z[1] + 0.00529 * x[0] ** 2 + 0.00182 * x[1] ** 2
    tangential = reported["line_load"] * math.cos(math.radians(20))  # F_t/b at the reference circle
    iso = 1e9 / q * 0.8 * (1 + 0.5 * (1.2 - 1.25)) * min(1, tangential / 1e5) ** 0.25
    assert reported["iso_6336"] == pytest.approx(iso, rel=1e-9)


def test_one_pair_goes_together_by_its_wheels_and_by_johnsons_contact(
    evolvent: Evolvent, examples: Path
) -> None:
    """h/N = c_A + c_B + (ln(4 pi E* rho/N) - 1)/(pi E*) of wheels of one material, by (5.57)."""
    table = "{model: table, rho: [0.001, 0.03], c: [2e-12, 6e-11]}"
    reported = shown(evolvent, examples, f"{BLOCK}={table}", f"wheels.gear.compliance={table}")
    rho = reported["meshes"]["pinion-gear"][
        "line_of_action_length"
    ]  # sum of the radii of curvature
    reported = reported["compliance"]["pinion-gear"]
    modulus = 206e9 / (1 - 0.3**2) / 2  # E* of steel on steel
    load = reported["line_load"]
    contact = (np.log(4 * np.pi * modulus * rho / load) - 1) / (np.pi * modulus)
    bending = reported["driving_at_pitch_point"] + reported["driven_at_pitch_point"]
    assert 0.1 < contact / bending < 1  # neither dominates the other
    assert 1 / reported["single_pair"] == pytest.approx(bending + contact, rel=1e-12)


def test_equal_wheels_give_way_alike_and_a_wheel_without_the_block_not_at_all(
    evolvent: Evolvent, examples: Path
) -> None:
    reported = shown(evolvent, examples, ELEMENTS)["compliance"]["pinion-gear"]
    assert "driven_at_start" not in reported
    assert shown(evolvent, examples)["compliance"] == {}
    none = shown(evolvent, examples, f"{BLOCK}={{model: none}}")
    assert none["compliance"] == {}
    assert none["refusal"] == ""


def test_table_gives_its_numbers(evolvent: Evolvent, examples: Path) -> None:
    """A linear c, reproduced at every position."""
    table = "{model: table, rho: [0.001, 0.03], c: [2e-12, 6e-11], c_1: [5e-12, 5e-12]}"
    reported = shown(evolvent, examples, f"{BLOCK}={table}")["compliance"]["pinion-gear"]
    values = [reported[f"driving_at_{point}"] for point in ("start", "pitch_point", "end")]
    assert np.all(np.diff(values) > 0)
    assert reported["driving_next"] == pytest.approx(5e-12, rel=1e-14)


def test_formulas_warn_of_the_body_that_two_pairs_share(evolvent: Evolvent, examples: Path) -> None:
    warnings = shown(evolvent, examples, f"{BLOCK}={{model: analytic}}")["warnings"]
    assert any("two loaded pairs share the wheel's body" in line for line in warnings)
    assert any("outside the range of its fit" in line for line in warnings)


def test_numbers_of_the_block_are_parameters(evolvent: Evolvent, examples: Path) -> None:
    option = f"{BLOCK}={{hub_diameter: 0.03}}"
    result = evolvent("show", examples / "spur-pair.yaml", "--parameters", "--set", option)
    assert f"{BLOCK}.hub_diameter = 0.03 m\n" in result.stdout
    assert f"{BLOCK}.order = 8\n" in result.stdout
