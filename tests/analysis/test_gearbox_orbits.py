"""Gearboxes as dynamical systems: derivative of their flow, with events and discrete state."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest

from kernel.description import Block
from kernel.gearbox import Gearbox, State
from kernel.gearbox_description import (
    BEARING,
    SPEED,
    STEADY,
    TORQUE,
    VISCOUS,
    load,
    mesh,
    shaft,
    wheel,
)
from kernel.kernel import OK, Floats, Kernel, _at
from kernel.real_pairs import RealPair

SECTION = 0.5  # of the section, pitches after t = 0


class Flow(NamedTuple):
    """End of a flow, its derivative, units of the states (0: need not repeat)."""

    end: Floats
    derivative: Floats
    units: Floats
    same_modes: bool
    ties: int
    crossings: int


def flow(gearbox: Gearbox, state: State, change: Floats, periods: int, duration: float) -> Flow:
    """Integrate a gearbox from a state, changed by some units."""
    n = size(gearbox)
    end, derivative, units = np.empty(n), np.empty(n * n), np.empty(n)
    numbers = np.empty(3, np.int32)
    code = gearbox.library.test_orbit_flow(
        gearbox.handle,
        _at(gearbox.scales()[0]),
        ctypes.c_double(SECTION),
        _at(state.y),
        int(state.integers[0]),
        _at(state.reals),
        _at(np.ascontiguousarray(change)),
        periods,
        ctypes.c_double(duration),
        *map(_at, (end, derivative, units, numbers)),
    )
    assert code == OK
    same, ties, crossings = numbers.tolist()
    return Flow(end, derivative.reshape(n, n).T, units, bool(same), ties, crossings)


def size(gearbox: Gearbox) -> int:
    return int(gearbox.library.test_orbit_size(gearbox.handle, _at(gearbox.scales()[0])))


def pair(kernel: Kernel, torque: float, speed: float = -300.0, **fields: object) -> Gearbox:
    """A pair of gears defined by a basic rack at a prescribed speed under a torque."""
    return RealPair(fixed=True).gearbox(
        kernel, (load(0, SPEED, speed), load(1, TORQUE, torque)), **fields
    )


def yielding(kernel: Kernel) -> Gearbox:
    """A pair on bearings."""
    return RealPair().gearbox(
        kernel, (load(0, SPEED, -300.0), load(1, TORQUE, -20.0)), damping=2e3, friction=(0.1, 1e-2)
    )


def free(kernel: Kernel) -> Gearbox:
    """A pair driven by torques: its period is unknown."""
    return RealPair(fixed=True).gearbox(
        kernel, (load(0, TORQUE, -20.0), load(1, VISCOUS, 0.2)), damping=2e3
    )


def train(kernel: Kernel) -> Gearbox:
    """Three wheels in a row, the last one on an elastic shaft with a disc."""
    wheels = [
        wheel(teeth=20, pitch_radius=0.03, centre=(0.0, 0.0), width=0.02),
        wheel(teeth=20, width=0.02),
        wheel(teeth=20, width=0.02, support_kind=BEARING, support_mass=2.0,
              support_stiffness=(1e8, 2e8), support_damping=(2e3, 2e3)),
        wheel(teeth=0, pitch_radius=0.05, width=0.02),
    ]  # fmt: skip
    meshes = [
        mesh(kernel, 0, 1, damping=2e3),
        mesh(kernel, 1, 2, driving_rotation=1, centre_line_angle=0.3, damping=2e3),
    ]
    loads = [load(0, SPEED, -200.0), load(3, TORQUE, 30.0)]
    return Gearbox(kernel, wheels, loads, meshes, shafts=[shaft(2, 3, 2e4, 0.5)])


CASES: dict[str, Callable[[Kernel], Gearbox]] = {
    "linear damping": lambda kernel: pair(kernel, -20.0, damping=2e3),
    "flanks that part": lambda kernel: pair(kernel, -1.0, damping=2e2),
    "friction": lambda kernel: pair(kernel, -20.0, damping=2e3, friction=(0.1, 1e-2)),
    "one-sided damping": lambda kernel: pair(kernel, -1.0, damping=("one_sided", 2e2)),
    "damping that remembers": lambda kernel: pair(
        kernel, -1.0, damping=Block(law="flores", restitution=0.8, v0_min=1e-4)
    ),
    "bearings": yielding,
    "train": train,
    "torques": free,
}


@pytest.mark.parametrize("name", CASES)
def test_derivative_of_the_flow_is_that_of_differences(kernel: Kernel, name: str) -> None:
    """Fourth-order differences over 2e-5 of the units, without a change of the events."""
    gearbox = CASES[name](kernel)
    state = gearbox.start(STEADY, mesh_position=SECTION)
    n = size(gearbox)
    start = np.zeros(n)
    start[2:4] = 0.3  # off the steady state: vibration
    duration = 0.0 if name != "torques" else 0.004
    whole = flow(gearbox, state, start, 2, duration)
    repeats = whole.units > 0
    unit = np.where(repeats, whole.units, 1)
    exact = whole.derivative * unit / unit[:, None]
    step = 2e-5
    for j in np.flatnonzero(repeats):
        ends = []
        for k in (-2, -1, 1, 2):
            change = start.copy()
            change[j] += k * step
            one = flow(gearbox, state, change, 2, duration)
            assert one.crossings == whole.crossings
            ends.append(one.end / unit)
        difference = (8 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12 * step)
        error = np.abs(difference - exact[:, j])[repeats].max()
        assert error <= 1e-6 * max(1.0, np.abs(exact[repeats][:, repeats]).max()), j


def _ends(gearbox: Gearbox, state: State) -> Callable[[float], tuple[int, Floats]]:
    """Crossings in a period, and its end in units of the states, by the initial vibration."""

    def follow(vibration: float) -> tuple[int, Floats]:
        change = np.zeros(size(gearbox))
        change[2:4] = vibration
        one = flow(gearbox, state, change, 1, 0.0)
        repeats = one.units > 0
        return one.crossings, one.end[repeats] / one.units[repeats]

    return follow


PARTING: dict[str, dict[str, Any]] = {  # at damping ratios of about 0.02, 0.1 and 0.2
    "little damping": {"damping": 2e2},
    "one-sided damping": {"damping": ("one_sided", 2e2)},
    "damping": {"damping": 1e3, "contact": Block(law="linear", stiffness=4e8)},
    "much damping": {"damping": 3e3, "contact": Block(law="linear", stiffness=4e8)},
    "much damping of cylinders": {"damping": 3e3},
}


@pytest.mark.parametrize("fields", PARTING.values(), ids=PARTING)
def test_where_an_event_comes_or_goes_the_flow_is_continuous(
    kernel: Kernel, fields: dict[str, Any]
) -> None:
    """Vanishing force or opening gap: continuity at any distance from the change of events.

    The distances are within a thousand times that from the change of the number of events.
    """
    gearbox = pair(kernel, -1.0, **fields)
    follow = _ends(gearbox, gearbox.start(STEADY, mesh_position=SECTION))
    sections = np.linspace(0.5, 2.5, 101)
    counts = [follow(section)[0] for section in sections]
    changes = [
        pair for i, pair in enumerate(pairwise(sections.tolist())) if counts[i] != counts[i + 1]
    ]
    assert len(changes) >= 6
    for low, high in changes:
        ends = {section: follow(section) for section in (low, high)}
        while high - low > 1e-13:
            middle = (low + high) / 2
            ends[middle] = follow(middle)
            low, high = (middle, high) if ends[middle][0] == ends[low][0] else (low, middle)
        for section, (_, end) in ends.items():
            far = float(np.max(np.abs(end - ends[low][1])))
            assert far <= 1e-7 + 1000 * abs(section - low), (section, low)
