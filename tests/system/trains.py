"""Trains of any length, and a power split, as cases."""

from __future__ import annotations

import math
from typing import Any

from system.cases import STEEL

LINEAR = {"law": "linear", "coefficient": 2e3}


def case(wheels: list[dict[str, Any]], meshes: list[dict[str, Any]], **simulation: Any) -> dict:
    """Case of steel wheels of 20 mm width, without friction, pairs by the paper's rule."""
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [{"width": 0.02, "material": "steel"} | wheel for wheel in wheels],
        "meshes": [{"pressure_angle": 10, "damping": LINEAR} | mesh for mesh in meshes],
        "simulation": {"duration": 0.05, "output_interval": 1e-4, **simulation},
    }


def row(n: int, **simulation: Any) -> dict[str, Any]:
    """Row of n wheels, each of which drives the next one."""
    wheels: list[dict[str, Any]] = [
        {"name": f"w{i}", "teeth": 30 + i % 7, "pitch_radius": 0.002 * (30 + i % 7)}
        for i in range(n)
    ]
    wheels[0]["centre"] = [0, 0]
    wheels[0]["loads"] = [{"kind": "torque", "value": -5}]
    wheels[-1]["loads"] = [{"kind": "viscous", "coefficient": 0.2}]
    meshes = [
        {
            "driving": f"w{i}",
            "driven": f"w{i + 1}",
            "driving_rotation": ("clockwise", "counterclockwise")[i % 2],
            "centre_line_angle": 40 * (-1) ** i,
        }
        for i in range(n - 1)
    ]
    return case(wheels, meshes, **simulation)


def power_split(**simulation: Any) -> dict[str, Any]:
    """Two idlers in parallel between two wheels: four meshes, a closed loop."""
    angle = 35.0
    radii = {"input": 0.04, "upper": 0.06, "lower": 0.06, "output": 0.1}
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    first, second = radii["input"] + radii["upper"], radii["upper"] + radii["output"]
    end = first * c + math.sqrt(second**2 - (first * s) ** 2)
    centres = {
        "input": [0, 0],
        "upper": [first * c, first * s],
        "lower": [first * c, -first * s],
        "output": [end, 0],
    }
    wheels: list[dict[str, Any]] = [
        {"name": name, "teeth": round(500 * r), "pitch_radius": r, "centre": centres[name]}
        for name, r in radii.items()
    ]
    wheels[0]["loads"] = [{"kind": "torque", "value": -8}]
    wheels[-1]["loads"] = [{"kind": "viscous", "coefficient": 1}]
    meshes = [
        {"driving": a, "driven": b, "driving_rotation": sense}
        for idler in ("upper", "lower")
        for a, b, sense in (
            ("input", idler, "clockwise"),
            (idler, "output", "counterclockwise"),
        )
    ]
    return case(wheels, meshes, **simulation)
