"""Two-stage reducer between a motor and a heavy wheel behind a soft output shaft."""

from __future__ import annotations

from typing import Any

Block = dict[str, Any]
OUTPUT_TORQUE = 1289.8  # [N m]
TEETH = {"p1": 19, "g1": 61, "p2": 23, "g2": 77}


def gear(name: str, module: float, shift: float, bore: float, width: float, **of: Any) -> Block:
    """Return a gear with compliant teeth on bearings."""
    bearing = {"stiffness": [2.5e8, 2.5e8], "damping": [2e3, 2e3]}
    return {
        **{"name": name, "teeth": TEETH[name], "module": module, "profile_shift": shift},
        **{"bore": bore, "width": width, "material": "steel", "compliance": {}},
        **{"thickness_allowance": -6e-5, "support": {"kind": "bearing", **bearing}, **of},
    }


def edrive(stiffness: float, **initial: Any) -> Block:
    """Return the case for a stiffness of the output shaft [N m/rad]."""
    drive = {"kind": "drive", "speed": 628.0, "torque": 120.0, "slope": -4.8}
    friction = {"law": "coulomb", "coefficient": 0.05, "regularisation_velocity": 1e-3}
    of_mesh = {"damping": {"law": "ratio", "value": 0.07}, "friction": friction}
    return {
        "format": 1,
        "materials": {"steel": {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830}},
        "wheels": [
            {
                **{"name": "motor", "inertia": 0.03, "mass": 15, "width": 0.1},
                **{"material": "steel", "loads": [drive]},
            },
            gear("p1", 2e-3, 0.4, 0.016, 0.028),
            gear("g1", 2e-3, 0.1, 0.040, 0.026),
            gear("p2", 2.5e-3, 0.35, 0.025, 0.038, axial_position=0.05),
            gear("g2", 2.5e-3, 0.1, 0.060, 0.036, axial_position=0.05),
            {
                **{"name": "wheels", "inertia": 3, "mass": 100, "width": 0.2},
                **{"axial_position": 0.2, "material": "steel"},
                "loads": [{"kind": "torque", "value": -OUTPUT_TORQUE}],
            },
        ],
        "shafts": [
            {"name": "input", "wheels": ["motor", "p1"], "stiffness": 2e4, "damping": 0.3},
            {"name": "middle", "wheels": ["g1", "p2"], "stiffness": 1e5, "damping": 1},
            {"name": "output", "wheels": ["g2", "wheels"], "stiffness": stiffness, "damping": 3},
        ],
        "meshes": [
            {
                **{"name": "first", "driving": "p1", "driven": "g1"},
                **{"driving_rotation": "counterclockwise", "centre_line_angle": 0, **of_mesh},
            },
            {
                **{"name": "second", "driving": "p2", "driven": "g2"},
                **{"driving_rotation": "clockwise", "centre_line_angle": 40, **of_mesh},
            },
        ],
        "simulation": {
            "duration": 0.1,
            "output": {"per_pitch": 60, "mesh": "first"},
            "initial": {"kind": "steady", **initial},
            "metrics": {"from": 0.04, "turns_of": "g1"},
        },
    }
