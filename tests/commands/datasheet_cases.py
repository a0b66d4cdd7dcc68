"""Cases for data sheets, and their rows."""

from __future__ import annotations

import json
import math
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

Evolvent = Callable[..., subprocess.CompletedProcess[str]]
Rows = dict[str, dict[str, Any]]

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.yaml"))
POINTS = "abcde"


def sheet(evolvent: Evolvent, case: dict[str, Any], folder: Path, *words: str) -> Rows:
    """Rows of a data sheet by their keys."""
    path = folder / "sheet-case.yaml"
    path.write_text(yaml.safe_dump(case, sort_keys=False))
    done = evolvent("datasheet", path, "--json", *words)
    assert done.returncode == 0, done.stderr
    rows = json.loads(done.stdout)["rows"]
    assert len({row["key"] for row in rows}) == len(rows)
    return {row["key"]: row for row in rows}


def value(rows: Rows, key: str, column: int = 0) -> float:
    """A value of a row."""
    return float(rows[key]["values"][column])


def pair(first: dict[str, Any], second: dict[str, Any], **mesh: Any) -> dict[str, Any]:
    """Return a case of two gears of steel; the first one drives."""
    steel = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830}
    gears = [
        {"name": name, "width": 0.02, "material": "steel", **gear}
        for name, gear in (("pinion", first), ("gear", second))
    ]
    return {
        "format": 1,
        "materials": {"steel": steel},
        "wheels": gears,
        "meshes": [
            {
                **{"driving": "pinion", "driven": "gear", "driving_rotation": "counterclockwise"},
                **{"centre_line_angle": 0, **mesh},
            }
        ],
        "simulation": {"duration": 0.01, "output_interval": 0.001, "initial": {"kind": "rest"}},
    }


def fzg_gears() -> dict[str, Any]:
    """FZG gears type C at load stage 9, 302 N m."""
    common = {"module": 4.5e-3, "thickness_allowance": -6e-5, "bore": 0.03, "width": 0.014}
    case = pair(
        {**common, "teeth": 16, "profile_shift": 0.1817, "tip_diameter": 0.08246},
        {**common, "teeth": 24, "profile_shift": 0.1715, "tip_diameter": 0.11836},
        centre_distance=0.0915,
    )
    speed = 2250 * math.pi / 30
    case["wheels"][0]["loads"] = [{"kind": "drive", "speed": speed, "torque": 302, "slope": -50}]
    case["wheels"][1]["loads"] = [{"kind": "torque", "value": 453}]
    return case


def plain_gears() -> dict[str, Any]:
    """Pair 17/43, module 2, without shift."""
    case = pair({"teeth": 17, "module": 2e-3}, {"teeth": 43, "module": 2e-3})
    case["wheels"][0]["loads"] = [{"kind": "torque", "value": 20.0}]
    case["wheels"][1]["loads"] = [{"kind": "viscous", "coefficient": 0.5}]
    return case
