"""Reference of orders: pitches of a mesh, or revolutions of a wheel."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
import xarray as xr

from evolvent.errors import USAGE, HistoryError
from evolvent.history import require, source_name

TURN = 2 * math.pi


@dataclass(frozen=True)
class Turning:
    """A mesh or a wheel as a counter of periods."""

    kind: str  # "mesh" or "wheel"
    name: str
    wheel: int  # whose angle is used: for a mesh the driving wheel
    sense: int  # nominal direction of rotation of that wheel, 1 counterclockwise
    per_turn: int  # periods per revolution of that wheel
    start: float  # position at angle 0 [periods]
    rate: Fraction  # periods per revolution of the first wheel of its train
    train: int  # wheels of one train are geared to each other

    @property
    def period(self) -> str:
        """Word for one period."""
        return "pitch" if self.kind == "mesh" else "turn"

    @property
    def periods(self) -> str:
        """Word for several."""
        return "pitches" if self.kind == "mesh" else "turns"

    def counted(self, count: float) -> str:
        """A number of periods, in words."""
        return f"{count:.6g} {self.period if count == 1 else self.periods}"

    def __str__(self) -> str:
        return f"{self.kind} {self.name}"

    def position(self, history: xr.Dataset) -> np.ndarray:
        """Periods at each row: pitches from pair 0's start of contact, turns since the start."""
        angle = require(history, "angle").isel(wheel=self.wheel).values
        return np.asarray(self.start + self.sense * angle * (self.per_turn / TURN))


def find_turning(history: xr.Dataset, name: str) -> Turning:
    """Mesh or wheel of a name; the mesh if both exist.

    Raises
    ------
    HistoryError
        Neither exists; the message lists the names.
    """
    meshes = [str(mesh) for mesh in history["mesh"].values]
    wheels = [str(wheel) for wheel in history["wheel"].values]
    if name in meshes:
        return _of_mesh(history, meshes.index(name))
    if name in wheels:
        return of_wheel(history, wheels.index(name))
    raise HistoryError(
        f"{source_name(history)}: has no mesh and no wheel `{name}`; there is the mesh "
        f"{', '.join(meshes)} and the wheel {', '.join(wheels)}",
        USAGE,
    )


def find_mesh(history: xr.Dataset, name: str) -> Turning:
    """Mesh of a name."""
    meshes = [str(mesh) for mesh in history["mesh"].values]
    if name not in meshes:
        raise HistoryError(
            f"{source_name(history)}: has no mesh `{name}`; there is {', '.join(meshes)}", USAGE
        )
    return _of_mesh(history, meshes.index(name))


def wheels_of(history: xr.Dataset, mesh: str) -> list[Turning]:
    """Driving and driven wheel of a mesh."""
    one = history.sel(mesh=mesh)
    return [of_wheel(history, int(require(one, f"{side}_wheel"))) for side in ("driving", "driven")]


def ratio(counted: Turning, by: Turning) -> Fraction:
    """Nominal number of periods of one in a period of the other.

    Raises
    ------
    HistoryError
        They are not geared to each other.
    """
    if counted.train != by.train:
        raise HistoryError(
            f"{counted} and {by} have no fixed speed ratio, so orders of one are not defined in a "
            f"record by angle of the other; run the case with output for {counted.name}",
            USAGE,
        )
    return counted.rate / by.rate


def nominal_speeds(history: xr.Dataset) -> tuple[list[int], list[Fraction]]:
    """Train of each wheel, and its nominal speed over that of its first wheel, by the teeth.

    The first wheel of a train drives its first mesh and turns in that mesh's nominal direction. A
    wheel without meshes and shafts is a train of its own.
    """
    teeth = require(history, "teeth").values.astype(int)
    joints = []  # wheel, wheel, speed of the second over that of the first
    for mesh in range(history.sizes["mesh"]):
        a, b = (int(require(history, f"{side}_wheel")[mesh]) for side in ("driving", "driven"))
        joints.append((a, b, -Fraction(int(teeth[a]), int(teeth[b]))))
    roots = [(a, driving_sense(history, m)) for m, (a, _, _) in enumerate(joints)]
    for shaft in range(history.sizes.get("shaft", 0)):
        first, second = (
            int(require(history, f"shaft_wheel_{end}")[shaft]) for end in ("first", "second")
        )
        joints.append((first, second, Fraction(1)))
    trains, speeds = [-1] * teeth.size, [Fraction(1)] * teeth.size
    for root, sense in [*roots, *((wheel, 1) for wheel in range(teeth.size))]:
        if trains[root] >= 0:
            continue
        trains[root], speeds[root] = max(trains) + 1, Fraction(sense)
        reached = [root]
        while reached:
            wheel = reached.pop()
            for a, b, i in joints:
                for one, other, factor in ((a, b, i), (b, a, 1 / i)):
                    if one == wheel and trains[other] < 0:
                        trains[other], speeds[other] = trains[wheel], speeds[wheel] * factor
                        reached.append(other)
    return trains, speeds


def driving_sense(history: xr.Dataset, mesh: int) -> int:
    """Nominal sense of rotation of a mesh's driving wheel, +1: counterclockwise."""
    wheel = int(require(history, "driving_wheel")[mesh])
    sigma = int(require(history, "flank")[mesh])
    return sigma if require(history, "base_radius").values[wheel] < 0 else -sigma


def of_wheel(history: xr.Dataset, wheel: int) -> Turning:
    """Revolutions of a wheel since the start, in its nominal direction."""
    trains, speeds = nominal_speeds(history)
    name = str(history["wheel"].values[wheel])
    sense = 1 if speeds[wheel] > 0 else -1
    return Turning("wheel", name, wheel, sense, 1, 0.0, abs(speeds[wheel]), trains[wheel])


def _of_mesh(history: xr.Dataset, mesh: int) -> Turning:
    """Pitches of a mesh from pair 0's start of contact."""
    if "start_position" not in history:
        raise HistoryError(
            f"{source_name(history)}: does not contain the start of its tooth pairs (no variable "
            "`start_position`), as written by an older evolvent; run the case again"
        )
    one = history.isel(mesh=mesh)
    wheel = int(require(one, "driving_wheel"))
    z = abs(int(require(history, "teeth")[wheel]))
    start = float(require(one, "start_position"))
    trains, speeds = nominal_speeds(history)
    name = str(history["mesh"].values[mesh])
    return Turning(
        "mesh",
        name,
        wheel,
        driving_sense(history, mesh),
        z,
        start,
        abs(speeds[wheel]) * z,
        trains[wheel],
    )
