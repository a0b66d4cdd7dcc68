"""Influence functions by another way: whole wheels of quadratic triangles under a Hertz strip.

No part of the program is used: not its outline, which is cut here by the rack's own corner, nor its
elements, symmetry, load or formula for c. The strip p(s) = 2/(pi a) sqrt(1 - (s/a)^2) is put on the
flank of one tooth, all teeth are meshed, the hub is clamped; the definition is taken as it stands,

    c = lim_{a->0} u(0) - K [ln(4 rho/a) - 1/2],   K = 2 (1 - nu^2)/(pi E),

from two strips a, a/2, whose errors of first order cancel. c_1 is that of the next flank.

Needs gmsh and scikit-fem (https://github.com/kinnala/scikit-fem), which the project does not:

    python tests/reference/wheel_compliance.py

prints the numbers that stand in WHEELS and that tests/compliance/test_another_program.py compares.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

NU = 0.3
K = 2 * (1 - NU**2) / np.pi


@dataclass
class Wheel:
    """Teeth, shift, hub radius, places rho in modules; E c, E c_1. Rack 1/1.25/0.38, 20 deg."""

    teeth: int
    shift: float
    hub: float
    rho: tuple[float, ...]
    own: tuple[float, ...] = ()
    following: tuple[float, ...] = ()


WHEELS = [
    Wheel(
        *(19, 0.4, 25 / 6, (3.0, 4.4, 5.6)),
        own=(2.66338, 3.79092, 6.44365),
        following=(1.54472, 1.47589, 1.34480),
    ),
    Wheel(
        *(34, 0.1, 7.0, (4.6, 6.2, 7.6)),
        own=(2.97564, 4.31413, 7.14334),
        following=(2.06305, 2.00168, 1.89014),
    ),
]


def outline(wheel: Wheel) -> tuple[list[np.ndarray], float, float]:
    """Involute between the places and fillet of the flank with y > 0; radii of tip and root."""
    z, x, alpha = wheel.teeth, wheel.shift, np.radians(20)
    r = z / 2
    base, tip, root = r * np.cos(alpha), r + 1 + x, r - 1.25 + x
    half = (np.pi / 2 + 2 * x * np.tan(alpha)) / (2 * r) + np.tan(alpha) - alpha
    rho_tip = np.sqrt(tip**2 - base**2)
    depth = 1.25 - 0.38 - x  # of the centre of the rack's rounding
    form = r * np.sin(alpha) - depth / np.sin(alpha) - 0.38

    def involute(rho: np.ndarray) -> np.ndarray:
        radius = np.hypot(base, rho)
        angle = half - (rho / base - np.arctan(rho / base))
        return radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    ends = [rho_tip, *sorted(wheel.rho, reverse=True), form]
    pieces = [involute(np.linspace(a, b, 25)) for a, b in pairwise(ends)]
    # the rounding's centre runs along a line that rolls on the reference circle; the envelope is a
    # parallel curve of its path in the wheel, at the rounding's radius
    u = depth * np.tan(np.linspace(np.pi / 2 - alpha, 0, 60))
    turn = u / r
    centre = np.stack([r - depth + 0 * u, u], axis=1)
    to_pitch = np.stack([r + 0 * u, 0 * u], axis=1) - centre
    contact = centre - 0.38 * to_pitch / np.hypot(*to_pitch.T)[:, None]
    radius, angle = np.hypot(*contact.T), -np.arctan2(contact[:, 1], contact[:, 0]) + turn
    first = np.arctan2(pieces[-1][-1, 1], pieces[-1][-1, 0])
    angle += first - angle[0]
    assert abs(radius[0] - np.hypot(base, form)) < 1e-12
    assert abs(radius[-1] - root) < 1e-12
    return [*pieces, radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)], tip, root


def mesh_of(wheel: Wheel, a: float, scale: float) -> Any:
    """Quadratic triangles, fine where the loads stand."""
    import gmsh
    from skfem import MeshTri2

    pieces, _, _ = outline(wheel)
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geo = gmsh.model.geo
    origin = geo.addPoint(0, 0, 0)
    known: dict[tuple[float, float], int] = {}

    def point(xy: np.ndarray) -> int:
        key = (round(xy[0], 9), round(xy[1], 9))
        if key not in known:
            known[key] = geo.addPoint(*xy, 0)
        return known[key]

    curves, loaded = [], []
    pitch = 2 * np.pi / wheel.teeth
    for tooth in range(wheel.teeth):
        c, s = np.cos(tooth * pitch), np.sin(tooth * pitch)
        turned = np.array([[c, -s], [s, c]])
        upper = [p @ turned.T for p in pieces]
        lower = [(p * [1, -1]) @ turned.T for p in pieces]
        curves.append(geo.addCircleArc(point(lower[0][0]), origin, point(upper[0][0])))
        curves += [geo.addSpline([point(q) for q in p]) for p in upper]
        c, s = np.cos(pitch), np.sin(pitch)
        following = lower[-1][-1] @ np.array([[c, -s], [s, c]]).T
        curves.append(geo.addCircleArc(point(upper[-1][-1]), origin, point(following)))
        curves += [
            geo.addSpline([point(q) for q in p])
            for p in reversed([w @ np.array([[c, -s], [s, c]]).T for w in lower])
        ]
        if tooth == 0:
            loaded = [point(p[-1]) for p in upper[:-2]]
    # each tooth went on to the tip of the next
    hub = [point(wheel.hub * np.array([np.cos(t), np.sin(t)])) for t in np.arange(4) * np.pi / 2]
    inner = [geo.addCircleArc(hub[i], origin, hub[(i + 1) % 4]) for i in range(4)]
    geo.addPlaneSurface([geo.addCurveLoop(curves, reorient=True), geo.addCurveLoop(inner)])
    geo.synchronize()
    field = gmsh.model.mesh.field
    near = field.add("Distance")
    field.setNumbers(near, "PointsList", loaded)
    sizes = field.add("Threshold")
    field.setNumber(sizes, "InField", near)
    for name, value in (
        ("SizeMin", a / 6),
        ("SizeMax", 0.3),
        ("DistMin", 1.5 * a),
        ("DistMax", 2.0),
    ):
        field.setNumber(sizes, name, value * (scale if name.startswith("Size") else 1))
    field.setAsBackgroundMesh(sizes)
    for option in ("FromPoints", "FromCurvature", "ExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.MeshSize{option}", 0)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    _, _, nodes = gmsh.model.mesh.getElements(2)
    gmsh.finalize()
    index_of = np.zeros(int(tags.max()) + 1, int)
    index_of[tags.astype(int)] = np.arange(len(tags))
    xy = xyz.reshape(-1, 3)[:, :2]
    elements = index_of[nodes[0].astype(int)].reshape(-1, 6)
    used = np.unique(elements)
    renumber = np.zeros(len(xy), int)
    renumber[used] = np.arange(len(used))
    return MeshTri2(
        np.ascontiguousarray(xy[used].T), np.ascontiguousarray(renumber[elements].T), sort_t=False
    )


def influence(wheel: Wheel, a: float, scale: float) -> tuple[np.ndarray, np.ndarray, int]:
    """E u(0) - E K [...] at all places, and E c_1, with strips a and a/2: (2, place) each."""
    import skfem
    from scipy.sparse.linalg import splu
    from skfem.helpers import ddot, sym_grad, trace
    from skfem.models.elasticity import lame_parameters

    mesh = mesh_of(wheel, a / 2, scale)
    element = skfem.ElementVector(skfem.ElementTriP2())
    basis = skfem.Basis(mesh, element, intorder=4)
    lam, mu = lame_parameters(1.0, NU)

    @skfem.BilinearForm
    def elastic(u, v, _):
        strain, test = sym_grad(u), sym_grad(v)
        return 2 * mu * ddot(strain, test) + lam * trace(strain) * trace(test)

    stiffness = elastic.assemble(basis)
    base = wheel.teeth / 2 * np.cos(np.radians(20))
    pitch = 2 * np.pi / wheel.teeth
    half = (
        (np.pi / 2 + 2 * wheel.shift * np.tan(np.radians(20))) / wheel.teeth
        + np.tan(np.radians(20))
        - np.radians(20)
    )
    root = wheel.teeth / 2 - 1.25 + wheel.shift
    held = basis.get_dofs(lambda q: np.hypot(*q) < wheel.hub * 1.0005 + 1e-3).all()
    free = np.setdiff1d(np.arange(basis.N), held)
    solve = splu(stiffness[free][:, free].tocsc())
    flank = mesh.facets_satisfying(
        lambda q: (
            (np.hypot(*q) > root + 0.3)
            & (np.arctan2(q[1], q[0]) > 0)
            & (np.arctan2(q[1], q[0]) < pitch / 2)
        ),
        boundaries_only=True,
    )
    points = basis.doflocs
    ends, middles = basis.nodal_dofs[:, mesh.facets[:, flank]], basis.facet_dofs[:, flank]
    dofs = np.stack([ends[:, 0], ends[:, 1], middles], axis=1)  # (xy, node, facet)
    arcs = (np.sum(points[:, dofs[0]] ** 2, axis=0) - base**2) / (2 * base)  # (node, facet)
    gauss, weights = np.polynomial.legendre.leggauss(10)
    own, following = np.zeros((2, len(wheel.rho))), np.zeros((2, len(wheel.rho)))
    for row, strip in enumerate((a, a / 2)):
        for k, rho in enumerate(wheel.rho):
            force = np.zeros(basis.N)
            for f in range(len(flank)):
                start, end, middle = arcs[:, f]
                low, high = (
                    np.clip((s - rho**2 / (2 * base)) / strip, -1, 1) for s in (start, end)
                )
                if low == high:
                    continue
                # s = a sin(angle): p ds = 2/pi cos^2(angle) d angle
                low, high = np.arcsin(low), np.arcsin(high)
                angle = low + (high - low) * (1 + gauss) / 2
                s = rho**2 / (2 * base) + strip * np.sin(angle)
                share = 2 / np.pi * np.cos(angle) ** 2 * abs(high - low) / 2 * weights
                local = [
                    (s - end) * (s - middle) / ((start - end) * (start - middle)),
                    (s - start) * (s - middle) / ((end - start) * (end - middle)),
                    (s - start) * (s - end) / ((middle - start) * (middle - end)),
                ]
                t = half - np.sqrt(2 * base * s) / base
                for node in range(3):
                    force[dofs[0, node, f]] += share @ (local[node] * np.sin(t))
                    force[dofs[1, node, f]] -= share @ (local[node] * np.cos(t))
            t = half - rho / base
            normal = np.array([np.sin(t), -np.cos(t)])
            total = normal @ [
                force[basis.nodal_dofs[i]].sum() + force[basis.facet_dofs[i]].sum() for i in (0, 1)
            ]
            u = np.zeros(basis.N)
            u[free] = solve.solve(force[free] / total)
            at = base * np.array([np.cos(t), np.sin(t)]) + rho * np.array([-np.sin(t), np.cos(t)])
            for tooth, answer in ((0, own), (1, following)):
                c, s = np.cos(tooth * pitch), np.sin(tooth * pitch)
                turned = np.array([[c, -s], [s, c]])
                vertex = np.argmin(
                    np.hypot(*(mesh.p[:, : mesh.nvertices] - (turned @ at)[:, None]))
                )
                assert np.hypot(*(mesh.p[:, vertex] - turned @ at)) < 1e-6
                answer[row, k] = (turned @ normal) @ u[basis.nodal_dofs[:, vertex]]
            own[row, k] -= K * (np.log(4 * rho / strip) - 0.5)
    return own, following, basis.N


def main() -> None:
    """Print the numbers, with two meshes."""
    for wheel in WHEELS:
        for a, scale in ((0.06, 1.0), (0.06, 0.5)):
            own, following, n = influence(wheel, a, scale)
            print(
                wheel.teeth,
                n,
                "E c",
                2 * own[1] - own[0],
                "by strips",
                own.tolist(),
                "E c_1",
                following[1],
            )


if __name__ == "__main__":
    main()
