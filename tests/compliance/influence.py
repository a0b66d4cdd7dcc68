"""Influence functions of a wheel from Python, by `influence_calls.f90`."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass

import numpy as np

from kernel.gears import GearGeometry
from kernel.kernel import OK, Floats, Kernel, Status, _at, _double, _error

OWN, OTHER, NEIGHBOURS = 17, 9, 3
ROUNDING = 0.38  # of the rack's tip, ISO 53, profile A


@dataclass
class Influence:
    """Samples: rho [modules], E c, and E c_j (on tooth 0, on tooth j)."""

    rho: Floats
    own: Floats
    samples: Floats

    def other(self, j: int) -> Floats:
        """E c_j at every other rho."""
        return self.samples[j + NEIGHBOURS].T

    def own_at(self, rho: Floats) -> Floats:
        """E c by its polynomial."""
        return _polynomial(self.rho, self.own, rho)

    def other_at(self, j: int, rho: float, there: float) -> float:
        """E c_j by its polynomial."""
        at = self.rho[::2]
        rows = [float(_polynomial(at, row, np.array([there]))[0]) for row in self.other(j)]
        return float(_polynomial(at, np.array(rows), np.array([rho]))[0])


def _polynomial(points: Floats, values: Floats, at: Floats) -> Floats:
    """Barycentric interpolation at Chebyshev-Lobatto points."""
    weights = (-1.0) ** np.arange(len(points))
    weights[[0, -1]] /= 2
    terms = weights / (at[:, None] - points)
    return (terms @ values) / terms.sum(axis=1)


def influence(
    kernel: Kernel,
    gear: GearGeometry,
    hub_radius: float,
    *,
    rounding: float = ROUNDING,
    order: int = 8,
    nu: float = 0.3,
    stress: bool = False,
) -> Influence:
    """Compute them; raise KernelError if they are refused."""
    rho, own = np.empty(OWN), np.empty(OWN)
    other = np.empty((2 * NEIGHBOURS + 1, OTHER, OTHER))
    status = Status()
    kernel.library.test_influence(
        ctypes.byref(gear),
        *(_double(rounding), _double(hub_radius / gear.normal_module)),
        *(order, _double(nu), int(stress)),
        *(_at(rho), _at(own), _at(other), ctypes.byref(status)),
    )
    if status.code != OK:
        raise _error(status)
    return Influence(rho, own, other)


def element_points(
    kernel: Kernel, gear: GearGeometry, hub_radius: float, order: int = 8
) -> Floats:
    """Points of all elements of half a sector (element, along eta, along xi, xy), in modules."""
    form = ctypes.byref(gear), _double(ROUNDING), _double(hub_radius / gear.normal_module), order
    n = kernel.library.test_sector_elements(*form)
    points = np.empty((n, order + 1, order + 1, 2))
    kernel.library.test_sector_points(*form, n, _at(points))
    return points
