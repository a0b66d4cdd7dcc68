"""Gearboxes with friction that decreases with the sliding velocity: a seed gives a case.

Every other one is a random gearbox that keeps contact, turns slowly and has Stribeck's law in every
mesh: most of them vibrate all the time. The others are quiet pairs: a well damped contact, an axis
in a light bearing, and rare events. Their vibrations decay, and later grow from almost nothing
where friction decreases.
"""

from __future__ import annotations

import math
from typing import Any

from system.random_gearboxes import DENSITY, Gearbox

OUTPUTS = 4000  # enough to sample a vibration of some kilohertz

Block = dict[str, Any]


def is_quiet(seed: int) -> bool:
    """Whether the gearbox of a seed is a quiet pair."""
    return seed % 2 == 1


def stribeck_gearbox(seed: int) -> Block:
    """Create the case of a seed."""
    made = _QuietPair(seed) if is_quiet(seed) else _SlowGearbox(seed)
    case = made.case()
    simulation = case["simulation"]
    simulation["output_interval"] = simulation["duration"] / OUTPUTS
    return case


class _Falling(Gearbox):
    """A gearbox with decreasing friction."""

    def __init__(self, seed: int) -> None:
        super().__init__(2 * seed)  # an even seed keeps contact

    def draw_size(self) -> None:
        super().draw_size()
        self.speed = self.choice(-1, 1) * self.log_uniform(3, 30)  # [rad/s]
        pitch = 2 * math.pi / (self.teeth * abs(self.speed))  # [s]
        self.duration = min(self.uniform(1.2, 4) * pitch, 0.1)

    def friction(self) -> Block:
        kinetic = self.uniform(0.1, 0.25)
        sliding = 5 * self.module * abs(self.speed)  # at about a pitch from the pitch point
        return {
            "law": "stribeck",
            "static_coefficient": kinetic * self.uniform(1.3, 2),
            "kinetic_coefficient": kinetic,
            "stribeck_velocity": sliding * self.log_uniform(0.3, 2),
            "regularisation_velocity": sliding * self.log_uniform(0.03, 0.3),
        }


class _SlowGearbox(_Falling):
    """Any gearbox that turns slowly."""

    def damping(self, driver: Block, driven: Block) -> Block:
        damping = super().damping(driver, driven)
        if "coefficient" in damping:
            damping["coefficient"] *= self.log_uniform(0.1, 10)
        else:
            damping["v0_min"] = self.log_uniform(1e-3, 0.1)
        return damping


class _QuietPair(_Falling):
    """Two wheels by the paper's rule, the second on a light bearing, heavily loaded."""

    def draw_size(self) -> None:
        super().draw_size()
        self.module = self.log_uniform(5e-4, 2e-3)
        self.width = self.module * self.uniform(2, 6)
        self.force = self.width * self.log_uniform(2e5, 6e5)  # [N/m]
        self.torque = self.force * self.module * self.teeth / 2

    def build(self) -> None:
        self.real = False
        rack = {"radius": self.module / 2, "angle": self.uniform(15, 25)}
        self.add_gear("w0", 1.0, rack, self.teeth)["centre"] = [0, 0]
        self.add_mesh("w0")
        self.wheels[0].pop("support", None)
        self.wheels[1]["support"] = self.bearing(self.wheels[1])

    def bearing(self, wheel: Block) -> Block:
        solid = DENSITY * math.pi * wheel["pitch_radius"] ** 2 * self.width
        mass = solid * self.uniform(0.1, 0.4)
        stiffness = [self.log_uniform(1e7, 1e8) for _ in "xy"]
        damping = 2 * self.log_uniform(0.003, 0.03) * math.sqrt(stiffness[0] * mass)
        return {
            **{"kind": "bearing", "mass": mass, "stiffness": stiffness},
            "damping": [damping, damping],
        }

    def friction(self) -> Block:
        friction = super().friction()
        sliding = 5 * self.module * abs(self.speed)
        return friction | {"regularisation_velocity": sliding * self.log_uniform(0.08, 0.3)}

    def damping(self, driver: Block, driven: Block) -> Block:
        law = self.choice("hunt_crossley", "lankarani_nikravesh", "flores", "gonthier", "lee_wang")
        return {"law": law, "restitution": self.uniform(0.3, 0.8), "v0_min": 1e-3}
