"""Wide gearboxes: wild ones over all scales, and all other kinds of random gearboxes.

A seed gives a case, its last digit the kind. The wide ones have loads over twelve decades and
speeds over six, and are then converted to other units: lengths over eight decades, times and masses
over twelve. All keys with a unit are explicit, so that a change of units changes only the digits.
"""

from __future__ import annotations

import math
from pathlib import Path

from system.bending_pairs import BendingPair
from system.random_gearboxes import DENSITY, STIFFNESS, Block
from system.scaled_cases import Scales, scaled_case
from system.stribeck_gearboxes import stribeck_gearbox
from system.wild_gearboxes import WildGearbox, tracked_gearbox, wild_gearbox

PERIODS = 300  # natural periods of a mesh in a run, at most
OUTPUTS = 40
IDA_LONGEST_STEP = 0.02  # [s], if a case does not set one
KINDS = (
    *("wide", "wide", "wide", "wide", "scaled", "wild", "tracked"),
    *("falling friction", "bending", "bouncing"),
)


def kind_of(seed: int) -> str:
    """Kind of gearbox of a seed."""
    return KINDS[seed % len(KINDS)]


def wide_case(program: Path, seed: int) -> Block:
    """Create the case of a seed; the program reports the units of keys."""
    kind, number = kind_of(seed), 10_000 + seed
    if kind == "wild":
        return wild_gearbox(number)
    if kind == "tracked":
        return tracked_gearbox(number)
    if kind == "falling friction":
        return with_few_outputs(stribeck_gearbox(number // len(KINDS)))
    if kind == "bending":
        return with_few_outputs(BendingPair(number).case())
    if kind == "bouncing":
        return _BouncingGearbox(number).case()
    if kind == "scaled":
        return scaled_case(program, unscaled_case(seed), scales_of(seed))
    return _WideGearbox(number).case()


def unscaled_case(seed: int) -> Block:
    """Create the case of a seed of kind "scaled" in its first units."""
    case = _WideGearbox(10_000 + seed).case()
    case["simulation"]["max_step"] = IDA_LONGEST_STEP
    return case


def scales_of(seed: int) -> Scales:
    """Units of a seed of kind "scaled"."""
    made = _WideGearbox(10_000 + seed)
    made.case()
    return made.scales()


def with_few_outputs(case: Block) -> Block:
    """Return the case with OUTPUTS outputs."""
    simulation = case["simulation"]
    simulation["output_interval"] = simulation["duration"] / OUTPUTS
    return case


class _WideGearbox(WildGearbox):
    """Loads over twelve decades, speeds over six; runs of at most PERIODS natural periods."""

    def draw_size(self) -> None:
        super().draw_size()
        largest = abs(self.speed)
        self.speed = math.copysign(largest * self.log_uniform(1e-4, 1), self.speed)
        self.force = self.log_uniform(1e-3, 1e9) * self.module * self.width
        radius = self.module * self.teeth / 2
        self.torque = self.force * radius
        mass = DENSITY * math.pi / 4 * radius**2 * self.width
        period = 2 * math.pi * math.sqrt(mass / (STIFFNESS * self.width))
        pitch = 2 * math.pi / (self.teeth * abs(self.speed))
        self.duration = min(self.uniform(1, 6) * pitch, PERIODS * self.uniform(0.2, 1) * period)

    def add_deviations(self, wheel: Block) -> None:
        super().add_deviations(wheel)
        if wheel.pop("accuracy", None):  # classes are in micrometres
            size = self.log_uniform(1e-5, 5e-3) * self.module
            errors = [size * self.uniform(-1, 1) for _ in range(wheel["teeth"])]
            wheel["pitch_errors"] = errors

    def scales(self) -> Scales:
        """Draw other units."""
        return Scales(
            self.log_uniform(1e-4, 1e4), self.log_uniform(1e-6, 1e6), self.log_uniform(1e-6, 1e6)
        )


class _BouncingGearbox(WildGearbox):
    """Rigid bouncing flanks, down to rest velocities beyond double precision."""

    def draw_size(self) -> None:
        super().draw_size()
        self.losing = True
        self.rigid, self.modified, self.tracking = True, False, "closed_form"
        self.rest = self.log_uniform(1e-12, 1) * self.module * abs(self.speed)

    def contact(self) -> Block:
        restitution = self.choice(self.uniform(0, 1), 1 - self.log_uniform(1e-4, 0.1), 1.0)
        return {"law": "rigid", "restitution": restitution, "rest_velocity": self.rest}
