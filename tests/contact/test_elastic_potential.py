"""Forces of a flank are the gradient of its energy, for all contact positions and zones."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from contact.meshes import (
    EDGE_A,
    EDGE_B,
    FLANK,
    STRAIGHT_A,
    STRAIGHT_B,
    involute_mesh,
    start_of_path,
)
from kernel.compliant import Mesh, compliant_force, elastic_potential
from kernel.kernel import OK, Floats, Kernel

# distance of pair 0 from the start of its path, or of the pair before it from the end, and the
# zones of both contacts
POSITIONS = {
    "path": ("start", 4e-3, (FLANK, FLANK)),
    "edge of B": ("start", -0.4e-3, (FLANK, EDGE_B)),
    "edge of A": ("end", 0.4e-3, (EDGE_A, FLANK)),
}
every_position = pytest.mark.parametrize("position", POSITIONS.values(), ids=POSITIONS)
Position = tuple[str, float, tuple[int, ...]]
MESHES = {
    "50/50": {},
    "19/34 clockwise": {"teeth": (19, 34), "sigma": -1},
    "uncoupled": {"couples": False},
    "unequal": {"teeth": (30, 70), "unequal": True},
    "coast": {"is_drive": False, "sigma": -1},
    "rounded": {"rounding": 0.3e-3},
    "relieved": {"relief": 3e-6},
    "relieved, unequal, rounded": {"relief": 4e-6, "unequal": True, "rounding": 0.2e-3},
}
every_mesh = pytest.mark.parametrize("options", MESHES.values(), ids=MESHES)
NUMBERS = (-2, -1, 0)
H = 1.5e-5

# central differences of order 8 at +-1 .. +-4
WEIGHTS = np.array([4 / 5, -1 / 5, 4 / 105, -1 / 280])


def contact_at(mesh: Mesh, position: Position) -> float:
    """rho_A of pair 0."""
    border, past, _ = position
    if border == "start":
        return start_of_path(mesh) + past
    return float(mesh.ends[0] - mesh.base_pitch + past)


def loaded(mesh: Mesh) -> Floats:
    """Angles of the wheels and positions of the axes for an overlap H of the flanks, none at 0."""
    u = 2e-5 * np.array([0.3, -0.2, -0.4, 0.5])
    q = np.array([0.0, 0.0, *u])
    opened = u[3] - u[1]  # along e, to first order
    q[0] = -mesh.sigma * (H + opened) * 0.7 / mesh.r_b[0]
    q[1] = -mesh.sigma * (H + opened) * 0.3 / mesh.r_b[1]
    return q


def differences(function, q: Floats, steps: Floats) -> Floats:
    """Derivatives along each component of q, the last axis."""
    slopes = []
    for i, step in enumerate(steps):
        slope = 0.0
        for k, weight in enumerate(WEIGHTS, start=1):
            by = np.zeros(len(q))
            by[i] = k * step
            slope = slope + weight * (function(q + by) - function(q - by)) / step
        slopes.append(slope)
    return np.stack(slopes, axis=-1)


@every_mesh
@every_position
def test_forces_are_the_gradient_of_the_energy(kernel: Kernel, options: dict, position: Position):
    """Along all of psi_A, psi_B, u_A, u_B, without exception."""
    mesh = involute_mesh(**options)
    rho_a0, q = contact_at(mesh, position), loaded(mesh)
    there = elastic_potential(kernel, mesh, rho_a0, NUMBERS, q)
    assert there.code == OK
    carries = there.force > 0
    assert carries.sum() >= 2

    def energy(moved: Floats) -> float:
        return elastic_potential(kernel, mesh, rho_a0, NUMBERS, moved, there.zones).energy

    step = 3e-8  # of the penetration H; smaller near the separation of an edge
    steps = step / np.array([mesh.r_b[0], mesh.r_b[1], 1, 1, 1, 1])
    work = -differences(energy, q, steps) * [1 / mesh.r_b[0], 1 / mesh.r_b[1], 1, 1, 1, 1]
    torque_a, torque_b, t, e = there.wheels
    acts = np.array([torque_a / mesh.r_b[0], torque_b / mesh.r_b[1], t, e, -t, -e])
    np.testing.assert_allclose(acts, work, atol=1e-8 * np.abs(acts).max())


@every_mesh
@every_position
def test_second_derivatives_are_those_of_the_gradient(
    kernel: Kernel, options: dict, position: Position
):
    """Along rho_A, rho_B and rho, with changes of the forces of all pairs."""
    mesh = involute_mesh(**options)
    rho_a0, q = contact_at(mesh, position), loaded(mesh)
    there = elastic_potential(kernel, mesh, rho_a0, NUMBERS, q)

    def at_lengths(lengths: Floats):
        """B's angle sets rho_B; the line is moved along itself."""
        a, b, line = lengths
        moved = Mesh.from_buffer_copy(mesh)
        moved.line = mesh.line + line
        # rho_B = line - rho_A0 - ... : subtract the change of the line, and A's share of rho_A0
        by = q.copy()
        by[0] -= mesh.sigma * a / mesh.r_b[0]
        by[1] -= mesh.sigma * (b - line) / mesh.r_b[1]
        by[2:] = 0
        return elastic_potential(kernel, moved, rho_a0, NUMBERS, by, zones_there)

    flat = q.copy()
    flat[2:] = 0
    zones_there = elastic_potential(kernel, mesh, rho_a0, NUMBERS, flat).zones
    # x_* is constant when the line of action moves: this test's motion excludes relieved tips
    if options.get("relief"):
        mesh.flanks[0][1] = mesh.flanks[1][1] = 0.0
        zones_there = elastic_potential(kernel, mesh, rho_a0, NUMBERS, flat).zones
    centre = at_lengths(np.zeros(3))
    second = differences(lambda x: at_lengths(x).gradient, np.zeros(3), np.full(3, 3e-8))
    assert there.code == OK
    np.testing.assert_allclose(centre.second, second, atol=1e-8 * np.abs(second).max())
    np.testing.assert_allclose(centre.second, centre.second.T, atol=1e-12 * np.abs(second).max())
    change = differences(lambda x: at_lengths(x).force, np.zeros(3), np.full(3, 3e-8))
    np.testing.assert_allclose(centre.change, change, atol=1e-8 * np.abs(change).max())


@every_mesh
@every_position
def test_places_are_those_that_the_tests_name(kernel: Kernel, options: dict, position: Position):
    mesh = involute_mesh(**options)
    there = elastic_potential(kernel, mesh, contact_at(mesh, position), NUMBERS, loaded(mesh))
    assert tuple(there.zones[there.force > 0]) == position[2]


@pytest.mark.parametrize("wheel", [0, 1])
def test_relieved_flank_goes_on_straight_to_its_edge(kernel: Kernel, wheel: int):
    """Forces and energy are continuous at the flank's end and at the transition to its edge."""
    mesh = involute_mesh(relief=3e-6)
    mesh.flanks[0][3:] = mesh.flanks[1][3:] = [0.0, 0.0]
    borders = (FLANK, (STRAIGHT_A, STRAIGHT_B)[wheel], (EDGE_A, EDGE_B)[wheel])
    angle = -mesh.sigma * 2.5e-5 / mesh.r_b[0]
    q = (angle, 0.0, 0, 0, 0, 0)

    def zone(rho_a0: float) -> int:
        return int(elastic_potential(kernel, mesh, rho_a0, (0,), q).zones[0])

    inside = start_of_path(mesh) + 0.9 * mesh.base_pitch
    outside = inside + (2.0 if wheel == 0 else -2.0) * mesh.base_pitch
    numbers = (-1, 0, 1)
    seen = []
    for before, after in pairwise(borders):
        # from the zone `before` at the last position, `after` at the next
        low, high = inside, outside
        for _ in range(200):
            middle = (low + high) / 2
            if middle in (low, high):
                break
            if borders.index(zone(middle)) <= borders.index(before):
                low = middle
            else:
                high = middle
        assert (zone(low), zone(high)) == (before, after)
        ends = [elastic_potential(kernel, mesh, rho_a0, numbers, q) for rho_a0 in (low, high)]
        assert ends[0].energy == pytest.approx(ends[1].energy, rel=1e-12)
        np.testing.assert_allclose(ends[0].force, ends[1].force, rtol=1e-11)
        # the load stops on the edge, and its foot point reverses: 1e-4 of the torques
        np.testing.assert_allclose(ends[0].gradient, ends[1].gradient, rtol=1e-3)
        seen.append((low - inside) / mesh.base_pitch)
    assert abs(seen[0]) < abs(seen[1])


def test_flanks_without_compliance_are_johnsons(kernel: Kernel):
    """Two equal pairs, each with Johnson's force over the length of the line of action."""
    mesh = involute_mesh(yields=False)
    q = (-mesh.sigma * H / mesh.r_b[0], 0, 0, 0, 0, 0)
    there = elastic_potential(kernel, mesh, contact_at(mesh, POSITIONS["path"]), (-1, 0), q)
    alone = compliant_force(kernel, H, mesh.line, 0.0, mesh.e_star)
    np.testing.assert_allclose(there.force, alone.force[0], rtol=1e-10)  # H against the radii
    total = 2 * mesh.width * alone.force[0]
    np.testing.assert_allclose(there.gradient[:2], total, rtol=1e-10)
    assert there.wheels[0] == pytest.approx(mesh.sigma * mesh.r_b[0] * total, rel=1e-10)


def test_load_that_moves_over_a_tooth_does_work_on_it(kernel: Kernel):
    """Torques are those of arms r_b (1 - N c'/2), as for the slope of a deviation."""
    mesh = involute_mesh(couples=False)
    q = (-mesh.sigma * H / mesh.r_b[0], 0, 0, 0, 0, 0)
    rho_a0 = contact_at(mesh, POSITIONS["path"])
    there = elastic_potential(kernel, mesh, rho_a0, (0,), q)
    _, p2, p3 = mesh.influence[0][:3]
    slope = (p2 + p3 * np.exp((rho_a0 + H) / mesh.scale)) / mesh.scale
    n = there.force[0]
    arm = mesh.r_b[0] * (1 - n * slope / 2)
    assert there.wheels[0] == pytest.approx(mesh.sigma * mesh.width * n * arm, rel=1e-12)
    assert 1e-5 < n * slope / 2 < 1e-3


@pytest.mark.parametrize("is_drive", [True, False])
def test_neighbours_are_counted_towards_the_side_that_flanks_face(kernel: Kernel, is_drive: bool):
    """C_kl = c_A,k-l(rho_A,k, rho_A,l) + c_B,l-k(rho_B,k, rho_B,l); coast: exchanged."""
    mesh = involute_mesh(is_drive=is_drive)
    q = (-mesh.sigma * H / mesh.r_b[0], 0, 0, 0, 0, 0)
    rho_a0 = contact_at(mesh, POSITIONS["path"])
    there = elastic_potential(kernel, mesh, rho_a0, (-1, 0), q)
    rho_a = rho_a0 + H + np.array([1, 0]) * mesh.base_pitch  # of pairs -1 and 0
    rho_b = mesh.line + H - rho_a

    def c_own(w: int, rho: float) -> float:
        p, u = mesh.influence[w], rho / mesh.scale
        return p[0] + p[1] * u + p[2] * np.exp(u)

    def c_1(w: int, rho: float, rho_load: float) -> float:
        p, u, v = mesh.influence[w], rho / mesh.scale, rho_load / mesh.scale
        return p[3] * np.exp(-p[4]) * (1 + p[5] * u + p[6] * (v + u**2) + p[7] * u * v)

    # k = 0, l = -1: k - l = 1 on A
    a, b = ((1, 0), (0, 1)) if is_drive else ((0, 1), (1, 0))
    coupling = c_1(0, rho_a[a[0]], rho_a[a[1]]) + c_1(1, rho_b[b[0]], rho_b[b[1]])
    n = there.force
    for k in range(2):
        own = c_own(0, rho_a[k]) + c_own(1, rho_b[k])
        stiff = np.pi * mesh.e_star
        h = n[k] / stiff * (np.log(4 * stiff * mesh.line / n[k]) - 1) + own * n[k]
        assert h + coupling * n[1 - k] == pytest.approx(H, rel=1e-10)
