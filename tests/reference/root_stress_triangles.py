"""Root stress of whole wheels by an independent finite-element program.

The script uses no part of the kernel: the outline is generated here by the rounded corner of the
rack; the elements are quadratic triangles; no symmetry is used. All teeth are meshed, the hub is
clamped, and a smooth load acts on the flank of one tooth:

    p(s) = 35/(32 w) (1 - (s/w)^2)^3,   w = min(0.25, 0.98 of the distance to the end of the flank)

The stress along both fillets of tooth 0 is E' t.du/ds, from the displacements of the edges of the
outline at two Gauss points per edge.

Lengths are in modules, E = 1, nu = 0.3, plane strain; Sigma = module x stress / line load. Tooth 0
lies on the x axis, and its loaded flank has y > 0. The right fillet is on the side of the loaded
flank, the left fillet is opposite. Tooth j is rotated by j pitches counterclockwise, the side that
the loaded flank faces. The arc along a fillet starts at the form circle. Tension is positive.

    python tests/reference/root_stress_triangles.py

prints the values of WHEELS, with which tests/compliance/test_root_stress.py compares the kernel.
Between the two meshes they change by less than 2e-4. Needs numpy and scipy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

NU = 0.3
PLANE_MODULUS = 1 / (1 - NU**2)
ALPHA = np.radians(20.0)
ADDENDUM, DEDENDUM, ROUNDING = 1.0, 1.25, 0.38  # of the rack
# Positions of the loads, fractions of the arc of the involute; of results, of the arc of a fillet.
POSITIONS = np.array([0.12, 0.31, 0.50, 0.69, 0.88])
FRACTIONS = np.array([0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
WIDEST = 0.25
COARSEST = 1.2  # edges in the body

Array = NDArray[Any]
Size = Callable[[Array], Array]


class Curve:
    """Half of a tooth and of a space, as a function of the arc from the middle of the tip."""

    def __init__(self, teeth: int, shift: float) -> None:
        r = teeth / 2
        self.pitch = 2 * np.pi / teeth
        self.base = r * np.cos(ALPHA)
        self.tip, self.root = r + ADDENDUM + shift, r - DEDENDUM + shift
        depth = DEDENDUM - ROUNDING - shift  # of the centre of the rounding below the rolling line
        rho_tip = np.sqrt(self.tip**2 - self.base**2)
        rho_form = r * np.sin(ALPHA) - depth / np.sin(ALPHA) - ROUNDING
        # the rack is pi/2 - 2 x tan(alpha) wide at the rolling line: half of the tooth is the rest
        half = (np.pi / 2 + 2 * shift * np.tan(ALPHA)) / (2 * r) + np.tan(ALPHA) - ALPHA
        rho = np.sqrt(np.linspace(rho_tip**2, rho_form**2, 4001))
        turned = half - rho / self.base
        involute = self.base * np.stack([np.cos(turned), np.sin(turned)], axis=1)
        involute += rho[:, None] * np.stack([-np.sin(turned), np.cos(turned)], axis=1)
        # the centre of the rounding moves by u along the line that rolls, the wheel turns by u/r;
        # the point that cuts lies on the line through the pitch point
        angle = np.linspace(np.pi / 2 - ALPHA, 0, 4001)
        u = depth * np.tan(angle)
        centre = np.stack([r - depth + 0 * u, u], axis=1)
        cut = centre + ROUNDING * np.stack([-np.cos(angle), np.sin(angle)], axis=1)
        radius, at = np.hypot(*cut.T), u / r - np.arctan2(cut[:, 1], cut[:, 0])
        at += np.arctan2(involute[-1, 1], involute[-1, 0]) - at[0]
        fillet = radius[:, None] * np.stack([np.cos(at), np.sin(at)], axis=1)
        assert np.hypot(*(fillet[0] - involute[-1])) < 1e-9
        assert abs(radius[-1] - self.root) < 1e-12
        assert at[-1] < self.pitch / 2
        arcs = []
        for size, low, high in (
            (self.tip, 0.0, np.arctan2(involute[0, 1], involute[0, 0])),
            (self.root, at[-1], self.pitch / 2),
        ):
            along = np.linspace(low, high, 501)
            arcs.append(size * np.stack([np.cos(along), np.sin(along)], axis=1))
        pieces = [arcs[0], involute, fillet, arcs[1]]
        lengths = [np.hypot(*np.diff(piece, axis=0).T).cumsum() for piece in pieces]
        ends = np.concatenate([[0.0], np.cumsum([length[-1] for length in lengths])])
        self.ends = ends
        self.xy = np.concatenate([pieces[0][:1], *(piece[1:] for piece in pieces)])
        self.s = np.concatenate([[0.0], *(lengths[k] + ends[k] for k in range(4))])
        # half of the angle of the tooth at a radius between root and tip
        outer = np.concatenate([involute, fillet[1:]])[::-1]
        self.radius, self.half = np.hypot(*outer.T), np.arctan2(outer[:, 1], outer[:, 0])
        self.s_form, self.s_tip = rho_form**2 / (2 * self.base), rho_tip**2 / (2 * self.base)
        assert abs(self.s_tip - self.s_form - (ends[2] - ends[1])) < 1e-6

    def point(self, s: float, side: float, tooth: float) -> Array:
        """Point at an arc from the middle of the tip, on a side (1, -1) of a tooth."""
        x, y = (np.interp(s, self.s, self.xy[:, k]) for k in (0, 1))
        c, t = np.cos(tooth * self.pitch), np.sin(tooth * self.pitch)
        return np.array([c * x - t * side * y, t * x + c * side * y])

    def inside(self, xy: Array) -> Array:
        """Whether points are within the outline of the whole wheel."""
        radius, angle = np.hypot(*xy.T), np.arctan2(xy[:, 1], xy[:, 0])
        local = np.abs(angle - self.pitch * np.round(angle / self.pitch))
        half = np.interp(radius, self.radius, self.half)
        return np.asarray((radius < self.root) | ((radius < self.tip) & (local < half)))


@dataclass
class Wheel:
    """Teeth, shift, hub radius, an arc `fixed`, all in modules; results for each of POSITIONS.

    Loads on tooth 0: largest Sigma of the right fillet, least of the left one; Sigma of both at
    FRACTIONS. Loads on teeth -1 (`previous`) and 1 (`following`): Sigma of the right fillet at
    `fixed`.
    """

    teeth: int
    shift: float
    hub: float
    fixed: float
    largest: tuple[float, ...] = ()
    least: tuple[float, ...] = ()
    right: tuple[tuple[float, ...], ...] = ()
    left: tuple[tuple[float, ...], ...] = ()
    previous: tuple[float, ...] = ()
    following: tuple[float, ...] = ()

    @cached_property
    def curve(self) -> Curve:
        """Outline."""
        return Curve(self.teeth, self.shift)

    @property
    def arcs(self) -> Array:
        """Arcs of the loads from the base circle."""
        c = self.curve
        return np.asarray(c.s_form + POSITIONS * (c.s_tip - c.s_form))

    @property
    def widths(self) -> Array:
        """Half widths of the loads."""
        c = self.curve
        end = np.minimum(self.arcs - c.s_form, c.s_tip - self.arcs)
        return np.asarray(np.minimum(WIDEST, 0.98 * end))

    @property
    def rho(self) -> Array:
        """Radii of curvature at the loads."""
        return np.asarray(np.sqrt(2 * self.curve.base * self.arcs))

    @property
    def fillet(self) -> float:
        """Length of a fillet."""
        return float(self.curve.ends[3] - self.curve.ends[2])


WHEELS = [
    Wheel(
        *(50, 0.0, 20 / 3, 0.2839),
        largest=(1.8388, 1.95815, 2.27032, 2.69128, 3.18174),
        least=(-1.61871, -2.14653, -2.70929, -3.29284, -3.88331),
        right=(
            (1.25951, 1.49063, 1.67969, 1.80057, 1.83871, 1.79252, 1.66755),
            (1.51016, 1.71158, 1.8656, 1.94807, 1.94708, 1.86393, 1.70663),
            (1.91418, 2.10693, 2.23235, 2.26982, 2.21365, 2.07207, 1.8588),
            (2.4041, 2.58928, 2.68346, 2.66954, 2.54898, 2.33826, 2.05792),
            (2.95136, 3.1246, 3.18158, 3.10924, 2.91693, 2.63002, 2.2763),
        ),
        left=(
            (-0.90685, -1.14015, -1.3546, -1.51819, -1.6066, -1.60886, -1.5249),
            (-1.54049, -1.79882, -2.00377, -2.12341, -2.14052, -2.05528, -1.87821),
            (-2.2356, -2.48979, -2.65685, -2.70903, -2.63867, -2.45745, -2.18547),
            (-2.9315, -3.16675, -3.2843, -3.2618, -3.10127, -2.82505, -2.46171),
            (-3.59991, -3.81446, -3.88286, -3.78791, -3.54068, -3.17351, -2.7229),
        ),
        previous=(0.15693, 0.14707, 0.14085, 0.13572, 0.13062),
        following=(-0.14569, -0.13236, -0.11363, -0.09295, -0.07219),
    ),
    Wheel(
        *(19, 0.4, 12.5 / 3, 0.2986),
        largest=(2.03558, 2.05264, 2.29542, 2.661, 3.11002),
        least=(-1.73354, -2.26603, -2.8403, -3.44232, -4.05371),
        right=(
            (1.28, 1.57631, 1.81837, 1.97635, 2.03528, 1.99328, 1.85728),
            (1.44931, 1.69995, 1.89983, 2.02156, 2.05094, 1.98632, 1.83457),
            (1.80319, 2.04403, 2.21398, 2.29152, 2.26948, 2.15256, 1.95248),
            (2.25083, 2.48835, 2.62908, 2.6572, 2.57379, 2.39176, 2.12939),
            (2.76734, 2.99878, 3.10472, 3.07578, 2.92227, 2.66622, 2.33312),
        ),
        left=(
            (-0.92495, -1.18945, -1.43174, -1.61668, -1.71827, -1.72413, -1.63408),
            (-1.54164, -1.84446, -2.08574, -2.23127, -2.26302, -2.18015, -1.99395),
            (-2.23824, -2.55043, -2.76031, -2.83992, -2.78246, -2.59953, -2.31312),
            (-2.95352, -3.25745, -3.42062, -3.42348, -3.27103, -2.98674, -2.60218),
            (-3.64572, -3.93756, -4.0526, -3.97959, -3.73481, -3.35289, -2.8743),
        ),
        previous=(0.17631, 0.16941, 0.16413, 0.15918, 0.15372),
        following=(-0.17043, -0.15053, -0.12561, -0.09873, -0.07204),
    ),
]


def sides_of(triangles: Array) -> Array:
    """First, second and third sides of all triangles."""
    return np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])


class Mesh:
    """Triangles with six nodes; edges of the outline with side, tooth and both arcs."""

    def __init__(self, wheel: Wheel, scale: float) -> None:
        from scipy.spatial import cKDTree

        curve = self.curve = wheel.curve
        vertices, sizes, edges = self._outline(wheel, scale)
        n_outer = len(vertices)
        n_hub = int(np.ceil(2 * np.pi * wheel.hub / (0.7 * scale)))
        turned = 2 * np.pi * np.arange(n_hub) / n_hub
        hub = wheel.hub * np.stack([np.cos(turned), np.sin(turned)], axis=1)
        fixed = np.concatenate([vertices, hub])
        size = self._size(vertices, sizes, scale)
        free = self._fill(curve.tip, size)
        free = free[np.hypot(*free.T) > wheel.hub]
        free = free[curve.inside(free)]
        # neither near a vertex nor near the middle of an edge, which would then be no side
        beside = cKDTree(np.concatenate([fixed, self._middles(curve, edges)]))
        free = free[beside.query(free)[0] > 0.6 * size(free)]
        xy = np.concatenate([fixed, free])
        for _ in range(12):
            triangles = self._triangles(wheel, xy)
            # each edge is a spring that pushes until its length is the size there
            bars = np.unique(np.sort(sides_of(triangles), axis=1), axis=0)
            along = xy[bars[:, 1]] - xy[bars[:, 0]]
            length = np.hypot(*along.T)
            rest = size((xy[bars[:, 0]] + xy[bars[:, 1]]) / 2)
            rest *= 1.2 * np.sqrt((length**2).sum() / (rest**2).sum())
            push = np.maximum(rest - length, 0)[:, None] * along / length[:, None]
            moved = np.zeros_like(xy)
            np.add.at(moved, bars[:, 0], -0.2 * push)
            np.add.at(moved, bars[:, 1], 0.2 * push)
            moved[: len(fixed)] = 0
            trial = xy + moved
            good = np.arange(len(xy)) >= len(fixed)
            good &= curve.inside(trial) & (beside.query(trial)[0] > 0.5 * size(trial))
            good &= np.hypot(*trial.T) > wheel.hub
            xy = np.where(good[:, None], trial, xy)
        triangles = self._triangles(wheel, xy)
        self._add_middles(xy, triangles, edges, n_outer, wheel.hub)

    @staticmethod
    def _middles(curve: Curve, edges: Array) -> Array:
        """Middles of the edges of the outline."""
        return np.array([curve.point((a + b) / 2, *on) for *on, a, b in edges])

    @staticmethod
    def _steps(tooth: int, side: int) -> list[float]:
        """Spacing on tip, involute, fillet and root arc of half a tooth."""
        if tooth == 0:
            return [0.12, 0.05 if side == 1 else 0.12, 0.015, 0.03]
        if abs(tooth) == 1:
            return [0.25, 0.08 if side == 1 else 0.12, 0.08, 0.08]
        return [0.25, 0.35, 0.25, 0.25]

    @staticmethod
    def _outline(wheel: Wheel, scale: float) -> tuple[Array, Array, Array]:
        """Vertices round the wheel, their spacing, and per edge: side, tooth, both arcs."""
        curve, e = wheel.curve, wheel.curve.ends
        vertices, sizes, edges = [], [], []
        for tooth in range(wheel.teeth):
            j = (tooth + wheel.teeth // 2) % wheel.teeth - wheel.teeth // 2
            for side in (-1, 1):
                # this half tooth, its mirror image across the tip, the next one across the root
                sources = [
                    (low, high, min(step, (high - low) / scale))
                    for lows, highs, steps in (
                        (e[:4], e[1:], Mesh._steps(j, side)),
                        (-e[1:], -e[:4], Mesh._steps(j, -side)),
                        (2 * e[4] - e[1:], 2 * e[4] - e[:4], Mesh._steps(j + side, -side)),
                    )
                    for low, high, step in zip(lows, highs, steps, strict=True)
                ]
                arcs = [np.array([0.0])]
                for k in range(4):
                    fine = np.linspace(e[k], e[k + 1], 401)
                    step = np.min(
                        [
                            least + 0.2 * np.maximum(0, np.maximum(low - fine, fine - high))
                            for low, high, least in sources
                        ],
                        axis=0,
                    )
                    done = np.concatenate([[0], np.cumsum(np.diff(fine) / step[1:])]) / scale
                    n = max(1, int(np.ceil(done[-1] - 1e-6)))
                    arcs.append(np.interp(np.arange(1, n + 1) / n * done[-1], done, fine))
                    arcs[-1][-1] = e[k + 1]
                s = np.concatenate(arcs)
                if side == -1:
                    s = s[::-1]
                for a, b in pairwise(s):
                    vertices.append(curve.point(a, side, j))
                    sizes.append(abs(b - a))
                    edges.append((side, j, a, b))
        return np.array(vertices), np.array(sizes), np.array(edges)

    @staticmethod
    def _size(vertices: Array, sizes: Array, scale: float) -> Size:
        """Length of edges as a function of the point: as on the outline, growing inward."""
        from scipy.spatial import cKDTree

        classes = np.unique(np.round(np.log2(sizes) * 2)).astype(int)
        which = np.round(np.log2(sizes) * 2).astype(int)
        trees = [(sizes[which == k].max(), cKDTree(vertices[which == k])) for k in classes]

        def size(xy: Array) -> Array:
            found = np.full(len(xy), COARSEST * scale)
            for least, tree in trees:
                found = np.minimum(found, least + 0.22 * tree.query(xy)[0])
            return found

        return size

    @staticmethod
    def _fill(radius: float, size: Size) -> Array:
        """Centres of the cells of a quadtree that is refined to the size."""
        n = int(np.ceil(2 * radius / COARSEST))
        at = (np.arange(n) + 0.5) / n * 2 * radius - radius
        cells, width = np.stack(np.meshgrid(at, at), axis=-1).reshape(-1, 2), 2 * radius / n
        leaves = []
        while len(cells):
            coarse = width > 1.15 * size(cells)
            leaves.append(cells[~coarse])
            quarter = np.array([[-1, -1], [1, -1], [-1, 1], [1, 1]]) * width / 4
            cells = (cells[coarse][:, None] + quarter).reshape(-1, 2)
            width /= 2
        points = np.concatenate(leaves)
        # a square has two equivalent triangulations: displace its corners
        return points + 1e-4 * np.random.default_rng(1).uniform(-1, 1, points.shape)

    @staticmethod
    def _triangles(wheel: Wheel, xy: Array) -> Array:
        """Triangles within the wheel, counterclockwise."""
        from scipy.spatial import Delaunay

        found = Delaunay(xy).simplices
        middle = xy[found].mean(axis=1)
        found = found[wheel.curve.inside(middle) & (np.hypot(*middle.T) > wheel.hub * 0.9999)]
        a, b, c = (xy[found[:, k]] for k in range(3))
        ab, ac = b - a, c - a
        backward = ab[:, 0] * ac[:, 1] < ab[:, 1] * ac[:, 0]
        found[backward] = found[backward][:, [0, 2, 1]]
        return np.asarray(found)

    def _add_middles(
        self, xy: Array, triangles: Array, edges: Array, n_outer: int, hub: float
    ) -> None:
        """Nodes in the middle of sides, on the outline and the hub where a side lies there."""
        bars, which, counts = np.unique(
            np.sort(sides_of(triangles), axis=1), axis=0, return_inverse=True, return_counts=True
        )
        which = which.ravel()
        middle = (xy[bars[:, 0]] + xy[bars[:, 1]]) / 2
        number = {tuple(bar): i for i, bar in enumerate(bars.tolist())}
        following = (np.arange(n_outer) + 1) % n_outer
        self.edges = edges
        self.edge_nodes = np.empty((n_outer, 3), int)
        for i, (side, tooth, a, b) in enumerate(edges):
            bar = number[min(i, following[i]), max(i, following[i])]
            assert counts[bar] == 1
            middle[bar] = self.curve.point((a + b) / 2, side, tooth)
            self.edge_nodes[i] = i, len(xy) + bar, following[i]
        on_hub = (counts == 1) & (np.hypot(*middle.T) < 1.05 * hub)
        middle[on_hub] *= (hub / np.hypot(*middle[on_hub].T))[:, None]
        assert (counts == 1).sum() == n_outer + on_hub.sum()
        self.xy = np.concatenate([xy, middle])
        n = len(triangles)
        self.elements = np.concatenate(
            [triangles, len(xy) + which.reshape(3, n).T], axis=1
        )  # corners, then the sides 01, 12, 20
        self.clamped = np.abs(np.hypot(*self.xy.T) - hub) < 1e-9
        corners = self.xy[triangles]
        lengths = [np.hypot(*(corners[:, k] - corners[:, k - 1]).T) for k in range(3)]
        ab, ac = (corners[:, k] - corners[:, 0] for k in (1, 2))
        area = (ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]) / 2
        self.quality = 4 * np.sqrt(3) * area / sum(length**2 for length in lengths)


def stiffness(mesh: Mesh) -> Any:
    """Sparse matrix of all unknowns, x and y of each node."""
    from scipy.sparse import coo_array

    # Dunavant's rule of degree 4
    a, b = 0.445948490915965, 0.091576213509771
    points = [(a, a), (1 - 2 * a, a), (a, 1 - 2 * a), (b, b), (1 - 2 * b, b), (b, 1 - 2 * b)]
    weights = [0.223381589678011 / 2] * 3 + [0.109951743655322 / 2] * 3
    lam, mu = NU / ((1 + NU) * (1 - 2 * NU)), 1 / (2 * (1 + NU))
    hooke = np.array([[lam + 2 * mu, lam, 0], [lam, lam + 2 * mu, 0], [0, 0, mu]])
    n = len(mesh.elements)
    k = np.zeros((n, 12, 12))
    corners = mesh.xy[mesh.elements]
    for (x, y), weight in zip(points, weights, strict=True):
        z = 1 - x - y
        by_x = np.array([1 - 4 * z, 4 * x - 1, 0, 4 * (z - x), 4 * y, -4 * y])
        by_y = np.array([1 - 4 * z, 0, 4 * y - 1, -4 * x, 4 * x, 4 * (z - y)])
        jacobian = np.einsum("an,enk->eak", np.array([by_x, by_y]), corners)
        det = np.linalg.det(jacobian)
        assert det.min() > 0
        gradient = np.linalg.solve(jacobian, np.broadcast_to(np.array([by_x, by_y]), (n, 2, 6)))
        strain = np.zeros((n, 3, 12))
        strain[:, 0, 0::2], strain[:, 1, 1::2] = gradient[:, 0], gradient[:, 1]
        strain[:, 2, 0::2], strain[:, 2, 1::2] = gradient[:, 1], gradient[:, 0]
        k += (weight * det)[:, None, None] * (strain.transpose(0, 2, 1) @ hooke @ strain)
    unknowns = np.stack([2 * mesh.elements, 2 * mesh.elements + 1], axis=2).reshape(n, 12)
    rows = np.repeat(unknowns, 12, axis=1).ravel()
    columns = np.tile(unknowns, (1, 12)).ravel()
    size = 2 * len(mesh.xy)
    return coo_array((k.ravel(), (rows, columns)), shape=(size, size))


def shape(x: Array) -> tuple[Array, Array]:
    """Values and derivatives of the functions of an edge's nodes (node, point), x from -1 to 1."""
    values = np.array([x * (x - 1) / 2, 1 - x**2, x * (x + 1) / 2])
    return values, np.array([x - 0.5, -2 * x, x + 0.5])


def load(wheel: Wheel, mesh: Mesh, position: int, tooth: int) -> Array:
    """Forces of a load on the flank y > 0 of a tooth."""
    curve, force = wheel.curve, np.zeros(2 * len(mesh.xy))
    gauss, weights = np.polynomial.legendre.leggauss(6)
    middle, w = wheel.arcs[position], wheel.widths[position]
    for (side, j, a, b), nodes in zip(mesh.edges, mesh.edge_nodes, strict=True):
        # arc from the base circle, of the involute
        start, end = (curve.s_tip - (s - curve.ends[1]) for s in (a, b))
        low, high = max(end, middle - w), min(start, middle + w)
        if side != 1 or j != tooth or a < curve.ends[1] - 1e-9 or b > curve.ends[2] + 1e-9:
            continue
        if low >= high:
            continue
        s = low + (high - low) * (1 + gauss) / 2
        pressure = 35 / (32 * w) * (1 - ((s - middle) / w) ** 2) ** 3 * weights * (high - low) / 2
        values, _ = shape(2 * (s - start) / (end - start) - 1)
        rho = np.sqrt(2 * curve.base * s)
        first = np.arctan2(curve.xy[:, 1], curve.xy[:, 0])[np.searchsorted(curve.s, curve.ends[1])]
        rho_tip = np.sqrt(2 * curve.base * curve.s_tip)
        # angle of the radius to the point where the involute's normal touches the base circle
        turn = first - np.arctan(rho_tip / curve.base) + (rho_tip - rho) / curve.base
        turn = turn + tooth * curve.pitch
        np.add.at(force, 2 * nodes, values @ (pressure * np.sin(turn)))
        np.add.at(force, 2 * nodes + 1, values @ (-pressure * np.cos(turn)))
    assert abs(np.hypot(force[::2].sum(), force[1::2].sum()) - 1) < 2e-3
    return force


def fillet_stress(wheel: Wheel, mesh: Mesh, u: Array, side: int) -> tuple[Array, Array]:
    """Arcs from the form circle and E' t.du/ds there, at two points of each edge of tooth 0."""
    start, end = wheel.curve.ends[2:4]
    e = mesh.edges
    own = (e[:, 0] == side) & (e[:, 1] == 0)
    low, high = np.minimum(e[:, 2], e[:, 3]), np.maximum(e[:, 2], e[:, 3])
    own &= (low > start - 1e-9) & (high < end + 1e-9)
    x = np.array([-1, 1]) / np.sqrt(3)
    _, slopes = shape(x)
    nodes = mesh.edge_nodes[own]
    along = np.einsum("np,enk->epk", slopes, mesh.xy[nodes])
    moved = np.einsum("np,enk->epk", slopes, u.reshape(-1, 2)[nodes])
    strain = (along * moved).sum(axis=2) / (along**2).sum(axis=2)
    s = (e[own, 2, None] + e[own, 3, None]) / 2 + x * (e[own, 3, None] - e[own, 2, None]) / 2
    s, stress = s.ravel() - start, PLANE_MODULUS * strain.ravel()
    order = np.argsort(s)
    return s[order], stress[order]


def fitted(s: Array, stress: Array, at: float) -> float:
    """Value at an arc, by a cubic through the ten points next to it."""
    near = np.argsort(np.abs(s - at))[:10]
    return float(np.polyval(np.polyfit(s[near] - at, stress[near], 3), 0.0))


def extreme(s: Array, stress: Array, sign: int) -> tuple[float, float]:
    """Arc and value of the largest (sign 1) or least (-1) stress."""
    at = s[np.argmax(sign * stress)]
    near = np.argsort(np.abs(s - at))[:14]
    cubic = np.polynomial.Polynomial.fit(s[near], sign * stress[near], 4)
    fine = np.linspace(s[near].min(), s[near].max(), 2001)
    best = np.argmax(cubic(fine))
    return float(fine[best]), float(sign * cubic(fine[best]))


def solve(wheel: Wheel, scale: float) -> tuple[Mesh, dict[int, Array]]:
    """Displacements (position, unknown) by the loaded tooth."""
    from scipy.sparse.linalg import splu

    mesh = Mesh(wheel, scale)
    free = np.repeat(~mesh.clamped, 2)
    matrix = stiffness(mesh).tocsc()[free][:, free]
    factors = splu(
        matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
    )
    found = {}
    for tooth in (0, -1, 1):
        u = np.zeros((len(POSITIONS), len(free)))
        for k in range(len(POSITIONS)):
            u[k, free] = factors.solve(load(wheel, mesh, k, tooth)[free])
        found[tooth] = u
    return mesh, found


def main() -> None:
    """Print the numbers, with two meshes."""
    for wheel in WHEELS:
        for scale in (1.0, 0.6):
            mesh, u = solve(wheel, scale)
            print(wheel.teeth, "nodes", len(mesh.xy), "least quality", mesh.quality.min().round(2))
            right = [fillet_stress(wheel, mesh, row, 1) for row in u[0]]
            left = [fillet_stress(wheel, mesh, row, -1) for row in u[0]]
            print(" rho", *(wheel.rho * 3).round(6))
            print(" largest", [round(extreme(*f, 1)[1], 5) for f in right])
            print(" at", [round(extreme(*f, 1)[0], 4) for f in right], "of", round(wheel.fillet, 4))
            print(" least", [round(extreme(*f, -1)[1], 5) for f in left])
            print(" at", [round(extreme(*f, -1)[0], 4) for f in left])
            arcs = FRACTIONS * wheel.fillet
            print(" right", [tuple(round(fitted(*f, a), 5) for a in arcs) for f in right])
            print(" left", [tuple(round(fitted(*f, a), 5) for a in arcs) for f in left])
            for name, tooth in (("previous", -1), ("following", 1)):
                rows = [fillet_stress(wheel, mesh, row, 1) for row in u[tooth]]
                print(f" {name}", [round(fitted(*f, wheel.fixed), 5) for f in rows])


if __name__ == "__main__":
    main()
