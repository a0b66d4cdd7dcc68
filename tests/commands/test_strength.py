"""The block `strength` of a material: S-N line and permissible stresses."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

Evolvent = Callable[..., subprocess.CompletedProcess[str]]

SN = {
    "stress_type": "range",
    "cycles": "[1e4, 1e6]",
    "stress": "[800 MPa, 400 MPa]",
    "slope_above": "5",
    "slope_below": "none",
}
# Changed keys of the line, None if left out; and the reason of the refusal.
REFUSED = {
    "rises": (
        {"stress": "[400 MPa, 800 MPa]"},
        "strength.sn.stress: the stresses of an S-N line must decrease: "
        "800 MPa (8.0e+08 Pa) follows 400 MPa (4.0e+08 Pa); order its points by cycles",
    ),
    "is flat": ({"stress": "[400 MPa, 400 MPa]"}, "the stresses of an S-N line must decrease"),
    "cycles fall": (
        {"cycles": "[1e6, 1e4]"},
        "strength.sn.cycles: the cycles of a table must increase: 1e4 follows 1e6",
    ),
    "one point": ({"cycles": "[1e6]", "stress": "[1 MPa]"}, "has 1 value, needs at least 2"),
    "lengths": ({"cycles": "[1e4, 1e5, 1e6]"}, "has 2 values, but cycles has 3"),
    "no slope": ({"slope_below": None}, "'slope_below' is missing"),
    "no type": ({"stress_type": None}, "'stress_type' is missing"),
    "another type": ({"stress_type": "mean"}, "must be one of range, amplitude, not 'mean'"),
    "zero": ({"stress": "[800 MPa, 0]"}, "must be greater than 0"),
}


def option(**changed: str | None) -> str:
    """Setting of a strength with this line."""
    given = {key: value for key, value in (SN | changed).items() if value is not None}
    line = ", ".join(f"{key}: {value}" for key, value in given.items())
    return f"materials.steel.strength={{sn: {{{line}}}, sigma_FP: 430 MPa, sigma_HP: 1.3 GPa}}"


def test_a_strength_is_shown_in_si_units_and_changes_nothing_else(
    evolvent: Evolvent, examples: Path
) -> None:
    case = examples / "spur-pair.yaml"
    shown = [
        json.loads(evolvent("show", case, "--json", *given).stdout)
        for given in ((), ("--set", option()))
    ]
    strength = shown[1]["case"]["materials"]["steel"].pop("strength")
    assert strength == {
        "sn": {
            "stress_type": "range",
            "cycles": [1e4, 1e6],
            "stress": [8e8, 4e8],
            "slope_above": 5,
            "slope_below": "none",
        },
        "sigma_FP": 4.3e8,
        "sigma_HP": 1.3e9,
    }
    assert shown[0] == shown[1]


@pytest.mark.parametrize("what", REFUSED)
def test_a_wrong_line_is_refused_with_location_and_remedy(
    evolvent: Evolvent, examples: Path, what: str
) -> None:
    changed, reason = REFUSED[what]
    done = evolvent("validate", examples / "spur-pair.yaml", "--set", option(**changed))
    assert done.returncode == 3
    assert reason in done.stderr
    assert "materials.steel.strength.sn" in done.stderr
    assert done.stderr.count("\n") == 1
