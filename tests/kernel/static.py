"""The static analysis of a mesh from Python: what `evl_gearbox_static` tells, by name."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from kernel.gearbox import OUTPUTS_OF_STATIC, Gearbox, Output, output_table
from kernel.kernel import Floats, Status, _at, _double, _int

POSITION, POSITION_PAIR, HARMONIC = 10, 11, 12
NO_FORCE, ON_FLANKS, EDGE_DRIVING, EDGE_DRIVEN = range(4)


class Plan(ctypes.Structure):
    """`evl_static_plan`."""

    _fields_ = [
        *((name, _int) for name in ("n_pitches", "n_positions", "n_pairs", "first_pair")),
        ("n_values", _int),
        ("torque", _double),
    ]


@dataclass
class Curve:
    """One torque: arrays (position), (position, pair) or (harmonic), and numbers."""

    plan: Plan
    position: Floats
    pair: Floats
    values: dict[str, Any]

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["values"][name]
        except KeyError:
            raise AttributeError(name) from None

    def of_pair(self, place: int, name: str) -> Floats:
        """One place for tooth pairs."""
        return self.values[name][:, place - self.plan.first_pair]


def table(gearbox: Gearbox) -> list[Output]:
    """Rows that a static analysis tells."""
    return output_table(gearbox.library, OUTPUTS_OF_STATIC)


def static_plan(gearbox: Gearbox, mesh: int = 0, points: int = 200) -> Plan:
    """What the analysis comes to; raises GearboxError if it is refused."""
    plan, status = Plan(), Status()
    code = gearbox.library.evl_gearbox_static_plan(
        gearbox.handle, mesh, points, ctypes.byref(plan), ctypes.byref(status)
    )
    gearbox.check(code, status)
    return plan


def static_curve(
    gearbox: Gearbox, torque: float, mesh: int = 0, points: int = 200, speed: float = 0.0
) -> Curve:
    """The mesh at rest under a torque of the driving wheel, which creeps at a speed."""
    plan, status = static_plan(gearbox, mesh, points), Status()
    values = np.full(plan.n_values, -1e300)
    code = gearbox.library.evl_gearbox_static(
        gearbox.handle,
        mesh,
        points,
        _double(torque),
        _double(speed),
        _at(values),
        ctypes.byref(status),
    )
    gearbox.check(code, status)
    rows = table(gearbox)
    offsets, counts = np.empty(len(rows), np.int32), np.empty(len(rows), np.int32)
    gearbox.library.evl_gearbox_static_places(ctypes.byref(plan), _at(offsets), _at(counts))
    found: dict[str, Any] = {}
    for row, offset, count in zip(rows, offsets, counts, strict=True):
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
    """The largest force of a tooth pair of a mesh at rest under a torque, in some pitches [N]."""
    force, status = _double(), Status()
    code = gearbox.library.evl_gearbox_static_pair_force(
        gearbox.handle,
        mesh,
        first,
        pitches,
        _double(torque),
        ctypes.byref(force),
        ctypes.byref(status),
    )
    gearbox.check(code, status)
    return force.value
