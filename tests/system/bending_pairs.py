"""Random pairs of gears with compliant teeth and bodies: a seed gives a case.

Wheels of 12 to 120 teeth with profile shifts, thickness allowances, hubs from near the axis to near
the root, reliefs, crowning, pitch errors and runout, under 1 to 1000 N/mm, in both directions of
rotation, some with moving axes. Most could be built; for every eighth seed teeth, hub and tips are
drawn without restrictions, so that some cases are rejected. The tested properties of the flanks
hold for any c, so elements of order 4 to 8 suffice: tests/compliance tests their accuracy.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import Any

Block = dict[str, Any]

STIFFNESS = 1.4e10  # of a mesh over its width, about [Pa]
STEEL = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830.0}
OTHER = {"youngs_modulus": 1.1e11, "poisson_ratio": 0.26, "density": 7200.0}  # cast iron
REACH = 1.2  # minimum distance of a hub from the root circle, in modules
OUTPUTS = 200
ERRORS = ("pitch_errors", "accuracy", "eccentricity")


@dataclass
class Wheel:
    """Data of a wheel needed before its block."""

    teeth: int
    shift: float
    width: float

    def base_radius(self, module: float, angle: float) -> float:
        return module * self.teeth / 2 * math.cos(angle)


class BendingPair:
    """Generator of a pair."""

    def __init__(self, seed: int) -> None:
        self.draw = random.Random(7_000_003 * (seed + 1))
        self.careless = seed % 8 == 7
        draw = self.draw
        self.module = self.log(5e-4, 1e-2)
        self.degrees = draw.choice((20.0, 20.0, 20.0, 22.5, 25.0))
        self.angle = math.radians(self.degrees)
        self.wheels = [self.wheel() for _ in range(2)]
        self.common = min(wheel.width for wheel in self.wheels)
        self.line_load = self.log(1e3, 1e6)  # [N/m]
        self.sense = draw.choice((-1, 1))  # of the driving wheel
        self.radii = [wheel.base_radius(self.module, self.angle) for wheel in self.wheels]
        self.force = self.line_load * self.common
        self.torque = self.force * self.radii[0]
        self.materials = [STEEL, OTHER if self.chance(0.15) else STEEL]
        self.errors = draw.choice((None, None, None, 0, 1))  # the wheel with errors
        self.moves = draw.choice((None, None, 0, 1, 2))  # the moving axis, 2: both
        self.pitches = draw.uniform(2.5, 4.5)
        # 30 % below the equilibrium
        self.depth = 0.7 * self.line_load / STIFFNESS
        masses = [
            OTHER["density"] * math.pi * r**2 * w.width / 2
            for r, w in zip(self.radii, self.wheels, strict=True)
        ]
        self.mass = masses[0] * masses[1] / sum(masses)
        self.frequency = math.sqrt(STIFFNESS * self.common / self.mass) / (2 * math.pi)
        self.speed = self.log(0.15, 3) * self.frequency * 2 * math.pi / self.wheels[0].teeth
        self.before_case = self.draw.getstate()

    # Random choices.

    def chance(self, probability: float) -> bool:
        return self.draw.random() < probability

    def log(self, low: float, high: float) -> float:
        return math.exp(self.draw.uniform(math.log(low), math.log(high)))

    # Wheels.

    def wheel(self) -> Wheel:
        """Draw teeth that are neither undercut nor pointed, or any."""
        teeth = round(self.log(12, 120))
        least = 1 - teeth * math.sin(self.angle) ** 2 / 2
        low, high = max(least + 0.05, -0.4), min(0.1 + teeth / 50, 0.8)
        if self.careless:
            low, high = -0.6, 1.0
        shift = self.draw.uniform(low, max(low + 0.05, high))
        return Wheel(teeth, shift, self.module * self.draw.uniform(4, 16))

    def hub(self, wheel: Wheel) -> Block:
        """Support of the wheel body: in its bore, or at a diameter above it."""
        root = wheel.teeth / 2 + wheel.shift - 1.25 - 0.02
        largest = 2 * (root - REACH) * self.module
        part = self.draw.uniform(0.05, 1.1 if self.careless else 0.98)
        if self.chance(0.5):
            return {"bore": part * largest, "compliance": {}}
        bore = 0.0 if self.chance(0.5) else 0.5 * part * largest
        return {"bore": bore, "compliance": {"hub_diameter": part * largest}}

    def compliance(self, i: int) -> Block:
        """Compliance of a wheel."""
        wheel = self.wheels[i]
        fields = self.hub(wheel)
        given = fields["compliance"]
        kind = self.draw.choice((*("finite_elements",) * 9, "analytic", "table", "none"))
        e = self.materials[i]["youngs_modulus"]
        if kind == "table":
            size = self.module * wheel.teeth * math.sin(self.angle) / 2
            at = [0.2 * size, size, size + 4 * self.module]
            body = self.draw.uniform(0.5, 4.0)
            fields["compliance"] = {
                **{"model": "table", "rho": at},
                **{"c": [(body + c) / e for c in (0.5, 1.5, 5.0)]},
                **({"c_1": [body / e] * 3} if self.chance(0.7) else {}),
            }
        elif kind == "none":
            fields["compliance"] = {"model": "none"}
        elif kind == "analytic":
            given["model"] = "analytic"
        else:
            given["order"] = self.draw.choice((4, 5, 6, 8))
        if kind in ("analytic", "finite_elements") and self.chance(0.2):
            given["state"] = "plane_stress"
        return fields

    def relief(self, wheel: Wheel, end: str) -> Block:
        """Relief at one end of a flank."""
        tip = self.module * (wheel.teeth + 2 + 2 * wheel.shift)
        depth = self.draw.uniform(0.3, 0.9) if end == "tip" else self.draw.uniform(1.0, 1.5)
        return {
            "amount": self.log(1e-4, 8e-3) * self.module,
            "diameter": tip - 2 * depth * self.module,
            "shape": self.draw.choice(("linear", "parabolic")),
        }

    def deviations(self, i: int) -> Block:
        """Modifications of the profile, and errors of one of the wheels."""
        fields: Block = {}
        wheel = self.wheels[i]
        for end, likely in (("tip", 0.5), ("root", 0.2)):
            if self.chance(likely):
                fields[f"{end}_relief"] = self.relief(wheel, end)
        if self.chance(0.15):
            fields["profile_crowning"] = self.log(1e-4, 3e-3) * self.module
        if self.errors != i:
            return fields
        kind = self.draw.choice(("pitch_errors", "accuracy", "eccentricity"))
        size = self.log(1e-4, 3e-3) * self.module
        fields[kind] = {
            "pitch_errors": [self.draw.gauss(0, size) for _ in range(wheel.teeth)],
            "accuracy": {"class": self.draw.randint(3, 7), "seed": 5},
            "eccentricity": {"amount": size, "phase": self.draw.uniform(-180, 180)},
        }[kind]
        return fields

    def support(self) -> Block:
        """Undamped support of a moving axis."""
        stiffness = STIFFNESS * self.common * self.log(0.1, 10)
        if self.chance(0.5):
            return {
                **{"kind": "slider", "direction": self.draw.uniform(-180, 180)},
                **{"mass": self.mass, "stiffness": stiffness},
            }
        return {
            **{"kind": "bearing", "mass": self.mass},
            "stiffness": [stiffness, self.draw.uniform(0.5, 2) * stiffness],
        }

    def block(self, i: int) -> Block:
        """One wheel."""
        wheel = self.wheels[i]
        fields: Block = {
            **{"name": ("pinion", "gear")[i], "teeth": wheel.teeth, "module": self.module},
            **{"pressure_angle": self.degrees, "profile_shift": wheel.shift},
            **{"rack": {"root_radius": 0.38 if self.degrees == 20 else 0.25}},
            **{"width": wheel.width, "material": f"material-{i}"},
            **self.compliance(i),
            **self.deviations(i),
        }
        if self.chance(0.6):
            fields["thickness_allowance"] = -self.log(1e-3, 2e-2) * self.module
        if self.careless and self.chance(0.5):
            fields["tip_alteration"] = self.draw.uniform(-0.6, 0.1)
        if self.moves in (i, 2):
            fields["support"] = self.support()
        return fields

    def mesh(self) -> Block:
        """Mesh without damping and friction."""
        fields: Block = {
            **{"driving": "pinion", "driven": "gear"},
            **{"centre_line_angle": self.draw.uniform(-180, 180)},
            **{"damping": {"law": "none"}, "friction": {"law": "none"}},
        }
        fields["driving_rotation"] = "counterclockwise" if self.sense > 0 else "clockwise"
        if self.chance(0.8):
            fields["backlash"] = self.log(3e-3, 5e-2) * self.module
        if self.chance(0.15):
            fields["tooth_coupling"] = "false"
        if self.chance(0.1):
            fields["edge_contact"] = "false"
        return fields

    def at_rest(self, *, errors: bool) -> Block:
        """The case on fixed axes, with or without its errors of pitch and runout."""
        case = self.case()
        for wheel in case["wheels"]:
            for key in ("support", *(() if errors else ERRORS)):
                wheel.pop(key, None)
        return case

    def slow(self, lag: float, *, coasts: bool, friction: float) -> Block:
        """Case on fixed axes, damped, with 5e5 natural periods per pitch.

        The torque of the driving wheel and the speed of the driven wheel are constant. The initial
        transmission error is `lag` [m].
        """
        case = self.at_rest(errors=True)
        speed = self.slow_speed()
        mesh, (pinion, gear) = case["meshes"][0], case["wheels"]
        mesh["damping"] = {"law": "ratio", "value": 0.1}
        if friction > 0:
            width = 2e-3 * speed * self.radii[0]
            mesh["friction"] = {"law": "coulomb", "coefficient": friction}
            mesh["friction"]["regularisation_velocity"] = width
        if coasts:
            pinion["loads"][0]["value"] *= -1
        ratio = self.wheels[0].teeth / self.wheels[1].teeth
        gear["loads"] = [{"kind": "speed", "value": -self.sense * ratio * speed}]
        duration = 2 * math.pi / (self.wheels[0].teeth * speed)
        case["simulation"] |= {
            **{"duration": duration, "output_interval": duration / 97, "max_step": duration},
            "initial": {
                **{"kind": "speeds", "gaps": {"pinion-gear": -lag}},
                "speeds": {"pinion": self.sense * speed, "gear": -self.sense * ratio * speed},
            },
        }
        return case

    def slow_speed(self) -> float:
        """Speed of the driving wheel in a slow run [rad/s]."""
        return 2e-6 * self.frequency * 2 * math.pi / self.wheels[0].teeth

    def case(self) -> Block:
        """Undamped case, with too little initial deflection."""
        self.draw.setstate(self.before_case)  # the same at each call
        blocks = [self.block(i) for i in range(2)]
        ratio = self.wheels[0].teeth / self.wheels[1].teeth
        for block, factor in zip(blocks, (1, 1 / ratio), strict=True):
            block["loads"] = [{"kind": "torque", "value": self.sense * factor * self.torque}]
        duration = self.pitches * 2 * math.pi / (self.wheels[0].teeth * self.speed)
        speeds = {"pinion": self.sense * self.speed, "gear": -self.sense * ratio * self.speed}
        return {
            "format": 1,
            "materials": {f"material-{i}": dict(of) for i, of in enumerate(self.materials)},
            "wheels": blocks,
            "meshes": [self.mesh()],
            "simulation": {
                **{"duration": duration, "output_interval": duration / OUTPUTS},
                **{"tolerance": 1e-10},
                "initial": {
                    **{"kind": "speeds", "speeds": speeds},
                    "gaps": {"pinion-gear": -self.depth},
                },
            },
        }
