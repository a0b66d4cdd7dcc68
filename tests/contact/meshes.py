"""Meshes with synthetic compliant wheels, of the size of steel gears."""

from __future__ import annotations

import numpy as np

from kernel.compliant import Mesh

E = 2.06e11  # steel [Pa]
E_STAR = E / (2 * (1 - 0.3**2))
FLANK, STRAIGHT_A, STRAIGHT_B, EDGE_A, EDGE_B = range(5)


def involute_mesh(
    teeth: tuple[int, int] = (50, 50),
    module: float = 3e-3,
    *,
    sigma: int = 1,
    width: float = 0.02,
    unequal: bool = False,
    couples: bool = True,
    is_drive: bool = True,
    rounding: float = 0.0,
    relief: float = 0.0,
    yields: bool = True,
) -> Mesh:
    """Standard racks without shift or backlash; E c 4 to 10 on the own tooth, 4 on the next."""
    mesh = Mesh()
    alpha = np.radians(20)
    mesh.sigma, mesh.width, mesh.e_star = sigma, width, E_STAR
    mesh.line = module * sum(teeth) / 2 * np.sin(alpha)
    mesh.base_pitch = np.pi * module * np.cos(alpha)
    mesh.reach = 0.4 * mesh.base_pitch
    mesh.scale = 0.03
    mesh.is_drive, mesh.couples = is_drive, couples
    if unequal:  # A of bronze: E* and K_A - K_B
        bronze = (1 - 0.34**2) / 1.05e11
        steel = (1 - 0.3**2) / E
        mesh.e_star, mesh.k_difference = 1 / (bronze + steel), 2 / np.pi * (bronze - steel)
    for w, z in enumerate(teeth):
        mesh.r_b[w] = module * z / 2 * np.cos(alpha)
        r_a = module * z / 2 + module
        r_t = rounding
        mesh.ends[w] = r_t + np.sqrt((r_a - r_t) ** 2 - mesh.r_b[w] ** 2)
        mesh.roundings[w] = r_t
        size = (1.0 - 0.2 * w) / E if yields else 0.0
        made_up = [3.1 * size, 0.9 * size, 1.7 * size, 3.9 * size, 0.08, 0.05, -0.04, 0.02]
        mesh.influence[w][:] = made_up
        if relief:
            # a parabola of 10 mm of roll, and different teeth
            mesh.flanks[w][:] = [relief, relief / 5e-3, relief / 1e-4, 0.1 * relief, 10 * relief]
    return mesh


def start_of_path(mesh: Mesh) -> float:
    """Return rho_A at the entry of a pair of perfect flanks without load."""
    return float(mesh.line - mesh.ends[1])
