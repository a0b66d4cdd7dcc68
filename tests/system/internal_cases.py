"""Cases of internal pairs: a pinion in a ring on fixed or elastic axles."""

from __future__ import annotations

import random
from typing import Any

Block = dict[str, Any]
STEEL = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7850.0}


def internal_pair(**changes: Any) -> Block:
    """Return 35/98, m 3 mm: the pinion drives counterclockwise with 150 N m against a brake."""
    pinion = {
        "name": "pinion",
        "teeth": 35,
        "module": 0.003,
        "width": 0.02,
        "material": "steel",
        "loads": [{"kind": "torque", "value": 150.0}],
    }
    ring = {
        "name": "ring",
        "teeth": 98,
        "module": 0.003,
        "internal": True,
        "tip_diameter": 0.290,
        "rim_diameter": 0.340,
        "thickness_allowance": -5e-5,
        "width": 0.02,
        "material": "steel",
        "loads": [{"kind": "viscous", "coefficient": 4.0}],
    }
    mesh = {
        "driving": "pinion",
        "driven": "ring",
        "driving_rotation": "counterclockwise",
        "centre_line_angle": 0.0,
    } | changes.pop("mesh", {})
    simulation = {"duration": 0.004, "output_interval": 2e-5, "tolerance": 1e-11}
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [pinion | changes.pop("pinion", {}), ring | changes.pop("ring", {})],
        "meshes": [mesh],
        "simulation": simulation | changes,
    }


def random_pair(seed: int) -> Block:
    """Draw an internal pair with its laws, supports and loads."""
    draw = random.Random(seed)
    teeth = draw.randint(18, 45)
    module = draw.uniform(1.0, 6.0) * 1e-3
    force = draw.uniform(30, 300) * 1e3 * 10 * module  # line load 30 to 300 N/mm, width 10 m
    torque = force * module * teeth / 2
    sense = draw.choice((-1, 1))
    bearing = {
        "kind": "bearing",
        "stiffness": [draw.uniform(1, 5) * 1e8, draw.uniform(1, 5) * 1e8],
        "damping": [draw.uniform(1, 5) * 1e3, draw.uniform(1, 5) * 1e3],
    }
    rubs = {"law": "coulomb", "coefficient": 0.08, "regularisation_velocity": 1e-3}
    friction = draw.choice(({"law": "none"}, rubs))
    damping = draw.choice(({"law": "none"}, {"law": "linear", "coefficient": 500.0}))
    law = draw.choice(("johnson", "radzimovsky", "yang_lin"))
    both = {"module": module, "width": 10 * module, "material": "steel"}
    rotation = "counterclockwise" if sense > 0 else "clockwise"
    shift = draw.uniform(0.1, 0.5)
    pinion = {
        **{"name": "pinion", "teeth": teeth, "profile_shift": shift},
        "loads": [{"kind": "torque", "value": sense * torque}],
    }
    ring_teeth = teeth + draw.randint(20, 80)
    ring = {
        **{"name": "ring", "teeth": ring_teeth, "internal": True},
        "profile_shift": draw.uniform(-0.2, 0.0) - shift,
        "thickness_allowance": -draw.uniform(0.01, 0.03) * module,
        "rim_diameter": module * (ring_teeth + 8),
        "loads": [{"kind": "viscous", "coefficient": draw.uniform(0.02, 0.2) * torque}],
    }
    if draw.random() < 0.5:
        pinion["support"] = dict(bearing)
    if draw.random() < 0.3:
        ring["support"] = dict(bearing)
    mesh = {
        **{"driving": "pinion", "driven": "ring", "driving_rotation": rotation},
        "centre_line_angle": draw.uniform(0.0, 360.0),
        **{"contact": {"law": law}, "damping": damping, "friction": friction},
    }
    simulation = {"duration": 1.5e-3, "output_interval": 1e-5, "tolerance": 1e-11}
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [pinion | both, ring | both],
        "meshes": [mesh],
        "simulation": simulation,
    }
