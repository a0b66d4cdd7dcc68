"""Bindings of the compliant tooth contact of the kernel, for its tests."""

from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from kernel.interface import fields
from kernel.kernel import Floats, Integers, Kernel, _floats

LANES = 8


class Contact(NamedTuple):
    """Forces per unit width with their derivatives to h, c and Lambda, and energies."""

    force: Floats
    d_h: Floats
    d_c: Floats
    d_length: Floats
    energy: Floats
    code: Integers


def compliant_force(
    kernel: Kernel, h: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: ArrayLike
) -> Contact:
    """Johnson's contact in series with the compliance of the bodies."""
    given = _floats(h, length, c, e_star)
    shapes = ((), (), (), (), ())
    return Contact(*kernel.found("test_compliant_force", given, len(given[0]), *shapes))


def compliant_lanes(
    kernel: Kernel, h: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: float
) -> tuple[Floats, bool]:
    """Forces in eight lanes, and whether the solution converged."""
    *given, force = _floats(h, length, c, np.zeros(LANES))
    answer = kernel.library.test_compliant_lanes(*given, e_star, force)
    return force, bool(answer)


def compliant_penetration(
    kernel: Kernel, force: ArrayLike, length: ArrayLike, c: ArrayLike, e_star: ArrayLike
) -> tuple[Floats, Floats, Integers]:
    """Penetration under a force, its derivative to the force, and the codes."""
    given = _floats(force, length, c, e_star)
    h, d_force, codes = kernel.found("test_compliant_penetration", given, len(given[0]), (), ())
    return h, d_force, codes


class Pairs(NamedTuple):
    """Forces of coupled pairs, overlaps g, energy, derivatives of the forces, iterations."""

    code: int
    force: Floats
    g: Floats
    energy: float
    change: Floats
    turns: int


def coupled_pairs(
    kernel: Kernel,
    h: ArrayLike,
    length: float,
    c: ArrayLike,
    e_star: float,
    *,
    pushes_only: bool = True,
    ways: ArrayLike = (),
    d_length: ArrayLike = (),
) -> Pairs:
    """Forces per unit width; `ways` (way, pair) are dh - dC N, `d_length` dLambda along each."""
    (h,) = _floats(h)
    n = len(h)
    c = np.ascontiguousarray(c, dtype=float)
    ways = np.ascontiguousarray(ways, dtype=float).reshape(-1, n)
    (d_length,) = _floats(np.zeros(len(ways)) if np.size(d_length) == 0 else d_length)
    force, g, change = np.full(n, np.nan), np.full(n, np.nan), np.full_like(ways, np.nan)
    energy, turns = ctypes.c_double(), ctypes.c_int()
    given = (h, length, c, e_star, pushes_only, len(ways), ways, d_length)
    results = (force, g, ctypes.byref(energy), change, ctypes.byref(turns))
    code = kernel.library.test_coupled_pairs(n, *given, *results)
    return Pairs(code, force, g, energy.value, change, turns.value)


class EdgeGeometry(NamedTuple):
    """Gap S of a tip edge with its derivatives to x and rho; foot r_A delta with its own."""

    gap: Floats
    d_x: Floats
    d_rho: Floats
    d_xx: Floats
    d_x_rho: Floats
    d_rho_rho: Floats
    foot: Floats
    foot_x: Floats
    foot_rho: Floats
    foot_xx: Floats
    foot_x_rho: Floats
    foot_rho_rho: Floats
    arm: Floats
    turn: Floats
    exists: Floats


class Edge(NamedTuple):
    """Tip edge: base radii of its wheel and of the mate, end of its flank, rounding."""

    r_b: float
    r_mate: float
    rho_end: float
    rounding: float = 0.0


def edge_geometry(kernel: Kernel, edge: Edge, x: ArrayLike, rho: ArrayLike) -> EdgeGeometry:
    """Contact position of an edge."""
    x, rho = _floats(x, rho)
    values = np.empty((len(x), len(EdgeGeometry._fields)))
    (numbers,) = _floats(edge)
    kernel.library.test_edge_place(len(x), numbers, x, rho, values)
    return EdgeGeometry(*values.T)


def edge_end(kernel: Kernel, edge: Edge, slope: float, rho: float) -> float:
    """End of a relieved flank, from which the edge is in contact."""
    (numbers,) = _floats(edge)
    return float(kernel.library.test_edge_end(numbers, slope, rho))


class Mesh(ctypes.Structure):
    """One flank with synthetic compliant wheels."""

    _fields_ = fields("given_mesh", n_numbers=8)


class Potential(NamedTuple):
    """Pairs of a flank: energy and its derivatives to rho_A, rho_B, rho, and the loads."""

    code: int
    zones: Integers
    h: Floats
    force: Floats  # per unit width
    energy: float
    gradient: Floats
    second: Floats
    change: Floats  # derivatives of the forces (pair, of the three)
    wheels: Floats  # torque on A, on B, force on A along t, e


def elastic_potential(
    kernel: Kernel,
    mesh: Mesh,
    rho_a0: float,
    numbers: ArrayLike,
    q: ArrayLike = (0.0,) * 6,
    zones: ArrayLike | None = None,
) -> Potential:
    """Loads at psi_A, psi_B, u_A, u_B; pairs in the zones of their positions unless given."""
    numbers = np.ascontiguousarray(numbers, np.int32)
    n = len(numbers)
    zones = np.full(n, -1, np.int32) if zones is None else np.array(zones, np.int32)
    (q,) = _floats(q)
    h, force, energy, gradient = np.empty(n), np.empty(n), np.empty(1), np.empty(3)
    second, change, wheels = np.empty((3, 3)), np.empty((3, n)), np.empty(4)
    results = (h, force, energy, gradient, second, change, wheels)
    code = kernel.library.test_flank_potential(mesh, rho_a0, q, n, numbers, zones, *results)
    return Potential(code, zones, h, force, energy[0], gradient, second, change.T, wheels)


class Static(NamedTuple):
    """Quasi-static state of a mesh."""

    h: float
    h_0: float
    stiffness: float
    energy: float
    gradient: Floats
    numbers: Integers
    zones: Integers
    force: Floats  # per unit width
    rho: Floats  # (pair, wheel)
    feet: Floats
    code: int
    message: str


def static_mesh(kernel: Kernel, mesh: Mesh, rho_a: float, force: float) -> Static:
    """Solve for the quasi-static transmission error at rho_A of pair 0 under a force."""
    numbers, pairs = np.full(7, np.nan), np.full((6, 7), np.nan)
    n, code = ctypes.c_int(), ctypes.c_int()
    message = ctypes.create_string_buffer(320)
    results = (numbers, ctypes.byref(n), pairs, ctypes.byref(code), message)
    kernel.library.test_static_mesh(mesh, rho_a, force, *results)
    pairs = pairs[: n.value]
    return Static(
        *numbers[:4],
        numbers[4:],
        pairs[:, 0].astype(np.int32),
        pairs[:, 1].astype(np.int32),
        pairs[:, 2],
        pairs[:, 3:5],
        pairs[:, 5:],
        code.value,
        message.value.decode(),
    )


class Curve(NamedTuple):
    """Quasi-static states at many positions; forces per unit width, zones of pairs -1, 0, 1."""

    h: Floats
    stiffness: Floats
    force: Floats
    zone: Integers


def true_mesh(
    kernel: Kernel,
    mesh: Mesh,
    samples: tuple[Floats, Floats, Floats],
    youngs: float,
    rho_a: ArrayLike,
    force: float,
) -> Curve:
    """Evaluate with rho [modules], E c and E c_j of both wheels from the finite elements."""
    (rho_a,) = _floats(rho_a)
    n = len(rho_a)
    numbers, forces, zones = np.empty((n, 5)), np.empty((n, 3)), np.empty((n, 3), np.int32)
    given = (*map(np.ascontiguousarray, samples), 3e-3, youngs, n, rho_a, force)
    kernel.library.test_true_mesh(mesh, *given, numbers, forces, zones)
    assert not numbers[:, 4].any()
    return Curve(numbers[:, 0], numbers[:, 2], forces, zones)
