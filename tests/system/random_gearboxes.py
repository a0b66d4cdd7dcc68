"""Random gearboxes: a seed gives a case, the same on every machine.

A gearbox is a tree. To a first pair of wheels, further meshes are added at the teeth of an existing
wheel (an idler) or by a shaft with another pinion on it, and discs on shafts. Every second seed is
constructed to lose contact. Invalid cases are excluded: undercut or pointed teeth, inconsistent
initial speeds along the train, a steady start without a steady state, and pairs by the paper's rule
that turn back below their base circle.
"""

from __future__ import annotations

import math
import random
from typing import Any

STEEL = {"youngs_modulus": 2.06e11, "poisson_ratio": 0.3, "density": 7830.0}
DENSITY = STEEL["density"]
STIFFNESS = 1.4e10  # of a tooth pair over its width [N/m2], for laws with a given stiffness
KNOTS = 8  # per period of a fluctuating speed or torque
HARMONIC = [math.sin(2 * math.pi * i / KNOTS) for i in range(KNOTS)]

Block = dict[str, Any]


def loses_contact(seed: int) -> bool:
    """Whether the gearbox of a seed is constructed to lose contact."""
    return seed % 2 == 1


def random_gearbox(seed: int) -> Block:
    """Create the case of a seed."""
    return Gearbox(seed).case()


class Gearbox:
    """Generator of a gearbox."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.wheels: list[Block] = []
        self.meshes: list[Block] = []
        self.shafts: list[Block] = []
        self.ratio: dict[str, float] = {}  # speed of each wheel over that of the first
        self.rack: dict[str, Block] = {}  # common parameters of wheels in mesh, by wheel
        self.losing = loses_contact(seed)
        self.shaken = self.chance(0.1)  # by motion of the housing
        self.draw_size()
        self.build()

    # Random choices.

    def chance(self, probability: float) -> bool:
        return self.random.random() < probability

    def uniform(self, low: float, high: float) -> float:
        return low + (high - low) * self.random.random()

    def log_uniform(self, low: float, high: float) -> float:
        return math.exp(self.uniform(math.log(low), math.log(high)))

    def integer(self, low: int, high: int) -> int:
        return low + int((high - low + 1) * self.random.random())

    def choice(self, *of: Any) -> Any:
        return of[int(len(of) * self.random.random())]

    # Sizes.

    def draw_size(self) -> None:
        """Draw module, speed and load of the first pair, and the duration."""
        self.module = self.log_uniform(1e-3, 5e-3)
        self.width = self.module * self.uniform(6, 14)
        self.speed = self.choice(-1, 1) * self.log_uniform(10, 300)  # [rad/s]
        self.teeth = self.integer(18, 40)
        stress = self.log_uniform(1e6, 6e7)  # tangential force over module and width [Pa]
        self.force = stress * self.module * self.width
        self.torque = self.force * self.module * self.teeth / 2
        pitch = 2 * math.pi / (self.teeth * abs(self.speed))  # [s]
        self.duration = min(self.uniform(3, 15) * pitch, 0.2)

    def build(self) -> None:
        """Add wheels, meshes and shafts."""
        self.real = self.chance(0.6)
        first = self.add_gear("w0", 1.0, self.new_rack(), self.teeth)
        first["centre"] = [0, 0]
        self.add_mesh("w0")
        for _ in range(self.choice(0, 0, 0, 1, 1, 2)):
            with_teeth = [w["name"] for w in self.wheels if "teeth" in w]
            at = with_teeth[-1] if self.chance(0.7) else self.choice(*with_teeth)
            if self.chance(0.6):
                at = self.add_pinion_on_shaft(at)
            self.add_mesh(at)
        if self.chance(0.3):
            self.add_disc("w0")
        if self.chance(0.3):
            self.add_disc(self.wheels[-1]["name"])

    def new_rack(self) -> Block:
        """Draw the common parameters of wheels in mesh."""
        if self.real:
            angle = self.choice(20, 20, 22.5, 25)
            return {
                **{"module": self.module, "pressure_angle": angle},
                "rack": {"root_radius": 0.38 if angle == 20 else 0.25},
            }
        return {"radius": self.module / 2, "angle": self.uniform(12, 25)}

    def add_gear(self, name: str, ratio: float, rack: Block, teeth: int) -> Block:
        """Add a wheel with teeth."""
        wheel: Block = {"name": name, "teeth": teeth, "width": self.width, "material": "steel"}
        if self.real:
            wheel |= rack
            wheel["profile_shift"] = self.uniform(0.0, 0.4)
            self.add_deviations(wheel)
        else:
            wheel["pitch_radius"] = rack["radius"] * teeth
        if self.chance(0.35):
            wheel["support"] = self.support(rack.get("module", self.module) * teeth / 2)
        self.wheels.append(wheel)
        self.ratio[name], self.rack[name] = ratio, rack
        return wheel

    def add_deviations(self, wheel: Block) -> None:
        """Add tip relief, pitch errors, crowning or runout to a gear with a basic rack, or none."""
        module, teeth = wheel["module"], wheel["teeth"]
        tip = module * (teeth + 2 + 2 * wheel["profile_shift"])
        if self.chance(0.3):
            wheel["tip_relief"] = {
                "amount": self.log_uniform(1e-3, 6e-3) * module,
                "diameter": tip - self.uniform(0.4, 1.2) * module,
                "shape": self.choice("linear", "parabolic"),
            }
        if self.chance(0.15):
            wheel["profile_crowning"] = self.log_uniform(5e-4, 3e-3) * module
        if self.chance(0.2):
            wheel["accuracy"] = {"class": self.integer(3, 6), "seed": self.integer(1, 1000)}
        if self.chance(0.1):
            wheel["eccentricity"] = {"amount": 2e-3 * module, "phase": self.uniform(-180, 180)}

    def support(self, radius: float) -> Block:
        """Support of a moving axis."""
        stiffness = STIFFNESS * self.width * self.log_uniform(0.03, 10)
        mass = DENSITY * math.pi * radius**2 * self.width * self.uniform(0.2, 2)
        damping = 2 * self.uniform(0.01, 0.2) * math.sqrt(stiffness * mass)
        if self.chance(0.5):
            return {
                **{"kind": "slider", "direction": self.uniform(-180, 180), "mass": mass},
                **{"stiffness": stiffness, "damping": damping},
            }
        factor = self.uniform(0.5, 2)
        return {
            **{"kind": "bearing", "mass": mass},
            **{"stiffness": [stiffness, factor * stiffness], "damping": [damping, damping]},
        }

    def add_mesh(self, driving: str) -> None:
        """Add a wheel driven by an existing wheel with teeth."""
        driver = next(w for w in self.wheels if w["name"] == driving)
        teeth = self.integer(18, 60)
        name = f"w{len(self.wheels)}"
        ratio = -self.ratio[driving] * driver["teeth"] / teeth
        driven = self.add_gear(name, ratio, self.rack[driving], teeth)
        if "axial_position" in driver:
            driven["axial_position"] = driver["axial_position"]
        sense = "counterclockwise" if self.speed * self.ratio[driving] > 0 else "clockwise"
        mesh: Block = {
            **{"driving": driving, "driven": name, "driving_rotation": sense},
            **{"centre_line_angle": self.uniform(-180, 180)},
            **{"contact": self.contact(), "friction": self.friction()},
        }
        mesh["damping"] = self.damping(driver, driven)
        if not self.real:
            mesh["pressure_angle"] = self.rack[driving]["angle"]
        if self.real or self.losing or self.chance(0.3):
            mesh["backlash"] = self.log_uniform(5e-3, 4e-2) * self.module
        self.meshes.append(mesh)

    def add_pinion_on_shaft(self, at: str) -> str:
        """Add another wheel with teeth on the axis of a wheel."""
        name = f"w{len(self.wheels)}"
        wheel = self.add_gear(name, self.ratio[at], self.new_rack(), self.integer(18, 30))
        wheel["axial_position"] = 3 * self.width * (1 + len(self.shafts))
        self.add_shaft(at, name)
        return name

    def add_disc(self, at: str) -> None:
        """Add a motor or a load on the axis of a wheel."""
        name = f"w{len(self.wheels)}"
        radius = self.module * self.uniform(15, 40)
        disc = {"name": name, "radius": radius, "width": 2 * self.width, "material": "steel"}
        self.wheels.append(disc)
        self.ratio[name] = self.ratio[at]
        self.add_shaft(at, name)

    def add_shaft(self, first: str, second: str) -> None:
        """Join two wheels by a shaft, elastic or rigid."""
        shaft: Block = {"name": f"{first}-{second}-shaft", "wheels": [first, second]}
        if self.chance(0.4):
            shaft["kind"] = "rigid"
        else:
            radius = self.module * self.teeth / 2
            shaft["stiffness"] = STIFFNESS * self.width * radius**2 * self.log_uniform(0.01, 1)
            inertia = DENSITY * math.pi / 2 * radius**4 * self.width
            critical = 2 * math.sqrt(shaft["stiffness"] * inertia)
            shaft["damping"] = self.uniform(0.005, 0.1) * critical
        self.shafts.append(shaft)

    # Laws.

    def contact(self) -> Block:
        stiffness = STIFFNESS * self.width * self.log_uniform(0.3, 3)
        law = self.choice("johnson", "johnson", "radzimovsky", "yang_lin", "linear", "power")
        if law == "linear":
            return {"law": law, "stiffness": stiffness}
        if law == "power":
            exponent = self.uniform(1.0, 1.6)
            depth = self.force / stiffness
            return {
                **{"law": law, "exponent": exponent},
                **{"coefficient": stiffness * depth ** (1 - exponent)},
            }
        return {"law": law}

    def damping(self, driver: Block, driven: Block) -> Block:
        law = self.choice(
            *("linear", "linear", "one_sided", "hunt_crossley", "lankarani_nikravesh"),
            *("flores", "gonthier", "lee_wang"),
        )
        masses = [
            DENSITY * math.pi / 2 * (self.module / 2 * wheel["teeth"]) ** 2 * self.width
            for wheel in (driver, driven)
        ]
        mass = masses[0] * masses[1] / sum(masses)
        linear = 2 * self.uniform(0.02, 0.2) * math.sqrt(STIFFNESS * self.width * mass)
        if law == "linear":
            return {"law": law, "coefficient": linear}
        if law == "one_sided":
            depth = self.force / (STIFFNESS * self.width)
            return {"law": law, "coefficient": 2 * linear / depth}
        # the v0_min used for docs/guides/integrators.md; that of the mesh damps less
        return {"law": law, "restitution": self.uniform(0.3, 0.95), "v0_min": 1e-3}

    def friction(self) -> Block:
        law = self.choice("none", "coulomb", "coulomb", "tanh", "stribeck")
        if law == "none":
            return {"law": law}
        kinetic = self.uniform(0.02, 0.12)
        smooth = {"regularisation_velocity": self.log_uniform(1e-3, 2e-2)}
        if law == "stribeck":
            return {
                **{"law": law, "kinetic_coefficient": kinetic, **smooth},
                **{"static_coefficient": kinetic * self.uniform(1, 2)},
                **{"stribeck_velocity": self.log_uniform(1e-2, 0.2)},
            }
        return {"law": law, "coefficient": kinetic, **smooth}

    # Loads and start.

    def case(self) -> Block:
        """Add loads and a start, and return the case."""
        start = self.add_losing_loads() if self.losing else self.add_steady_loads()
        case: Block = {
            **{"format": 1, "materials": {"steel": dict(STEEL)}, "wheels": self.wheels},
            **{"meshes": self.meshes},
            "simulation": {
                **{"duration": self.duration, "output_interval": self.duration / 500},
                **{"initial": start},
            },
        }
        if self.shafts:
            case["shafts"] = self.shafts
        if self.chance(0.1):
            case["gravity"] = [0, -9.81, 0]
        if self.shaken:
            case["housing"] = {
                "kind": "prescribed",
                "translation": [
                    {
                        **{"kind": "harmonic", "axis": self.choice("x", "y")},
                        **{"amplitude": self.log_uniform(1e-5, 1e-3)},
                        **{"frequency": self.log_uniform(5, 100)},
                    }
                ],
            }
        return case

    def outputs(self) -> list[Block]:
        """Wheels that drive no other, or the last one: those with the output loads."""
        busy = {"w0"} | {mesh["driving"] for mesh in self.meshes}
        busy |= {wheel for shaft in self.shafts for wheel in shaft["wheels"][:1]}
        return [wheel for wheel in self.wheels if wheel["name"] not in busy] or self.wheels[-1:]

    def add_steady_loads(self) -> Block:
        """Drive the train by a torque or a speed against resisting loads."""
        share = self.torque / len(self.outputs())
        for wheel in self.outputs():
            speed = self.speed * self.ratio[wheel["name"]]
            torque = share / self.ratio[wheel["name"]]  # torque for its share of the power
            if self.chance(0.7):
                load = {"kind": "viscous", "coefficient": abs(torque / speed)}
            else:
                load = {"kind": "torque", "value": -math.copysign(torque, speed)}
            wheel["loads"] = [load]
        held = any(w["loads"][0]["kind"] == "viscous" for w in self.outputs())
        if self.chance(0.7) and held:
            self.wheels[0]["loads"] = [self.torque_load(1.0)]
        else:
            self.wheels[0]["loads"] = [{"kind": "speed", "value": self.speed}]
        moving = self.speeds()
        driven = self.wheels[0]["loads"][0]["kind"] == "torque"
        rest = {"kind": "rest"} if driven else moving
        steady = moving if self.shaken else {"kind": "steady"}
        return self.choice(steady, steady, moving, rest)

    def add_losing_loads(self) -> Block:
        """Make the flanks separate by a fluctuating drive, a torque reversal or a gap."""
        kind = self.choice("speed", "torque", "reversal", "gap")
        if kind in ("torque", "reversal") and not self.can_turn_back():
            kind = "gap"
        light = 1.0 if kind == "gap" else self.log_uniform(0.003, 0.3)
        for wheel in self.outputs():
            torque = light * self.torque / len(self.outputs()) / abs(self.ratio[wheel["name"]])
            speed = self.speed * self.ratio[wheel["name"]]
            wheel["loads"] = [{"kind": "torque", "value": -math.copysign(torque, speed)}]
        period = self.duration / self.uniform(1, 4)
        if kind == "speed":
            swing = self.uniform(0.01, 0.06)
            time, values = self.fluctuation(period, lambda s: self.speed * (1 + swing * s))
            self.wheels[0]["loads"] = [{"kind": "speed", "time": time, "speed": values}]
        elif kind == "torque":
            swing = self.uniform(1.5, 6)
            time, values = self.fluctuation(period, lambda s: light * (1 + swing * s))
            self.wheels[0]["loads"] = [self.torque_load(values, time)]
        elif kind == "reversal":
            knots = sorted(self.uniform(0.1, 0.9) * self.duration for _ in range(4))
            values = [light, light, -light, -light, light, light]
            time = [0.0, *knots, self.duration]
            self.wheels[0]["loads"] = [self.torque_load(values, time)]
        else:
            self.wheels[0]["loads"] = [self.torque_load(1.0)]
        return self.speeds(gap=kind == "gap")

    def can_turn_back(self) -> bool:
        """Whether the path of contact of every mesh is long enough when the wheels turn backwards.

        A pair by the paper's rule turns back one pitch before the following pair takes over. Its
        path must therefore start more than a pitch from the base circle.
        """
        teeth = {wheel["name"]: wheel.get("teeth", 0) for wheel in self.wheels}
        for mesh in self.meshes:
            angle = math.radians(mesh.get("pressure_angle", 90))
            line = math.tan(angle) * (teeth[mesh["driving"]] + teeth[mesh["driven"]])
            if line < 3.1 * 2 * math.pi:  # length of the line of action, 2 pi to a base pitch
                return False
        return True

    def fluctuation(self, period: float, value: Any) -> tuple[list[float], list[float]]:
        """Knots of a harmonic, from 0 beyond the end of the run."""
        n = math.ceil(KNOTS * self.duration / period) + 1
        times = [period * i / KNOTS for i in range(n)]
        return times, [value(HARMONIC[i % KNOTS]) for i in range(n)]

    def torque_load(self, part: float | list[float], time: list[float] | None = None) -> Block:
        """Fraction of the nominal torque in the nominal direction, constant or a table."""
        full = math.copysign(self.torque, self.speed)
        if isinstance(part, float):
            return {"kind": "torque", "value": part * full}
        return {"kind": "table", "time": time, "torque": [value * full for value in part]}

    def speeds(self, gap: bool = False) -> Block:
        """Start with the nominal speeds, and with gaps or with the flanks in contact."""
        speeds = {name: self.speed * ratio for name, ratio in self.ratio.items()}
        start: Block = {"kind": "speeds", "speeds": speeds}
        if gap:
            start["gaps"] = {
                f"{mesh['driving']}-{mesh['driven']}": self.uniform(0.05, 0.9) * mesh["backlash"]
                for mesh in self.meshes
            }
        return start
