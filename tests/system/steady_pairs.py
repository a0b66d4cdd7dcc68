"""Random pairs with a steady start, and the same cases with wheels and loads in another order."""

from __future__ import annotations

import copy
import math
import random
from typing import Any

from system.bending_pairs import BendingPair

Block = dict[str, Any]
PITCHES = 5
POINTS = 40  # outputs in a pitch
# At 1e-12 the integration error over five pitches exceeds 1e-9 for two of the 500 pairs.
TOLERANCE = 1e-13


def steady_pair(seed: int, *, rounding: bool = False) -> Block:
    """Return a damped pair of the random set, driven by a torque against a viscous load."""
    pair = BendingPair(seed)
    draw = random.Random(9_000_001 * (seed + 1))
    case: Block = pair.case()
    pinion, gear = case["wheels"]
    mesh = case["meshes"][0]
    mesh["damping"] = {"law": "ratio", "value": draw.uniform(0.03, 0.1)}
    if draw.random() < 0.5:
        mesh["friction"] = {"law": "coulomb", "coefficient": draw.uniform(0.02, 0.08)}
        mesh["friction"]["regularisation_velocity"] = 2e-3 * pair.speed * pair.radii[0]
    for wheel in case["wheels"]:
        support = wheel.get("support")
        if support is not None:
            given = support["stiffness"]
            damping = 0.05 * math.sqrt(
                pair.mass * (given if isinstance(given, float) else given[0])
            )
            support["damping"] = damping if isinstance(given, float) else [damping, damping]
        if rounding:
            wheel["tip_rounding"] = draw.uniform(0.02, 0.08) * pair.module
    ratio = pair.wheels[1].teeth / pair.wheels[0].teeth
    viscous = pair.torque * ratio**2 / pair.speed
    pinion["loads"] = [
        {"kind": "torque", "value": pair.sense * 0.7 * pair.torque},
        {"kind": "torque", "value": pair.sense * 0.3 * pair.torque},
    ]
    gear["loads"] = [
        {"kind": "viscous", "coefficient": 0.6 * viscous},
        {"kind": "viscous", "coefficient": 0.4 * viscous},
    ]
    pitch = 2 * math.pi / (pair.wheels[0].teeth * pair.speed)
    case["simulation"] = {
        **{"duration": PITCHES * pitch, "output_interval": pitch / POINTS},
        **{"tolerance": TOLERANCE, "initial": {"kind": "steady"}},
    }
    return case


def in_another_order(case: Block) -> Block:
    """Reverse the lists of wheels, meshes, shafts and loads."""
    other: Block = copy.deepcopy(case)
    for wheel in other["wheels"]:
        wheel.get("loads", []).reverse()
    for key in ("wheels", "meshes", "shafts"):
        other.get(key, []).reverse()
    return other
