"""Natural modes of a frictionless gear train, assembled by hand, to compare evolvent with.

Nothing here comes from the kernel. The state is (arcs, axles), arcs r_b phi of the wheels and
displacements of the axles along their directions, with absolute angles instead of deviations. The
contact is h = -sigma (r_bA phi_A + r_bB phi_B) - e (u_B - u_A) to first order, its stiffness is
Johnson's, dF/dh and dF/d(rho_A + rho_B) from (13) by the implicit function theorem; the line of
action turns with the axles. mpmath's eigenvalues of the matrix have 40 digits: with absolute angles
the slow modes of a stiff train are lost in double precision.

Source: Kosenko & Gusev, 8th Modelica Conference 2011, pp. 315-328, equation (13).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import mpmath as mp
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

Floats = NDArray[np.float64]


@dataclass
class Wheel:
    """A steel disc of its pitch radius on an axle with springs and dampers in given directions."""

    teeth: int
    pitch_radius: float  # [m]
    width: float  # [m]
    centre: tuple[float, float]  # [m]
    torque: float = 0.0  # [N m], counterclockwise
    viscous: float = 0.0  # [N m s]
    directions: Sequence[tuple[float, float]] = ()  # unit vectors
    stiffness: Sequence[float] = ()  # [N/m]
    damping: Sequence[float] = ()  # [N s/m]
    extra_mass: float = 0.0  # [kg]

    @property
    def mass(self) -> float:
        return 7800.0 * math.pi * self.pitch_radius**2 * self.width

    @property
    def inertia(self) -> float:
        return self.mass * self.pitch_radius**2 / 2


@dataclass
class Mesh:
    """Steel on steel, nu = 0.3; `sigma` is +1 if the driving wheel a nominally turns clockwise."""

    a: int
    b: int
    sigma: int
    pressure_angle: float  # [rad]
    damping: float = 0.0  # [N s/m]

    e_star: float = field(default=2e11 / (2 * (1 - 0.3**2)), init=False)


@dataclass
class Modes:
    """Eigenvalues with their shapes, of the size of those of `evolvent modes`, in any phase."""

    eigenvalues: NDArray[np.complex128]  # (n,) [1/s]
    arcs: NDArray[np.complex128]  # (wheel, n)
    displacements: NDArray[np.complex128]  # (wheel, axis, n)
    penetrations: NDArray[np.complex128]  # (mesh, n)


def paper_angle(teeth_a: int, teeth_b: int) -> float:
    """Pressure angle of the paper's rule."""
    return 1.05 * math.atan(2 * math.pi / (teeth_a + teeth_b))


def johnson(normal_force: float, rho: float, width: float, e_star: float) -> tuple[float, ...]:
    """h, dF/dh, dF/d(rho_A + rho_B) where rho_A + rho_B = rho + h."""
    load = normal_force / width
    modulus = math.pi * e_star

    def excess(h: float) -> float:
        return load / modulus * (math.log(4 * modulus * (rho + h) / load) - 1) - h

    h = brentq(excess, 0.0, rho, xtol=1e-30, rtol=1e-15)
    logarithm = math.log(4 * modulus * (rho + h) / load)
    d_h = modulus / (logarithm - 2)
    return h, width * d_h, -width * d_h * load / (modulus * (rho + h))


def steady_forces(wheels: Sequence[Wheel], meshes: Sequence[Mesh], base: Floats) -> Floats:
    """Normal forces (mesh,) at which no wheel accelerates, all in the ratio of their teeth."""
    n = len(wheels)
    sense = np.ones(n)
    for mesh in meshes:  # in the order of the train
        sense[mesh.b] = -sense[mesh.a]
    ratio = sense * wheels[0].teeth / np.array([w.teeth for w in wheels])
    balance = np.zeros((n, n))
    for column, mesh in enumerate(meshes):
        balance[[mesh.a, mesh.b], column] = mesh.sigma * base[[mesh.a, mesh.b]]
    balance[:, -1] = -ratio * np.array([w.viscous for w in wheels])
    return np.linalg.solve(balance, [-w.torque for w in wheels])[:-1]


def modes(wheels: Sequence[Wheel], meshes: Sequence[Mesh]) -> Modes:
    """Linearise a train of n wheels and n - 1 meshes at its steady state under load."""
    n = len(wheels)
    base = np.zeros(n)
    for mesh in meshes:
        for i in (mesh.a, mesh.b):
            base[i] = wheels[i].pitch_radius * math.cos(mesh.pressure_angle)
    axles = [(i, np.array(d)) for i, w in enumerate(wheels) for d in w.directions]
    spring = np.array([k for w in wheels for k in w.stiffness])
    damper = np.array([c for w in wheels for c in w.damping])
    forces = steady_forces(wheels, meshes, base)

    def lines(u: Floats) -> list[tuple[Floats, Floats, float, float]]:
        """t, e, rho and R of every mesh with the axles at u (wheel, axis)."""
        found = []
        for mesh in meshes:
            c = np.array(wheels[mesh.b].centre) - wheels[mesh.a].centre + u[mesh.b] - u[mesh.a]
            total = base[mesh.a] + base[mesh.b]
            distance = math.hypot(*c)
            alpha, x = math.acos(total / distance), c / distance
            y = np.array([-x[1], x[0]])
            t = math.cos(alpha) * x + mesh.sigma * math.sin(alpha) * y
            e = math.sin(alpha) * x - mesh.sigma * math.cos(alpha) * y
            found.append((t, e, distance * math.sin(alpha), total))
        return found

    u = np.zeros((n, 2))
    for _ in range(20):  # the line of action turns by 1e-8: converges at once
        pushed = np.zeros((n, 2))
        for mesh, force, (_t, e, _rho, _total) in zip(meshes, forces, lines(u), strict=True):
            pushed[mesh.a] -= force * e
            pushed[mesh.b] += force * e
        u = np.zeros((n, 2))
        for (i, direction), k in zip(axles, spring, strict=True):
            u[i] += direction * (pushed[i] @ direction) / k

    m = n + len(axles)
    inertia = np.array(
        [w.inertia / base[i] ** 2 for i, w in enumerate(wheels)]
        + [wheels[i].mass + wheels[i].extra_mass for i, _ in axles]
    )
    stiffness, damping = np.zeros((m, m)), np.zeros((m, m))
    stiffness[range(n, m), range(n, m)] = spring
    damping[range(n, m), range(n, m)] = damper
    damping[range(n), range(n)] = [w.viscous / base[i] ** 2 for i, w in enumerate(wheels)]
    depth_rows = np.zeros((len(meshes), m))
    for k, (mesh, force, (t, e, rho, total)) in enumerate(
        zip(meshes, forces, lines(u), strict=True)
    ):
        width = min(wheels[mesh.a].width, wheels[mesh.b].width)
        _, d_h, d_rho = johnson(force, rho, width, mesh.e_star)

        def apart(vector: Floats, mesh: Mesh = mesh) -> Floats:
            """Row of (u_B - u_A) . vector."""
            row = np.zeros(m)
            for j, (i, direction) in enumerate(axles):
                row[n + j] = direction @ vector * ((i == mesh.b) * 1.0 - (i == mesh.a) * 1.0)
            return row

        arcs = np.zeros(m)
        arcs[[mesh.a, mesh.b]] = mesh.sigma
        depth_rows[k] = -arcs - apart(e)  # h
        rho_row = apart(e) + total / rho * apart(t)  # |K_A K_B| = sqrt(d^2 - R^2)
        force_row = d_h * depth_rows[k] + d_rho * (rho_row + depth_rows[k])
        # F does the virtual work -F dh; turning by (u_B - u_A) . t/rho it also gets a part along t.
        stiffness += np.outer(depth_rows[k], force_row) - np.outer(apart(t), apart(t)) * force / rho
        damping += mesh.damping * np.outer(depth_rows[k], depth_rows[k])

    matrix = np.block(
        [
            [-damping / inertia[:, None], -stiffness / inertia[:, None]],
            [np.eye(m), np.zeros((m, m))],
        ]
    )
    with mp.workdps(40):
        exact_values, exact_vectors = mp.eig(mp.matrix(matrix.tolist()))
        eigenvalues = np.array([complex(mp.chop(v, 1e-25)) for v in exact_values])
        vectors = np.array([[complex(v) for v in row] for row in exact_vectors.tolist()])
    order = np.argsort(np.abs(eigenvalues))[1:]  # without the angle of the whole train
    order = order[eigenvalues[order].imag >= 0]
    positions = vectors[m:, order]
    displacements = np.zeros((n, 2, len(order)), complex)
    for j, (i, direction) in enumerate(axles):
        displacements[i] += np.outer(direction, positions[n + j])
    motions = np.concatenate([np.abs(positions[:n]), np.linalg.norm(displacements, axis=1)])
    scale = motions.max(axis=0)
    return Modes(
        eigenvalues[order],
        positions[:n] / scale,
        displacements / scale,
        depth_rows @ positions / scale,
    )
