"""Pairs of gears with all pairwise combinations of table entries: a seed gives a case.

The tables of laws are the kernel's, so that new laws are included automatically. Each wheel has its
own type of deviation; reliefs, pitch errors, loads and dampers are random, dampers up to values at
which the flanks hardly move.
"""

from __future__ import annotations

import itertools
import math
import random
from collections.abc import Iterator
from typing import Any

from kernel.kernel import CONTACT, DAMPING, FRICTION, Kernel
from system.cases import STEEL

Block = dict[str, Any]
Row = tuple[str, ...]

DEVIATIONS = (
    *("none", "linear tip", "parabolic tip", "linear root", "parabolic root"),
    *("crowning", "pitch errors", "accuracy", "runout"),
)
FACTORS = ("pinion", "gear", "contact", "damping", "friction", "integrator", "flank")
CANDIDATES = 60  # candidate rows, of which the one with most new combinations is chosen
STIFFNESS = 1.4e10  # of a tooth pair over its width [N/m2]


def levels(kernel: Kernel) -> tuple[Row, ...]:
    """Entries of each factor, in the order of `FACTORS`."""
    laws = [
        tuple(info.name for info in kernel.laws(family)) for family in (CONTACT, DAMPING, FRICTION)
    ]
    compliant = tuple(name for name in laws[0] if name != "rigid")
    integrators = ("radau", "ida")
    return DEVIATIONS, DEVIATIONS, compliant, laws[1], laws[2], integrators, ("drive", "coast")


def met(row: Row) -> Iterator[tuple[str, str, str, str]]:
    """Combinations of entries in a row; the deviations of both wheels are one table."""
    names = ("deviation", "deviation", *FACTORS[2:])
    for (a, first), (b, second) in itertools.combinations(zip(names, row, strict=True), 2):
        if a != b:
            yield a, first, b, second


def rows(kernel: Kernel, n: int) -> list[Row]:
    """Rows of entries: of some random candidates each the one with most new combinations."""
    draw = random.Random(13)
    tables = levels(kernel)
    seen: set[tuple[str, str, str, str]] = set()
    chosen = []
    for _ in range(n):
        tried = [tuple(draw.choice(table) for table in tables) for _ in range(CANDIDATES)]
        best = max(tried, key=lambda row: len(set(met(row)) - seen))
        chosen.append(best)
        seen |= set(met(best))
    return chosen


def pushing_case(kernel: Kernel, row: Row, seed: int) -> Block:
    """Create a pair of gears defined by a basic rack with the entries of a row."""
    return _Case(kernel, dict(zip(FACTORS, row, strict=True)), random.Random(1000 + seed)).case()


class _Case:
    """Generator of a case."""

    def __init__(self, kernel: Kernel, entries: dict[str, str], draw: random.Random) -> None:
        self.kernel, self.entries, self.draw = kernel, entries, draw
        self.module = self.log(1e-3, 5e-3)
        self.width = self.module * draw.uniform(6, 14)
        self.teeth = (draw.randint(18, 40), draw.randint(18, 60))
        self.speed = self.log(10, 300)  # of the pinion, clockwise or counterclockwise [rad/s]
        self.sense = draw.choice((-1, 1))
        self.force = self.log(3e6, 6e7) * self.module * self.width
        self.torque = self.force * self.module * self.teeth[0] / 2
        self.stiffness = STIFFNESS * self.width
        self.depth = self.force / self.stiffness
        radii = [self.module * z / 2 for z in self.teeth]
        masses = [STEEL["density"] * math.pi * r**2 * self.width / 2 for r in radii]
        self.mass = masses[0] * masses[1] / sum(masses)

    def log(self, low: float, high: float) -> float:
        return math.exp(self.draw.uniform(math.log(low), math.log(high)))

    def law(self, family: int, name: str) -> Block:
        """Select a law of a family, with values for its parameters."""
        (info,) = [law for law in self.kernel.laws(family) if law.name == name]
        block: Block = {"law": name}
        for given in info.rows:
            block[given.key] = self.value(given.key, given.unit)
            assert given.minimum <= block[given.key] <= given.maximum, (name, given.key)
        return block

    def value(self, key: str, unit: str) -> float:
        """Draw a value of a law's parameter; an unknown parameter fails."""
        frequency = math.sqrt(self.stiffness / self.mass)
        linear = 2 * self.log(0.02, 20) * self.stiffness / frequency  # damping ratio 0.02 to 20
        speed = self.log(1e-3, 2e-2)
        values = {
            ("stiffness", "N/m"): self.stiffness,
            ("exponent", ""): 1.3,
            ("coefficient", "N/m^exponent"): self.stiffness * self.depth ** (1 - 1.3),
            ("coefficient", "N s/m"): linear,
            ("coefficient", "N s/m2"): linear / self.depth,
            ("coefficient", ""): 0.06,
            ("value", ""): self.draw.uniform(0.02, 0.9),
            ("restitution", ""): self.draw.uniform(0.3, 0.95),
            ("v0_min", "m/s"): self.log(1e-4, 0.1),
            ("regularisation_velocity", "m/s"): speed,
            ("kinetic_coefficient", ""): 0.04,
            ("static_coefficient", ""): 0.07,
            ("stribeck_velocity", "m/s"): 10 * speed,
            ("lubricant_factor", ""): 1.0,
        }
        return values[key, unit]

    def deviation(self, kind: str, teeth: int) -> Block:
        """Deviations of one type."""
        amount = self.log(1e-3, 8e-3) * self.module
        tip = self.module * (teeth + 2)
        if kind.endswith(("tip", "root")):
            shape, end = kind.split()
            start = tip - self.module * (
                self.draw.uniform(0.4, 1.4) if end == "tip" else self.draw.uniform(2.0, 2.8)
            )
            return {f"{end}_relief": {"amount": amount, "diameter": start, "shape": shape}}
        if kind == "pitch errors":
            return {"pitch_errors": [self.draw.gauss(0, amount / 2) for _ in range(teeth)]}
        return {
            "none": {},
            "crowning": {"profile_crowning": amount},
            "accuracy": {"accuracy": {"class": self.draw.randint(3, 9), "seed": 7}},
            "runout": {"eccentricity": {"amount": amount, "phase": self.draw.uniform(-180, 180)}},
        }[kind]

    def case(self) -> Block:
        """Assemble the case. On the coast flank the driven wheel drives, in the same direction."""
        names = ("pinion", "gear")
        wheels: list[Block] = [
            {
                **{"name": name, "teeth": teeth, "module": self.module, "width": self.width},
                **{"material": "steel", "profile_shift": 0.2},
                **self.deviation(self.entries[name], teeth),
            }
            for name, teeth in zip(names, self.teeth, strict=True)
        ]
        ratio = -self.teeth[0] / self.teeth[1]
        speeds = {"pinion": self.sense * self.speed, "gear": self.sense * self.speed * ratio}
        drives = self.sense * (1 if self.entries["flank"] == "drive" else -1)
        wheels[0]["loads"] = [{"kind": "torque", "value": drives * self.torque}]
        wheels[1]["loads"] = [{"kind": "torque", "value": drives * self.torque / -ratio}]
        if self.draw.random() < 0.3:
            wheels[1]["support"] = {
                **{"kind": "slider", "direction": self.draw.uniform(-180, 180), "mass": self.mass},
                **{
                    "stiffness": self.stiffness,
                    "damping": 0.1 * math.sqrt(self.stiffness * self.mass),
                },
            }
        mesh = {
            **{"driving": "pinion", "driven": "gear", "tracking": "closed_form"},
            "driving_rotation": "counterclockwise" if self.sense > 0 else "clockwise",
            **{"centre_line_angle": self.draw.uniform(-180, 180), "backlash": 0.02 * self.module},
            "contact": self.law(CONTACT, self.entries["contact"]),
            "damping": self.law(DAMPING, self.entries["damping"]),
            "friction": self.law(FRICTION, self.entries["friction"]),
        }
        friction = next(i for i in self.kernel.laws(FRICTION) if i.name == self.entries["friction"])
        if "needs a lubricant" in friction.text:
            mesh["lubricant"] = {"viscosity": 0.05, "roughness": 5e-7}
        if "lubricant_factor" in mesh["friction"]:
            # its coefficient is that of the nominal speed, which torques alone do not determine
            held = wheels[1 if self.entries["flank"] == "drive" else 0]
            size = abs(held["loads"][0]["value"] / speeds[held["name"]])
            held["loads"] = [{"kind": "viscous", "coefficient": size}]
        duration = self.draw.uniform(2, 5) * 2 * math.pi / (self.teeth[0] * self.speed)
        return {
            **{"format": 1, "materials": {"steel": dict(STEEL)}},
            **{"wheels": wheels, "meshes": [mesh]},
            "simulation": {
                **{"duration": duration, "output_interval": duration / 400},
                "integrator": self.entries["integrator"],
                "initial": {"kind": "speeds", "speeds": speeds},
            },
        }
