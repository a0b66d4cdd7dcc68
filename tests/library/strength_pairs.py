"""Random pairs of gears for checks of stresses, sliding and losses."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

Case = dict[str, Any]
Generator = np.random.Generator

# E [Pa], nu, density [kg/m^3]
MATERIALS = {
    "steel": (2.06e11, 0.3, 7830.0),
    "cast_iron": (1.2e11, 0.27, 7200.0),
    "bronze": (1.05e11, 0.34, 8800.0),
    "polymer": (2.6e9, 0.4, 1410.0),
}
LAWS = ("none", "coulomb", "schlenk", "mean_roughness", "benedict_kelley", "xu_kahraman")
SHARE_OF_NO_LOAD = 0.03
LEAST_MODULE = 5e-4  # of ISO 1328-1 [m]
STEEPEST_STANDARD = 22.5  # pressure angle for which the standard rack has room for its fillet [deg]
FINE = {"model": "finite_elements", "order": 4}  # order: less work; its error is above 1e-4


def strength_pair(seed: int, finite_elements: bool = False) -> Case:
    """Return the case of two random gears on one rack, one of which drives the other."""
    rng = np.random.default_rng([seed, 6336])
    module = float(10 ** rng.uniform(-3.7, -1.7))
    angle = float(rng.choice([14.5, 17.5, 20.0, 20.0, 20.0, 22.5, 25.0, 28.0]))
    common: Case = {"module": module, "pressure_angle": angle, "rack": random_rack(rng, angle)}
    gears = [random_gear(rng, common) for _ in range(2)]
    if finite_elements:
        for gear in gears:  # a solid wheel, and an undercut one, have no finite elements
            gear["compliance"] = dict(FINE)
            gear.setdefault("bore", module * gear["teeth"] * 0.3)
            gear["profile_shift"] = max(gear["profile_shift"], (24 - gear["teeth"]) / 20)
    for gear, name in zip(gears, ("pinion", "gear"), strict=True):
        gear["name"] = name
    driving = int(rng.integers(2))
    mesh: Case = {
        "driving": gears[driving]["name"],
        "driven": gears[1 - driving]["name"],
        "driving_rotation": str(rng.choice(["clockwise", "counterclockwise"])),
        "centre_line_angle": float(rng.uniform(-180, 180)),
    }
    fit = rng.random()
    if fit < 0.3:
        mesh["backlash"] = float(module * rng.uniform(0, 0.2))
    elif fit < 0.5:
        teeth = sum(gear["teeth"] for gear in gears)
        shift = sum(gear["profile_shift"] for gear in gears)
        mesh["centre_distance"] = module * (teeth / 2 + shift + float(rng.uniform(0, 0.4)))
    case: Case = {
        "format": 1,
        "materials": {name: material(*of) for name, of in MATERIALS.items()},
        "wheels": gears,
        "meshes": [mesh],
        "simulation": {"duration": 1e-3, "output_interval": 1e-4, "initial": {"kind": "rest"}},
    }
    law = str(rng.choice(LAWS))
    if law == "coulomb":
        mesh["friction"] = {"law": law, "coefficient": float(rng.uniform(0, 0.2))}
    elif law != "none":
        mesh["friction"] = {"law": law}
        case["lubricant"] = {
            "viscosity": float(10 ** rng.uniform(-3, 0)),
            "roughness": float(10 ** rng.uniform(-7, -5)),
        }
    add_loads(rng, case, driving)
    return case


def material(youngs_modulus: float, poisson_ratio: float, density: float) -> Case:
    """Return a material with permissible stresses."""
    return {
        "youngs_modulus": youngs_modulus,
        "poisson_ratio": poisson_ratio,
        "density": density,
        "strength": {"sigma_FP": youngs_modulus / 500, "sigma_HP": youngs_modulus / 150},
    }


def random_rack(rng: Generator, pressure_angle: float) -> Case:
    """Return a basic rack: standard, or with its own addendum, dedendum and fillet."""
    if pressure_angle <= STEEPEST_STANDARD and rng.random() < 0.4:
        return {}
    addendum = float(rng.uniform(0.7, 1.3 if pressure_angle <= STEEPEST_STANDARD else 1.0))
    dedendum = addendum + float(rng.uniform(0.12, 0.35))
    alpha = math.radians(pressure_angle)
    full = (math.pi / 4 - dedendum * math.tan(alpha)) * math.cos(alpha) / (1 - math.sin(alpha))
    radius = float(rng.choice([0.0, 0.2, rng.uniform(0, 1)])) * full
    return {"addendum": addendum, "dedendum": dedendum, "root_radius": radius}


def random_gear(rng: Generator, common: Case) -> Case:
    """Return a wheel with 8 to 150 teeth."""
    module = common["module"]
    teeth = round(8 * (150 / 8) ** rng.random())
    shift = float(rng.uniform(-0.4, 0.7)) + max(0.0, (16 - teeth) / 20)
    gear: Case = {**common, "teeth": teeth, "profile_shift": shift}
    gear["width"] = module * float(10 ** rng.uniform(0, 1.3))
    gear["material"] = str(rng.choice(list(MATERIALS), p=[0.7, 0.1, 0.1, 0.1]))
    if rng.random() < 0.5:
        gear["thickness_allowance"] = -module * float(rng.uniform(0, 0.05))
    if rng.random() < 0.4:
        gear["tip_alteration"] = float(rng.uniform(-0.3, 0.1))
    if rng.random() < 0.4:
        gear["tip_rounding"] = module * float(rng.uniform(0, 0.12))
    if rng.random() < 0.6:
        gear["bore"] = module * (teeth + 2 * shift - 2.5) * float(rng.uniform(0.1, 0.85))
    if rng.random() < 0.4:
        amount = module * float(10 ** rng.uniform(-3.3, -1.7))
        start = module * (teeth + 2 * shift + float(rng.uniform(0.2, 1.9)))
        shape = str(rng.choice(["linear", "parabolic"]))
        gear["tip_relief"] = {"amount": amount, "diameter": start, "shape": shape}
    if rng.random() < 0.15:
        gear["profile_crowning"] = module * float(10 ** rng.uniform(-3.3, -2))
    if module >= LEAST_MODULE and rng.random() < 0.4:
        gear["accuracy"] = {"class": int(rng.integers(1, 12)), "seed": int(rng.integers(100))}
    return gear


def add_loads(rng: Generator, case: Case, driving: int) -> None:
    """Add a torque of the driving gear, up to deflections of the teeth, and a load."""
    wheels, mesh = case["wheels"], case["meshes"][0]
    sense = 1 if mesh["driving_rotation"] == "counterclockwise" else -1
    gear = wheels[driving]
    radius = gear["module"] * gear["teeth"] / 2 * math.cos(math.radians(gear["pressure_angle"]))
    width = min(wheel["width"] for wheel in wheels)
    softest = min(MATERIALS[wheel["material"]][0] for wheel in wheels)
    line_load = softest * gear["module"] * float(10 ** rng.uniform(-8, -3.3))
    torque = sense * radius * width * line_load
    if rng.random() < 0.2:
        torque = -torque  # on the coast flanks
    if rng.random() < SHARE_OF_NO_LOAD:
        return
    ratio = wheels[1 - driving]["teeth"] / gear["teeth"]
    kind = rng.random()
    if kind < 0.3:
        gear["loads"] = [{"kind": "torque", "value": torque}]
        wheels[1 - driving]["loads"] = [{"kind": "torque", "value": torque * ratio}]
        return
    speed = sense * float(10 ** rng.uniform(0, 3.5))
    slope = -abs(torque / speed) * float(10 ** rng.uniform(0, 2))
    gear["loads"] = [{"kind": "drive", "speed": speed, "torque": torque, "slope": slope}]
    wheels[1 - driving]["loads"] = [{"kind": "torque", "value": torque * ratio}]
