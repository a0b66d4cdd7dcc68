"""Root stress of a wheel from Python, by `stress_calls.f90`. Sigma: module x stress / line load."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from compliance.influence import ROUNDING
from kernel.gears import GearGeometry
from kernel.kernel import OK, Floats, Kernel, Status, _at, _double, _error

ARCS = 13
RIGHT, LEFT = 1, 2  # flanks


@dataclass
class FilletStress:
    """Sigma of tooth 0, (tooth of the load from -last, load, arc)."""

    right: Floats
    left: Floats
    last: int

    def of(self, side: str, j: int) -> Floats:
        """Under loads on tooth j (load, arc)."""
        return getattr(self, side)[j + self.last]


@dataclass
class SummedStress:
    """Sums of loads, per set of loads: stress at arcs, extremes, and stress at one arc."""

    arcs: Floats
    values: Floats  # (set, fillet, arc)
    extremes: Floats  # (set, fillet, largest, least and the arcs of both)
    at_arc: Floats  # (set, fillet)


@dataclass
class Gear:
    """A gear with its hub and elements; lengths in modules."""

    kernel: Kernel
    geometry: GearGeometry
    hub: float
    order: int = 8
    nu: float = 0.3
    stress: bool = False
    rounding: float = ROUNDING

    def fillet(self, arcs: Floats) -> tuple[float, Floats]:
        """Arc of a whole fillet, and points at arcs of it."""
        arcs, points = np.ascontiguousarray(arcs, float), np.empty((len(arcs), 2))
        length = self.kernel.library.test_fillet(
            ctypes.byref(self.geometry), _double(self.rounding), len(arcs), _at(arcs), _at(points)
        )
        return float(length), points

    def flank(self) -> tuple[float, float]:
        """Radii of curvature between which the elements support loads."""
        ends = np.empty(1), np.empty(1)
        self.kernel.library.test_flank_range(*self.form(), _at(ends[0]), _at(ends[1]))
        return float(ends[0][0]), float(ends[1][0])

    def elements(self, arcs: Floats, rho: Floats, last: int = 0) -> FilletStress:
        """Sigma at arcs of both fillets, under loads at rho, directly by the elements."""
        arcs, rho = (np.ascontiguousarray(row, float) for row in (arcs, rho))
        right, left = np.empty((2, 2 * last + 1, len(rho), len(arcs)))
        status = Status()
        self.kernel.library.test_stress_of_elements(
            *(*self.form(), _double(self.nu), int(self.stress)),
            *(len(arcs), _at(arcs), len(rho), _at(rho), last),
            *(_at(right), _at(left), ctypes.byref(status)),
        )
        if status.code != OK:
            raise _error(status)
        return FilletStress(right, left, last)

    def polynomials(
        self,
        rho: ArrayLike,
        tooth: ArrayLike = 0,
        flank: ArrayLike = RIGHT,
        force: ArrayLike = 1.0,
        arc: float = 0.0,
    ) -> SummedStress:
        """Stress by the polynomials, in metres, for sets of loads (set, load)."""
        rho, force = np.broadcast_arrays(np.atleast_2d(rho), np.asarray(force, float))
        rho, force = (np.array(row, float) for row in (rho, force))
        tooth, flank = (
            np.array(np.broadcast_to(row, rho.shape), np.int32) for row in (tooth, flank)
        )
        n = len(rho)
        found = SummedStress(
            np.empty(ARCS), np.empty((n, 2, ARCS)), np.empty((n, 2, 4)), np.empty((n, 2))
        )
        status = Status()
        self.kernel.library.test_root_stress(
            *(*self.form(), _double(self.nu), int(self.stress), rho.shape[1], n),
            *(_at(row) for row in (flank, rho, tooth, force)),
            *(_double(arc), _at(found.arcs), _at(found.values), _at(found.extremes)),
            *(_at(found.at_arc), ctypes.byref(status)),
        )
        if status.code != OK:
            raise _error(status)
        return found

    def nominal(self, rho: float) -> tuple[Floats, bool]:
        """Y_F, Y_S, q_s and Y_F Y_S cos(alpha) under a load at rho [modules]; whether valid."""
        factors = np.empty(4)
        form = ctypes.byref(self.geometry), _double(self.rounding), _double(rho)
        return factors, bool(self.kernel.library.test_nominal_root(*form, _at(factors)))

    def form(self) -> tuple[object, ...]:
        """Arguments of the calls."""
        return (
            *(ctypes.byref(self.geometry), _double(self.rounding)),
            *(_double(self.hub), self.order),
        )
