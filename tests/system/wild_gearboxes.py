"""Wild gearboxes: all features of a case, at loads and speeds beyond engineering practice.

They are the random gearboxes with every law, support, housing and deviation, every compatible
tracking and rigid contact, moduli from 0.5 to 20 mm and loads up to the limit of the force law. A
case that is rejected, or a run that the model ends with a message, is no failure:
`test_wild_gearboxes.py` tests the complete runs.
"""

from __future__ import annotations

import math

from system.random_gearboxes import DENSITY, STIFFNESS, Block, Gearbox

OUTPUTS = 40  # of a run
LARGEST_SPEED = 40.0  # of the pitch circle [m/s]


def wild_gearbox(seed: int) -> Block:
    """Create the case of a seed."""
    return WildGearbox(seed).case()


class WildGearbox(Gearbox):
    """Generator of a wild gearbox."""

    def __init__(self, seed: int) -> None:
        super().__init__(1_000_003 * (seed + 1))

    def draw_size(self) -> None:
        self.losing = self.chance(0.5)
        self.shaken = False  # the housing is added later
        self.rigid = self.chance(0.08)
        self.modified = not self.rigid and self.chance(0.5)
        self.tracking = "closed_form"
        if not self.modified and self.chance(0.3):
            self.tracking = self.choice("algebraic", "differential")
        self.module = self.log_uniform(5e-4, 2e-2)
        self.width = self.module * self.uniform(4, 16)
        self.teeth = self.integer(12, 40)
        radius = self.module * self.teeth / 2
        largest = min(1e3, LARGEST_SPEED / radius)
        self.speed = self.choice(-1, 1) * self.log_uniform(0.02 * largest, largest)
        stress = self.log_uniform(1e5, 6e8)  # tangential force over module and width [Pa]
        self.force = stress * self.module * self.width
        self.torque = self.force * radius
        pitch = 2 * math.pi / (self.teeth * abs(self.speed))
        self.duration = self.uniform(1, 6) * pitch

    def add_deviations(self, wheel: Block) -> None:
        if not self.modified:
            return
        module, teeth = wheel["module"], wheel["teeth"]
        if teeth < 17:
            wheel["profile_shift"] = max(wheel["profile_shift"], 0.35)  # no undercut
        tip = module * (teeth + 2 + 2 * wheel["profile_shift"])
        shape = self.choice("linear", "parabolic")
        if self.chance(0.4):
            wheel["tip_relief"] = {
                "amount": self.log_uniform(1e-3, 2e-2) * module,
                "diameter": tip - self.uniform(0.3, 1.4) * module,
                "shape": shape,
            }
        if self.chance(0.2):
            wheel["root_relief"] = {
                "amount": self.log_uniform(1e-3, 1e-2) * module,
                "diameter": module * teeth * (1 + 0.2 * self.uniform(0, 1) / teeth),
                "shape": shape,
            }
        if self.chance(0.25):
            wheel["profile_crowning"] = self.log_uniform(5e-4, 5e-3) * module
        if self.chance(0.4):
            wheel["accuracy"] = {"class": self.integer(1, 11), "seed": self.integer(1, 1000)}
        if self.chance(0.2):
            wheel["eccentricity"] = {
                "amount": self.log_uniform(3e-4, 6e-3) * module,
                "phase": self.uniform(-180, 180),
            }

    def add_gear(self, name: str, ratio: float, rack: Block, teeth: int) -> Block:
        wheel = super().add_gear(name, ratio, rack, teeth)
        if self.real and teeth < 17:
            wheel["profile_shift"] = max(wheel["profile_shift"], 0.35)
        wheel.pop("support", None)
        if self.chance(0.55):
            wheel["support"] = self.support(rack.get("module", self.module) * teeth / 2)
        return wheel

    def support(self, radius: float) -> Block:
        stiffness = STIFFNESS * self.width * self.log_uniform(0.01, 10)
        mass = DENSITY * math.pi * radius**2 * self.width * self.uniform(0.05, 2)
        damping = 2 * self.uniform(0, 0.2) * math.sqrt(stiffness * mass)
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
        super().add_mesh(driving)
        self.meshes[-1]["tracking"] = self.tracking

    def contact(self) -> Block:
        if self.rigid:
            rest = 1e-3 * self.module * abs(self.speed)
            return {"law": "rigid", "restitution": self.uniform(0, 0.9), "rest_velocity": rest}
        if self.chance(0.5):
            return {"law": self.choice("johnson", "radzimovsky")}
        return super().contact()

    def damping(self, driver: Block, driven: Block) -> Block:
        if self.rigid or self.chance(0.1):
            return {"law": "none"}
        return super().damping(driver, driven)

    def case(self) -> Block:
        case = super().case()
        del case["simulation"]["output_interval"]
        case["title"] = "a wild gearbox"
        case["simulation"]["output_interval"] = self.duration / OUTPUTS
        if self.chance(0.4):
            case["gravity"] = [self.uniform(-10, 10) for _ in range(3)]
        kind = self.choice("fixed", "fixed", "prescribed", "prescribed", "mounted")
        if kind != "fixed":
            case["housing"] = getattr(self, kind)()
            if case["simulation"]["initial"]["kind"] == "steady":
                case["simulation"]["initial"] = self.speeds()
        for wheel in self.wheels:
            for load in wheel.get("loads", []):
                if self.chance(0.3) or load["kind"] == "speed":  # as in the start
                    load["against"] = "housing"
        return case

    def prescribed(self) -> Block:
        """Create a housing with prescribed vibration and rotation."""
        pace = abs(self.speed) / (2 * math.pi)  # revolutions of the first wheel [Hz]

        def shake(size: float) -> list[Block]:
            terms = []
            for _ in range(self.choice(0, 1, 1, 2)):
                frequency = pace * self.log_uniform(0.1, 30)
                amplitude = size * self.log_uniform(1e-3, 1)
                axis = self.choice("x", "y", "z")
                terms.append(
                    {
                        **{"kind": "harmonic", "axis": axis, "amplitude": amplitude},
                        **{"frequency": frequency, "phase": self.uniform(-180, 180)},
                    }
                )
            return terms

        rotation = shake(1.0)
        if self.chance(0.3):
            axis = self.choice("x", "y", "z")
            rotation.append({"kind": "rate", "axis": axis, "value": 0.1 * self.speed})
        return {"kind": "prescribed", "translation": shake(self.module), "rotation": rotation}

    def mounted(self) -> Block:
        """Create a housing on springs and dampers."""
        radius = self.module * self.teeth
        mass = 20 * DENSITY * math.pi * radius**2 * self.width
        frequency = abs(self.speed) * self.log_uniform(0.1, 10)
        turning = mass * radius**2
        damping = 2 * self.uniform(0, 0.2) * frequency
        return {
            **{"kind": "mounted", "mass": mass},
            **{"centre_of_mass": [radius * self.uniform(-1, 1) for _ in range(3)]},
            **{"inertia": [turning, 1.1 * turning, 1.3 * turning]},
            "mount": {
                **{"point": [radius * self.uniform(-1, 1) for _ in range(3)]},
                **{"stiffness": [mass * frequency**2] * 3, "damping": [mass * damping] * 3},
                **{"rotational_stiffness": [turning * frequency**2] * 3},
                **{"rotational_damping": [turning * damping] * 3},
            },
        }


def tracked_gearbox(seed: int) -> Block:
    """Create a wild gearbox with differential tracking of all contact points."""
    return _TrackedGearbox(seed).case()


class _TrackedGearbox(WildGearbox):
    def draw_size(self) -> None:
        super().draw_size()
        self.modified = False  # deviations require the closed form
        self.tracking = "differential"
