"""Gearboxes other than the examples: variants of the paper's, and a train of three wheels."""

from __future__ import annotations

from typing import Any

STEEL = {"youngs_modulus": 2.0e11, "poisson_ratio": 0.3, "density": 7800.0}


def pair(friction: float = 0.0, tracking: str = "closed_form", **simulation: Any) -> dict[str, Any]:
    """Return the case of examples/paper.yaml for modification; `simulation` changes its block."""
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                "name": "pinion",
                "teeth": 20,
                "pitch_radius": 0.2,
                "width": 0.1,
                "material": "steel",
                "centre": [0, 0],
                "loads": [{"kind": "torque", "value": -1.0}],
            },
            {
                "name": "gear",
                "teeth": 30,
                "width": 0.1,
                "material": "steel",
                "support": {
                    "kind": "slider",
                    "direction": 0,
                    "mass": 10.0,
                    "stiffness": 1e9,
                    "damping": 1e5,
                },
                "loads": [{"kind": "viscous", "coefficient": 10.0}],
            },
        ],
        "meshes": [
            {
                "driving": "pinion",
                "driven": "gear",
                "driving_rotation": "clockwise",
                "centre_line_angle": 0,
                "pressure_angle": "paper_rule",
                "damping": {"law": "linear", "coefficient": 1e4},
                "friction": {
                    "law": "coulomb",
                    "coefficient": friction,
                    "regularisation_velocity": 1e-4,
                },
                "tracking": tracking,
            }
        ],
        "simulation": {"duration": 5, "output_interval": 1e-3, "tolerance": 1e-9, **simulation},
    }


def unloaded_pair(tracking: str, **simulation: Any) -> dict[str, Any]:
    """Return two wheels without loads, damping and friction: only their contact acts on them."""
    case = pair(0.0, tracking, **simulation)
    for wheel in case["wheels"]:
        wheel["loads"] = []
    case["wheels"][1]["support"] = {"kind": "fixed"}
    case["meshes"][0]["damping"] = {"law": "none"}
    case["meshes"][0]["friction"] = {"law": "none"}
    return case


def rigid(case: dict[str, Any], restitution: float = 0.0) -> dict[str, Any]:
    """Make every contact of a case rigid."""
    for mesh in case["meshes"]:
        mesh["contact"] = {"law": "rigid", "restitution": restitution}
        mesh["damping"] = {"law": "none"}
    return case


def train(friction: float, tracking: str, **simulation: Any) -> dict[str, Any]:
    """Return input wheel, idler in bearings and output wheel; standard teeth of 20 degrees."""
    coulomb = {"law": "coulomb", "coefficient": friction, "regularisation_velocity": 1e-3}
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                "name": "input",
                "teeth": 20,
                "pitch_radius": 0.05,
                "width": 0.02,
                "material": "steel",
                "centre": [0, 0],
                "loads": [{"kind": "torque", "value": -5.0}],
            },
            {
                "name": "idler",
                "teeth": 31,
                "width": 0.025,
                "material": "steel",
                "support": {
                    "kind": "bearing",
                    "mass": 0.5,
                    "stiffness": [2e8, 3e8],
                    "damping": [2e3, 3e3],
                },
            },
            {
                "name": "output",
                "teeth": 47,
                "width": 0.02,
                "material": "steel",
                "loads": [{"kind": "viscous", "coefficient": 2.0}],
            },
        ],
        "meshes": [
            {
                "name": "first",
                "driving": "input",
                "driven": "idler",
                "driving_rotation": "clockwise",
                "centre_line_angle": 25,
                "pressure_angle": 20,
                "damping": {"law": "linear", "coefficient": 2e3},
                "friction": coulomb,
                "tracking": tracking,
            },
            {
                "name": "second",
                "driving": "idler",
                "driven": "output",
                "driving_rotation": "counterclockwise",
                "centre_line_angle": -40,
                "pressure_angle": 20,
                "damping": {"law": "one_sided", "coefficient": 1e9},
                "friction": coulomb,
                "tracking": tracking,
            },
        ],
        "simulation": {"duration": 0.3, "output_interval": 1e-3, "tolerance": 1e-9, **simulation},
    }
