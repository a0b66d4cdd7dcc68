"""Random damped gearboxes with a common period: a seed gives a case that starts on an orbit.

Pairs and trains of two meshes, by an idler or a shaft, under speeds, torques, drives and viscous
loads, with orders, eccentric wheels, pitch errors, reliefs, bearings, discs on shafts and vibrating
housings. Damping ratios of meshes, shafts and supports are at least 0.02.
"""

from __future__ import annotations

import copy
import math
import random
from typing import Any

Block = dict[str, Any]

STEEL = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830.0}
MESH_STIFFNESS = 1.4e10  # of a mesh over its width, about [Pa]
MOST_PITCHES = 200  # of a common period


def periodic_case(seed: int) -> Block:
    """Create the case of a seed."""
    return PeriodicCase(seed).case()


class PeriodicCase:
    """Generator of a case."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(9_000_011 * (seed + 1))
        draw = self.draw
        self.module = self.log(1e-3, 6e-3)
        self.width = self.module * draw.uniform(6, 14)
        self.shape = draw.choice(("pair", "pair", "pair", "idler", "shaft"))
        self.ratio = self.log(0.02, 0.2)  # damping
        self.compliant = self.chance(0.35)
        self.sense = draw.choice((-1, 1))  # of the first wheel
        count = {"pair": 2, "idler": 3, "shaft": 4}[self.shape]
        self.teeth = [draw.randint(18, 45) for _ in range(count)]
        self.line_load = self.log(3e4, 4e5)  # [N/m]
        radius = self.module * self.teeth[0] / 2
        self.torque = self.line_load * self.width * radius
        mass = STEEL["density"] * math.pi * radius**2 * self.width / 4
        frequency = math.sqrt(MESH_STIFFNESS * self.width / mass)
        self.speed = self.log(0.1, 1.2) * frequency / self.teeth[0]

    def chance(self, probability: float) -> bool:
        return self.draw.random() < probability

    def log(self, low: float, high: float) -> float:
        return math.exp(self.draw.uniform(math.log(low), math.log(high)))

    def wheel(self, i: int) -> Block:
        fields: Block = {
            **{"name": f"g{i + 1}", "teeth": self.teeth[i], "module": self.module},
            **{"width": self.width, "material": "steel", "bore": 0.4 * self.module * self.teeth[i]},
        }
        if self.compliant:
            fields["compliance"] = {"model": "analytic"}
        if self.chance(0.3):
            tip = self.module * (self.teeth[i] + 2)
            fields["tip_relief"] = {
                "amount": self.log(1e-3, 6e-3) * self.module,
                "diameter": tip - self.draw.uniform(0.6, 1.4) * self.module,
                "shape": self.draw.choice(("linear", "parabolic")),
            }
        if self.chance(0.25):
            stiffness = MESH_STIFFNESS * self.width * self.log(0.2, 5)
            mass = 2.0 * (self.module * self.teeth[i] / 0.1) ** 2
            damping = 2 * self.ratio * math.sqrt(stiffness * mass) * 3
            fields["support"] = {
                **{"kind": "bearing", "mass": mass},
                **{"stiffness": [stiffness, 2 * stiffness], "damping": [damping, damping]},
            }
        return fields

    def add_errors(self, wheels: list[Block]) -> None:
        """Errors of one wheel, which repeat after one revolution."""
        if self.shape == "pair" and self.chance(0.3):
            wheel = self.draw.choice(wheels)
            size = self.log(3e-4, 2e-3) * self.module
            if self.chance(0.5):
                wheel["eccentricity"] = {"amount": size, "phase": self.draw.uniform(-180, 180)}
            else:
                wheel["pitch_errors"] = [self.draw.gauss(0, size) for _ in range(wheel["teeth"])]

    def damping(self) -> Block:
        return {"law": "ratio", "value": self.ratio}

    def meshes(self) -> list[Block]:
        sense = ("clockwise", "counterclockwise")
        joins = {"pair": [(0, 1)], "idler": [(0, 1), (1, 2)], "shaft": [(0, 1), (2, 3)]}[self.shape]
        turns = [self.sense, -self.sense]
        friction = self.chance(0.3)
        return [
            {
                **{"driving": f"g{a + 1}", "driven": f"g{b + 1}"},
                **{"driving_rotation": sense[(turns[i] + 1) // 2]},
                **{"centre_line_angle": self.draw.uniform(-180, 180), "damping": self.damping()},
                "friction": {
                    **{"law": "coulomb", "coefficient": 0.05},
                    "regularisation_velocity": 0.02 * self.speed * self.module * self.teeth[0],
                }
                if friction
                else {"law": "none"},
            }
            for i, (a, b) in enumerate(joins)
        ]

    def gear_ratio(self) -> float:
        """Speed of the last wheel over that of the first."""
        z = self.teeth
        if self.shape == "pair":
            return -z[0] / z[1]
        if self.shape == "idler":
            return z[0] / z[2]
        return z[0] / z[1] * z[2] / z[3]

    def add_loads(self, first: Block, last: Block) -> None:
        """Two loads in equilibrium at the speed."""
        torque, speed = self.sense * self.torque, self.sense * self.speed
        ratio = self.gear_ratio()
        kind = self.draw.choice(("speed", "speed", "viscous", "drive", "loaded drive"))
        if kind == "viscous":
            first["loads"] = [{"kind": "torque", "value": torque}]
            last["loads"] = [{"kind": "viscous", "coefficient": torque / (ratio**2 * speed)}]
        elif kind == "speed":
            first["loads"] = [{"kind": "speed", "value": speed}]
            last["loads"] = [{"kind": "torque", "value": -torque / ratio}]
        else:
            slope = -abs(torque / speed) * self.log(1, 20)
            first["loads"] = [{"kind": "drive", "speed": speed, "torque": torque, "slope": slope}]
            last["loads"] = [{"kind": "torque", "value": -torque / ratio}]
            if kind == "loaded drive":
                share = {"kind": "viscous", "coefficient": 0.3 * torque / (ratio**2 * speed)}
                last["loads"] = [{"kind": "torque", "value": -0.7 * torque / ratio}, share]
        # in an idler train the phase of an order depends on the order of the meshes
        if self.shape != "idler" and self.chance(0.3):
            swing: Block = {"kind": "harmonic", "amplitude": 0.2 * abs(torque / ratio)}
            swing["phase"] = self.draw.uniform(-180, 180)
            if kind == "speed" and self.chance(0.5):
                swing["frequency"] = self.speed * self.teeth[0] / (2 * math.pi) / 2
            else:
                swing["order"] = float(last.get("teeth", self.teeth[-1]))
            last["loads"].append(swing)

    def case(self) -> Block:
        wheels = [self.wheel(i) for i in range(len(self.teeth))]
        self.add_errors(wheels)
        meshes = self.meshes()
        case: Block = {"format": 1, "materials": {"steel": dict(STEEL)}, "wheels": wheels}
        shafts = []
        if self.shape == "shaft":
            wheels[2]["axial_position"] = wheels[3]["axial_position"] = 2 * self.width
            shafts.append({"name": "middle", "wheels": ["g2", "g3"], "kind": "rigid"})
            for wheel in wheels[1:3]:
                wheel.pop("support", None)
        last = wheels[-1]
        if self.chance(0.3):
            arm = self.module * last["teeth"] / 2
            stiffness = MESH_STIFFNESS * self.width * arm**2 * self.log(0.02, 1)
            inertia = STEEL["density"] * self.width * arm**4 * 3
            damping = 2 * max(self.ratio, 0.03) * math.sqrt(stiffness * inertia)
            disc = {
                **{"name": "disc", "inertia": inertia, "mass": inertia / arm**2 * 2},
                **{"width": self.width, "material": "steel"},
                "axial_position": last.get("axial_position", 0.0) + self.width,
            }
            shafts.append(
                {
                    **{"name": "output", "wheels": [last["name"], "disc"]},
                    **{"stiffness": stiffness, "damping": damping},
                }
            )
            wheels.append(disc)
        self.add_loads(wheels[0], wheels[-1])
        case["meshes"] = meshes
        if shafts:
            case["shafts"] = shafts
        by_time = wheels[0]["loads"][0]["kind"] == "speed"
        if by_time and self.chance(0.2):
            term = {
                **{"kind": "harmonic", "axis": "x", "amplitude": 1e-3 * self.module},
                "frequency": self.speed * self.teeth[0] / (2 * math.pi) / 3,
            }
            case["housing"] = {"kind": "prescribed", "translation": [term]}
        pitch = 2 * math.pi / (self.teeth[0] * self.speed)
        case["simulation"] = {
            **{"duration": pitch, "output_interval": pitch / 8, "tolerance": 1e-12},
            "initial": {"kind": "periodic"},
        }
        return case


def reordered(case: Block) -> Block:
    """The same case with wheels, meshes and loads in another order."""
    other = copy.deepcopy(case)
    other["wheels"].reverse()
    other["meshes"].reverse()
    for wheel in other["wheels"]:
        wheel.get("loads", []).reverse()
    return other


def mirrored(case: Block) -> Block:
    """Mirror image of the case: everything rotates in the opposite direction."""
    other = copy.deepcopy(case)
    for wheel in other["wheels"]:
        if "pitch_errors" in wheel:
            errors = wheel["pitch_errors"]
            wheel["pitch_errors"] = [-errors[-k % len(errors)] for k in range(len(errors))]
        if "eccentricity" in wheel:
            wheel["eccentricity"]["phase"] *= -1
        for load in wheel.get("loads", []):
            _mirror(load)
    for mesh in other["meshes"]:
        mesh["centre_line_angle"] *= -1
        mesh["driving_rotation"] = (
            "clockwise" if mesh["driving_rotation"] == "counterclockwise" else "counterclockwise"
        )
    return other


def _mirror(load: Block) -> None:
    """T(phi) becomes -T(-phi), T(t) becomes -T(t)."""
    if "order" in load:
        load["phase"] = -load.get("phase", 0.0)
        load["mean"] = -load.get("mean", 0.0)
        return
    for key in ("value", "speed", "torque", "mean", "amplitude"):
        if key in load:
            load[key] *= -1
