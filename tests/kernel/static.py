"""Quasi-static analysis of a mesh in Python: results of `evl_gearbox_static` by name."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from kernel.gearbox import OUTPUTS_OF_STATIC, Gearbox, Output, output_table
from kernel.interface import fields
from kernel.kernel import Floats

POSITION, POSITION_PAIR, HARMONIC = 10, 11, 12
NO_FORCE, ON_FLANKS, EDGE_DRIVING, EDGE_DRIVEN = range(4)


class Plan(ctypes.Structure):
    """`evl_static_plan`."""

    _fields_ = fields("evl_static_plan")


@dataclass
class Curve:
    """Results of one torque: arrays (position), (position, pair) or (harmonic), and numbers."""

    plan: Plan
    position: Floats
    pair: Floats
    values: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["values"][name]
        except KeyError:
            raise AttributeError(name) from None

    def of_pair(self, slot: int, name: str) -> Floats:
        """Values of one pair slot."""
        return self.values[name][:, slot - self.plan.first_pair]


def table(gearbox: Gearbox) -> list[Output]:
    """Output rows of a static analysis."""
    return output_table(gearbox.library, OUTPUTS_OF_STATIC)


def static_plan(gearbox: Gearbox, mesh: int = 0, points: int = 200) -> Plan:
    """Size of the analysis; raises GearboxError if it is rejected."""
    plan = Plan()
    gearbox.call("evl_gearbox_static_plan", gearbox.handle, mesh, points, plan)
    return plan


def static_curve(
    gearbox: Gearbox, torque: float, mesh: int = 0, points: int = 200, speed: float = 0.0
) -> Curve:
    """Quasi-static curve under a torque of the driving wheel, which turns slowly at `speed`."""
    plan = static_plan(gearbox, mesh, points)
    values = np.full(plan.n_values, -1e300)
    gearbox.call("evl_gearbox_static", gearbox.handle, mesh, points, torque, speed, values)
    rows = table(gearbox)
    offsets, counts = np.empty(len(rows), np.int32), np.empty(len(rows), np.int32)
    gearbox.library.evl_gearbox_static_layout(plan, offsets, counts)
    found: dict[str, Any] = {}
    for row, offset, count in zip(rows, offsets, counts, strict=True):
        if count == 0:
            continue
        part = values[offset : offset + count]
        assert (part != -1e300).all(), row.name
        if row.dims == POSITION_PAIR:
            part = part.reshape(plan.n_positions, plan.n_pairs)
        found[row.name.decode()] = float(part[0]) if row.dims == 0 else part
    return Curve(
        plan,
        np.arange(plan.n_positions) / points,
        plan.first_pair + np.arange(plan.n_pairs),
        found,
    )


def pair_force_at_rest(
    gearbox: Gearbox, torque: float, first: int = 0, pitches: int = 1_000_000, mesh: int = 0
) -> float:
    """Largest quasi-static force of a tooth pair under a torque, in some pitches [N]."""
    force = ctypes.c_double()
    given = (gearbox.handle, mesh, first, pitches, torque)
    gearbox.call("evl_gearbox_static_largest", *given, ctypes.byref(force))
    return force.value
