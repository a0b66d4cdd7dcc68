"""Cases with pairs of gears defined by a basic rack."""

from __future__ import annotations

import math
from typing import Any

from system.cases import STEEL

ALPHA = math.radians(20)
E_STAR = STEEL["youngs_modulus"] / (2 * (1 - STEEL["poisson_ratio"] ** 2))


def real_pair(
    teeth: tuple[int, int] = (50, 50),
    module: float = 3e-3,
    width: float = 0.02,
    wheels: tuple[dict[str, Any], dict[str, Any]] = ({}, {}),
    mesh: dict[str, Any] | None = None,
    **simulation: Any,
) -> dict[str, Any]:
    """Two gears of 20 degrees on fixed axes; fields of each wheel, of the mesh, of the run."""
    names = ("pinion", "gear")
    return {
        "format": 1,
        "materials": {"steel": dict(STEEL)},
        "wheels": [
            {
                **{"name": names[i], "teeth": teeth[i], "module": module, "width": width},
                **{"material": "steel"},
                **wheels[i],
            }
            for i in (0, 1)
        ],
        "meshes": [
            {
                **{"driving": "pinion", "driven": "gear", "driving_rotation": "clockwise"},
                **{"centre_line_angle": 0},
                **(mesh or {}),
            }
        ],
        "simulation": {"duration": 0.05, "output_interval": 1e-4, **simulation},
    }


def torque(value: float) -> dict[str, Any]:
    """Load of a wheel."""
    return {"loads": [{"kind": "torque", "value": value}]}


def viscous(coefficient: float) -> dict[str, Any]:
    """Load of a wheel."""
    return {"loads": [{"kind": "viscous", "coefficient": coefficient}]}


def speed(value: float) -> dict[str, Any]:
    """Load of a wheel."""
    return {"loads": [{"kind": "speed", "value": value}]}


def base_radius(teeth: int, module: float = 3e-3) -> float:
    """Base radius [m]."""
    return module * teeth / 2 * math.cos(ALPHA)


def base_pitch(module: float = 3e-3) -> float:
    """Base pitch [m]."""
    return math.pi * module * math.cos(ALPHA)


def tip_diameters(
    teeth: tuple[int, int], ratio: float, module: float = 3e-3, alpha: float = ALPHA
) -> tuple[float, float]:
    """Tip diameters of a zero-backlash pair with a contact ratio and a symmetric path."""
    base = [module * z / 2 * math.cos(alpha) for z in teeth]
    line = sum(base) * math.tan(alpha)
    rho = (line + ratio * math.pi * module * math.cos(alpha)) / 2
    return 2 * math.hypot(base[0], rho), 2 * math.hypot(base[1], rho)
